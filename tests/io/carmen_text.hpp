// tests/io/carmen_text.hpp: lines of CARMEN logs, and reading them from a text.
#pragma once

#include "flirt/io/carmen.hpp"

#include "tests/support/temporary.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace flirt {

inline const ReadOptions lenient{.broken_lines = BrokenLines::lenient};

[[nodiscard]] inline Result<LoadedLog> read_text(std::string_view text, const ReadOptions& options = {}) {
  const TemporaryFolder folder;
  return read_log(folder.file("test.log", text), options);
}

[[nodiscard]] inline std::string error_of(std::string_view text, const ReadOptions& options = {}) {
  const auto loaded = read_text(text, options);
  return loaded ? "no error" : loaded.error().message;
}

[[nodiscard]] inline std::string repeated(std::string_view word, std::size_t n) {
  std::string text;
  for (std::size_t i = 0; i < n; ++i) { text.append(" ").append(word); }
  return text;
}

/// A FLASER line of n equal ranges.
[[nodiscard]] inline std::string flaser(std::size_t n, std::string_view poses = "1 2 0.5 1 2 0.5",
                                        std::string_view stamp = "7.25", std::string_view range = "1.5") {
  return "FLASER " + std::to_string(n) + repeated(range, n) + ' ' + std::string(poses) + ' ' + std::string(stamp) +
         " host 0.5\n";
}

[[nodiscard]] inline std::string robotlaser(std::string_view ranges = "3 1 2 3",
                                            std::string_view poses = "1.5 2 0 1 2 0",
                                            std::string_view head = "0 -1.5 3.0 0.5 40") {
  return "ROBOTLASER1 " + std::string(head) + " 0.1 0 " + std::string(ranges) + " 0 " + std::string(poses) +
         " 0 0 0 0 0 7.25 host 0.5\n";
}

[[nodiscard]] inline std::string rawlaser(std::string_view stamp = "7.25", std::string_view kind = "RAWLASER1") {
  return std::string(kind) + " 0 -1.5 3.0 0.5 40 0.1 0 3 1 2 3 0 " + std::string(stamp) + " host 0.5\n";
}

inline void expect_pose(const Pose2& found, const Pose2& expected) {
  EXPECT_NEAR(found.x, expected.x, 1e-9);
  EXPECT_NEAR(found.y, expected.y, 1e-9);
  EXPECT_NEAR(heading_difference(found, expected), 0, 1e-9);
}

}  // namespace flirt
