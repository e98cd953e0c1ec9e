// flirt/io/mapped_file.hpp: a whole file as read-only memory.
#pragma once

#include "flirt/core/result.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

namespace flirt {

/// A regular file mapped into memory; pages are read when they are first touched.
class MappedFile {
 public:
  [[nodiscard]] static Result<std::shared_ptr<const MappedFile>> open(const std::filesystem::path& path);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

 private:
  explicit MappedFile(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::span<const std::byte> bytes_;
};

}  // namespace flirt
