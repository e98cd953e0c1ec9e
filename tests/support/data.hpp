// tests/support/data.hpp: where the real logs are; tests that need them skip when they are absent.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

namespace flirt {

/// The file at `relative` below the folder of real logs ($FLIRT_DATA, else ../shared/data beside the sources), or
/// nothing when it is not there.
[[nodiscard]] inline std::optional<std::filesystem::path> data_file(std::string_view relative) {
  const char* const folder = std::getenv("FLIRT_DATA");
  const std::filesystem::path root = folder != nullptr ? folder : FLIRT_SOURCE_DIR "/../shared/data";
  std::filesystem::path file = root / relative;
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) { return std::nullopt; }
  return file;
}

}  // namespace flirt
