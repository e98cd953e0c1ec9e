#include "flirt/io/rosbag2.hpp"

#include "flirt/io/byte_reader.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/recording_file.hpp"

#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <unordered_map>
#include <utility>

namespace flirt::bag {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view sqlite_magic("SQLite format 3\0", 16);

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct EndStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, EndStatement>;

/// Whether the file keeps a write-ahead log while it is open: byte 18 of the header.
bool uses_write_ahead_log(const fs::path& path) {
  std::array<char, 19> header{};
  std::ifstream(path, std::ios::binary).read(header.data(), header.size());
  return header.back() == 2;
}

/// Whether sqlite may take the file as it is, without locks and logs of writers beside it. It must where the folder
/// cannot be written to, and should where the file would have a write-ahead log if anyone had it open: sqlite makes one
/// even to read, and leaves it behind.
bool is_at_rest(const fs::path& path) {
  std::error_code missing;
  if (const auto log_bytes = fs::file_size(path.string() + "-wal", missing); !missing && log_bytes > 0) {
    return false;
  }
  return ::access(path.parent_path().c_str(), W_OK) != 0 || uses_write_ahead_log(path);
}

std::string uri_of(const fs::path& path) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::error_code ignored;
  const fs::path whole = fs::absolute(path, ignored);
  std::string uri = "file://";
  for (const char c : whole.string()) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
                          c == '.' || c == '_' || c == '-';
    const auto byte = static_cast<unsigned char>(c);
    uri += is_plain ? std::string(1, c) : std::string{'%', digits[byte / 16U], digits[byte % 16U]};
  }
  return is_at_rest(whole) ? uri + "?immutable=1" : uri;
}

/// A file of sqlite, open to be read.
class Table {
 public:
  static Result<Table> open(const fs::path& path);
  [[nodiscard]] Result<Statement> prepare(const char* query) const;
  /// Whether there is another row; an error when the file cannot be read.
  [[nodiscard]] Result<bool> next_row(const Statement& statement) const;
  /// The single number that a query yields, 0 for null.
  [[nodiscard]] Result<std::int64_t> number(const char* query) const;
  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& expected_and_found) const {
    return fail(path_.string() + ": expected " + expected_and_found);
  }

 private:
  Table(fs::path path, Database database) : path_(std::move(path)), database_(std::move(database)) {}
  [[nodiscard]] tl::unexpected<Error> sqlite_failure() const {
    return wrong("a readable recording, found: " + std::string(sqlite3_errmsg(database_.get())));
  }
  fs::path path_;
  Database database_;
};

