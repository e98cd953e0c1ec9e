// apps/flirt/reading_flags.hpp: flags of the commands that only read a log, how it is to be read.
#pragma once

#include "flirt/io/log.hpp"

#include "apps/flirt/command.hpp"

#include <string>

namespace flirt::app {

struct ReadingFlags {
  bool is_lenient{false};
  std::string message{};
  double range_max{0};  ///< m; 0: from the log

  void add_to(CLI::App& command);
  [[nodiscard]] ReadOptions options() const;
  [[nodiscard]] bool are_given() const { return is_lenient || !message.empty() || range_max > 0; }
};

}  // namespace flirt::app
