#include "apps/flirt/reading_flags.hpp"

#include "apps/flirt/command.hpp"

namespace flirt::app {

void ReadingFlags::add_to(CLI::App& command) {
  command.add_flag("--lenient", is_lenient, "skip and count broken lines or messages instead of stopping at the first");
  command.add_option("--message", message,
                     "scans to read: a kind of lines, as RAWLASER1, or a topic; else the first that appears");
  command.add_option("--range-max", range_max, "m; readings of this length or more are no return; else from the log")
      ->check(expect_above_0);
}

ReadOptions ReadingFlags::options() const {
  ReadOptions options{.message = message};
  if (is_lenient) { options.broken_lines = BrokenLines::lenient; }
  if (range_max > 0) { options.range_max = range_max; }
  return options;
}

}  // namespace flirt::app