Result<Table> Table::open(const fs::path& path) {
  if (auto plain = require_plain_file(path); !plain) { return tl::unexpected(plain.error()); }
  sqlite3* opened = nullptr;
  const int code = sqlite3_open_v2(uri_of(path).c_str(), &opened,
                                   SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
  Table table(path, Database(opened));
  if (code != SQLITE_OK) { return table.sqlite_failure(); }
  // A recording is data, not a program: none of the functions that a schema could call.
  sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  return table;
}

Result<Statement> Table::prepare(const char* query) const {
  sqlite3_stmt* prepared = nullptr;
  if (sqlite3_prepare_v2(database_.get(), query, -1, &prepared, nullptr) != SQLITE_OK) { return sqlite_failure(); }
  return Statement(prepared);
}

Result<bool> Table::next_row(const Statement& statement) const {
  const int code = sqlite3_step(statement.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) { return sqlite_failure(); }
  return code == SQLITE_ROW;
}

Result<std::int64_t> Table::number(const char* query) const {
  const Result<Statement> statement = prepare(query);
  if (!statement) { return tl::unexpected(statement.error()); }
  const Result<bool> row = next_row(*statement);
  if (!row) { return tl::unexpected(row.error()); }
  return *row ? sqlite3_column_int64(statement->get(), 0) : 0;
}

/// The bytes of a text or blob; they last until the next row.
std::span<const std::byte> column_bytes(const Statement& statement, int column) {
  const void* const bytes = sqlite3_column_blob(statement.get(), column);
  if (bytes == nullptr) { return {}; }
  return {static_cast<const std::byte*>(bytes),
          static_cast<std::size_t>(sqlite3_column_bytes(statement.get(), column))};
}

struct Topic {
  std::string name{};
  std::string type{};
};
using Topics = std::unordered_map<std::int64_t, Topic>;

Result<Topics> topics_of(const Table& table) {
  const Result<Statement> statement =
      table.prepare("SELECT id, name, type FROM topics WHERE serialization_format = 'cdr'");
  if (!statement) { return tl::unexpected(statement.error()); }
  Topics topics;
  for (;;) {
    const Result<bool> row = table.next_row(*statement);
    if (!row) { return tl::unexpected(row.error()); }
    if (!*row) { return topics; }
    topics.insert_or_assign(
        sqlite3_column_int64(statement->get(), 0),
        Topic{std::string(as_text(column_bytes(*statement, 1))), plain_type(as_text(column_bytes(*statement, 2)))});
  }
}

Result<void> hand_out(const Table& table, const Topics& topics, const Sink& sink, const Progress& progress) {
  const Result<std::int64_t> count = table.number("SELECT count(*) FROM messages");
  if (!count) { return tl::unexpected(count.error()); }
  const Result<Statement> statement = table.prepare("SELECT topic_id, data FROM messages ORDER BY timestamp, id");
  if (!statement) { return tl::unexpected(statement.error()); }
  for (std::int64_t i = 0;; ++i) {
    const Result<bool> row = table.next_row(*statement);
    if (!row) { return tl::unexpected(row.error()); }
    if (!*row) { return {}; }
    const auto topic = topics.find(sqlite3_column_int64(statement->get(), 0));
    if (topic == topics.end()) { continue; }
    const std::span<const std::byte> bytes = column_bytes(*statement, 1);
    if (auto taken = sink({topic->second.name, topic->second.type, Serialization::cdr, bytes}); !taken) {
      return taken;
    }
    if (progress) { progress(static_cast<double>(i + 1) / static_cast<double>(std::max(i + 1, *count))); }
  }
}

// The folder of a recording.

std::string_view trimmed(std::string_view text, std::string_view what = " \t\r") {
  const std::size_t begin = text.find_first_not_of(what);
  if (begin == std::string_view::npos) { return {}; }
  return text.substr(begin, text.find_last_not_of(what) - begin + 1);
}

/// What a line "key: value" says, without quotes; nothing for other lines.
std::optional<std::string_view> value_of(std::string_view line, std::string_view key) {
  if (!line.starts_with(key) || !line.substr(key.size()).starts_with(':')) { return std::nullopt; }
  return trimmed(line.substr(key.size() + 1), " \t\r\"'");
}

struct Metadata {
  std::vector<std::string> files{};
  bool compresses_messages{false};
};

Metadata parse_metadata(std::string_view text) {
  Metadata metadata;
  bool is_in_list = false;
  while (!text.empty()) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, length));
    text.remove_prefix(std::min(length + 1, text.size()));
    if (line.empty() || line.starts_with('#')) { continue; }
    if (is_in_list && line.starts_with("- ")) {
      metadata.files.emplace_back(trimmed(line.substr(2), " \t\"'"));
      continue;
    }
    is_in_list = value_of(line, "relative_file_paths").has_value();
    const auto mode = value_of(line, "compression_mode");
    if (mode && (*mode == "MESSAGE" || *mode == "message")) { metadata.compresses_messages = true; }
  }
  return metadata;
}

Result<fs::path> find_file(const fs::path& folder, const std::string& name) {
  // Up to version 3 of the metadata, names began with the folder's, which may have been renamed since.
  for (fs::path file : {folder / name, folder / fs::path(name).filename()}) {
    const std::optional<fs::path> unpacked = unpacked_name(file);
    if (unpacked && is_file(*unpacked)) { return *unpacked; }
    if (!is_file(file)) { continue; }
    if (auto plain = require_plain_file(file); !plain) { return tl::unexpected(plain.error()); }
    return file;
  }
  return fail((folder / name).string() + ": expected the file that metadata.yaml lists, found none");
}

}  // namespace

bool is_sqlite(std::span<const std::byte> bytes) {
  return starts_with(bytes, sqlite_magic);
}

Result<void> read_sqlite_bag(const fs::path& path, const Sink& sink, const Progress& progress) {
  const Result<Table> table = Table::open(path);
  if (!table) { return tl::unexpected(table.error()); }
  const Result<std::int64_t> tables =
      table->number("SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages')");
  if (!tables) { return tl::unexpected(tables.error()); }
  if (*tables != 2) { return table->wrong("a recording of ROS 2 with tables topics and messages, found none"); }
  const Result<Topics> topics = topics_of(*table);
  if (!topics) { return tl::unexpected(topics.error()); }
  return hand_out(*table, *topics, sink, progress);
}

Result<std::vector<fs::path>> files_of_recording(const fs::path& folder) {
  const fs::path description = folder / "metadata.yaml";
  if (!is_file(description)) {
    return fail(folder.string() + ": expected a recording with a metadata.yaml, found none");
  }
  const Result<std::string> text = read_file(description);
  if (!text) { return tl::unexpected(text.error()); }
  const Metadata metadata = parse_metadata(*text);
  if (metadata.compresses_messages) {
    return fail(description.string() +
                ": expected messages that are not compressed one by one, found compression_mode: MESSAGE: run ros2 bag "
                "convert without compression");
  }
  if (metadata.files.empty()) {
    return fail(description.string() + ": expected files below relative_file_paths, found none");
  }
  std::vector<fs::path> files;
  for (const std::string& name : metadata.files) {
    Result<fs::path> file = find_file(folder, name);
    if (!file) { return tl::unexpected(file.error()); }
    files.push_back(std::move(*file));
  }
  return files;
}

}  // namespace flirt::bag
