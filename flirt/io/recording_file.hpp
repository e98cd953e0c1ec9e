// flirt/io/recording_file.hpp: what a path says about a file of a recording. Internal to flirt/io.
#pragma once

#include "flirt/core/result.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace flirt::bag {

[[nodiscard]] inline bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

/// "x.db3" for "x.db3.zstd", a file that a recorder compressed as a whole; nothing for others.
[[nodiscard]] inline std::optional<std::filesystem::path> unpacked_name(const std::filesystem::path& path) {
  std::filesystem::path inner = path.parent_path() / path.stem();
  const bool is_packed = path.extension() == ".zstd" || path.extension() == ".zst";
  const bool is_known = inner.extension() == ".db3" || inner.extension() == ".mcap" || inner.extension() == ".bag";
  return is_packed && is_known ? std::optional(std::move(inner)) : std::nullopt;
}

/// An error unless the path is a regular file that is not compressed as a whole.
[[nodiscard]] inline Result<void> require_plain_file(const std::filesystem::path& path) {
  const std::string name = path.string();
  if (!is_file(path)) { return fail(name + ": expected a regular file, found something else or nothing"); }
  if (unpacked_name(path)) {
    return fail(name + ": expected a file that is not compressed as a whole, found one that is: run zstd -d " + name);
  }
  return {};
}

}  // namespace flirt::bag
