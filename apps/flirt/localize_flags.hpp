// apps/flirt/localize_flags.hpp: --method and the parameters of localization, for the commands that localize.
#pragma once

#include "flirt/map/localize.hpp"

#include "apps/flirt/param_flags.hpp"

#include <CLI/CLI.hpp>

#include <string>

namespace flirt::app {

class LocalizeFlags {
 public:
  /// This object must outlive `params.resolve`.
  void add(CLI::App& command, ParamFlags& params);

  /// As resolved; call after parsing and `params.resolve`.
  [[nodiscard]] LocalizeParams localize() const;
  [[nodiscard]] const std::string& method() const { return method_; }

 private:
  std::string method_{to_string(LocalizeMethod::automatic)};
  LocalizeParams params_;
};

}  // namespace flirt::app
