// flirt/io/file.hpp: whole files, lines of plain or gzip files, and writing that never leaves half a file.
#pragma once

#include "flirt/core/result.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace flirt {

/// All bytes of a file, as they are. Of a pipe or a device up to 256 MB, since it may never end.
[[nodiscard]] Result<std::string> read_file(const std::filesystem::path& path);

/// Replaces the file by `bytes`, or leaves it as it was: writes a temporary file in the same folder and renames it.
/// A link stays, and what it leads to is written, be it there or not. What is not a regular file (a device, a pipe) is
/// written to directly. Errors: folder missing, no permission, no space, links in a ring.
[[nodiscard]] Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// The complaint that writing to `path` would begin with: a folder is there, or none is around it. Writes nothing.
[[nodiscard]] Result<void> require_writable(const std::filesystem::path& path);

/// How a line ended.
enum class LineEnd : std::uint8_t {
  newline,      ///< \n, \r\n or \r
  end_of_file,  ///< the last line, perhaps cut short
};

struct Line {
  std::string_view text{};  ///< without its end; valid until the next call of `next`
  std::size_t number{0};    ///< 1 for the first
  LineEnd end{LineEnd::newline};
};

/// Lines of a plain or gzip file, of up to 64 MB each; memory is that of the longest line.
class LineReader {
 public:
  /// Errors: no such file, a folder, no permission.
  [[nodiscard]] static Result<LineReader> open(const std::filesystem::path& path);

  /// From here on all that is read is kept, until `rewind` makes this the next line again: a pipe can be read only
  /// once.
  void mark();
  void rewind();

  /// The next line, or nothing at the end. Errors: broken or cut short gzip data, read errors, a longer
  /// line.
  [[nodiscard]] Result<std::optional<Line>> next();

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool is_gzip() const;
  /// Share of the file's bytes already read, 0..1.
  [[nodiscard]] double share_read() const;

 private:
  struct Close {
    void operator()(void* file) const;
  };
  LineReader(std::string name, void* file, double file_bytes);
  [[nodiscard]] Result<void> refill();
  [[nodiscard]] Line take_line(std::size_t length, std::size_t end_length, LineEnd end);

  std::string name_;
  std::unique_ptr<void, Close> file_;
  double file_bytes_;
  std::vector<char> buffer_{};
  std::size_t begin_{0};    ///< of what is not yet handed out
  std::size_t end_{0};      ///< of what is in the buffer
  std::size_t scanned_{0};  ///< no line end in [begin_, scanned_)
  std::size_t line_{0};
  struct Mark {
    std::size_t begin;
    std::size_t line;
  };
  std::optional<Mark> mark_{};
  bool at_end_{false};
};

}  // namespace flirt
