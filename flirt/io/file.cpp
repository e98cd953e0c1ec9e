#include "flirt/io/file.hpp"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <utility>

namespace flirt {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t chunk_bytes = std::size_t{1} << 16U;
constexpr std::size_t longest_line = std::size_t{1} << 26U;            // bytes; a scan of 20 000 beams takes 200 kB
constexpr std::size_t most_bytes_of_a_stream = std::size_t{1} << 28U;  // of a pipe or a device, which may never end

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

std::string system_message() {
  return std::error_code(errno, std::generic_category()).message();
}

/// A complaint when the path cannot be read as a file.
Result<void> require_file(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) { return fail(path.string() + ": expected a file, found nothing: " + error.message()); }
  if (fs::is_directory(status)) { return fail(path.string() + ": expected a file, found a folder"); }
  return {};
}

/// Writes and closes; false with errno set when any of it failed.
bool write_all(File file, std::string_view bytes) {
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
  const int write_error = errno;
  const bool closed = std::fclose(file.release()) == 0;
  if (!written) { errno = write_error; }
  return written && closed;
}

/// A new file beside `path`, under a name that nothing has yet.
std::pair<fs::path, File> create_beside(const fs::path& path) {
  for (int i = 0; i < 1000; ++i) {
    const fs::path temporary = path.parent_path() / ("." + path.filename().string() + ".part" + std::to_string(i));
    File file(std::fopen(temporary.c_str(), "wbx"));  // x: only if new
    if (file || errno != EEXIST) { return {temporary, std::move(file)}; }
  }
  return {};
}

/// Where a link leads, whether anything is there yet or not; what is no link leads to itself. Links in a ring stay one.
fs::path link_target(fs::path path) {
  constexpr int most_links = 40;
  std::error_code error;
  for (int i = 0; i < most_links && fs::is_symlink(fs::symlink_status(path, error)); ++i) {
    path = path.parent_path() / fs::read_symlink(path, error);
  }
  return path;
}

Result<void> write_directly(const fs::path& path, std::string_view bytes) {
  File file(std::fopen(path.c_str(), "wb"));
  if (!file || !write_all(std::move(file), bytes)) {
    return fail(path.string() + ": expected to write, found: " + system_message());
  }
  return {};
}

Result<void> write_and_rename(const fs::path& path, const fs::file_status& status, std::string_view bytes) {
  const auto failed = [&](const std::string& why) {
    return fail(path.string() + ": expected to write, found: " + why);
  };
  auto [temporary, file] = create_beside(path);
  if (!file) { return failed(system_message()); }
  std::error_code error;
  if (!write_all(std::move(file), bytes)) {
    const std::string why = system_message();
    fs::remove(temporary, error);
    return failed(why);
  }
  if (fs::exists(status)) { fs::permissions(temporary, status.permissions(), error); }
  fs::rename(temporary, path, error);
  if (error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    return failed(error.message());
  }
  return {};
}

}  // namespace

Result<std::string> read_file(const fs::path& path) {
  if (auto good = require_file(path); !good) { return tl::unexpected(good.error()); }
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) { return fail(path.string() + ": expected a readable file, found: " + system_message()); }
  std::error_code ignored;
  const bool may_be_endless = !fs::is_regular_file(path, ignored);
  std::string bytes;
  std::size_t n = 0;
  do {
    const std::size_t old_size = bytes.size();
    bytes.resize(old_size + chunk_bytes);
    n = std::fread(bytes.data() + old_size, 1, chunk_bytes, file.get());
    bytes.resize(old_size + n);
    if (may_be_endless && bytes.size() > most_bytes_of_a_stream) {
      return fail(path.string() + ": expected up to 256 MB from what is not a regular file, found more");
    }
  } while (n == chunk_bytes);
  if (std::ferror(file.get()) != 0) {
    return fail(path.string() + ": expected readable data, found: " + system_message());
  }
  return bytes;
}

Result<void> require_writable(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) { return fail(path.string() + ": expected a file to write, found a folder"); }
  const fs::path folder = link_target(path).parent_path();
  if (!folder.empty() && !fs::is_directory(folder, error)) {
    return fail(path.string() + ": expected to write, found no folder " + folder.string());
  }
  return {};
}

Result<void> write_file_atomically(const fs::path& path, std::string_view bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) { return fail(path.string() + ": expected a file to write, found a folder"); }
  if (fs::exists(status) && !fs::is_regular_file(status)) { return write_directly(path, bytes); }
  const fs::path target = link_target(path);
  if (std::error_code ignored; fs::is_symlink(fs::symlink_status(target, ignored))) {
    return fail(path.string() + ": expected to write, found: " + error.message());
  }
  return write_and_rename(target, status, bytes);
}

void LineReader::Close::operator()(void* file) const {
  gzclose(static_cast<gzFile>(file));
}

LineReader::LineReader(std::string name, void* file, double file_bytes)
    : name_(std::move(name)), file_(file), file_bytes_(file_bytes), buffer_(chunk_bytes) {}

Result<LineReader> LineReader::open(const fs::path& path) {
  if (auto good = require_file(path); !good) { return tl::unexpected(good.error()); }
  errno = 0;
  gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) { return fail(path.string() + ": expected a readable file, found: " + system_message()); }
  gzbuffer(file, static_cast<unsigned>(chunk_bytes));
  std::error_code ignored;
  const auto bytes = fs::file_size(path, ignored);
  return LineReader(path.string(), file, ignored ? 0.0 : static_cast<double>(bytes));
}

bool LineReader::is_gzip() const {
  return gzdirect(static_cast<gzFile>(file_.get())) == 0;
}

double LineReader::share_read() const {
  if (!(file_bytes_ > 0)) { return 1.0; }
  return std::min(1.0, static_cast<double>(gzoffset(static_cast<gzFile>(file_.get()))) / file_bytes_);
}

void LineReader::mark() {
  mark_ = Mark{begin_, line_};
}

void LineReader::rewind() {
  begin_ = mark_->begin;
  scanned_ = begin_;
  line_ = mark_->line;
  mark_.reset();
}

Result<void> LineReader::refill() {
  if (end_ - begin_ > longest_line) {
    return fail(name_ + ":" + std::to_string(line_ + 1) + ": expected a line of up to 64 MB, found a longer one");
  }
  if (const std::size_t used = mark_ ? mark_->begin : begin_; used > 0) {
    std::memmove(buffer_.data(), buffer_.data() + used, end_ - used);
    end_ -= used;
    scanned_ -= used;
    begin_ -= used;
    if (mark_) { mark_->begin = 0; }
  }
  if (buffer_.size() - end_ < chunk_bytes) { buffer_.resize(std::max(2 * buffer_.size(), end_ + chunk_bytes)); }
  auto* const file = static_cast<gzFile>(file_.get());
  const int n = gzread(file, buffer_.data() + end_, static_cast<unsigned>(chunk_bytes));
  int code = Z_OK;
  std::string_view message = gzerror(file, &code);
  if (message.starts_with(name_ + ": ")) { message.remove_prefix(name_.size() + 2); }
  if (n < 0 || (n == 0 && code == Z_BUF_ERROR)) {  // what came before the cut is handed out first
    const std::string found =
        code == Z_BUF_ERROR ? std::string("gzip data that is cut short") : "broken data: " + std::string(message);
    return fail(name_ + ":" + std::to_string(line_ + 1) + ": expected readable data, found " + found);
  }
  end_ += static_cast<std::size_t>(n);
  at_end_ = n == 0;
  return {};
}

Line LineReader::take_line(std::size_t length, std::size_t end_length, LineEnd end) {
  const Line line{std::string_view(buffer_.data() + begin_, length), ++line_, end};
  begin_ += length + end_length;
  scanned_ = begin_;
  return line;
}

Result<std::optional<Line>> LineReader::next() {
  while (true) {
    const auto is_end = [](char c) { return c == '\n' || c == '\r'; };
    const char* const data = buffer_.data();
    const char* const found = std::find_if(data + scanned_, data + end_, is_end);
    scanned_ = static_cast<std::size_t>(found - data);
    const bool is_sure = scanned_ + 1 < end_ || (scanned_ < end_ && (*found == '\n' || at_end_));  // \r: or is it \r\n?
    if (is_sure) {
      const bool is_pair = *found == '\r' && scanned_ + 1 < end_ && found[1] == '\n';
      return take_line(scanned_ - begin_, is_pair ? 2 : 1, LineEnd::newline);
    }
    if (at_end_) {
      if (begin_ == end_) { return std::nullopt; }
      return take_line(end_ - begin_, 0, LineEnd::end_of_file);
    }
    if (auto good = refill(); !good) { return tl::unexpected(good.error()); }
  }
}

}  // namespace flirt
