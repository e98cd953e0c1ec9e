// tests/io/bag_files.hpp: recordings of ROS for tests: ROS 1 bags, MCAP and sqlite3, from a list of messages.
#pragma once

#include "flirt/io/bag.hpp"

#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

/// A message to be written, or one that was read.
struct BagMessage {
  std::string topic{};                 ///< "/scan"
  std::string type{};                  ///< "sensor_msgs/LaserScan", also for ROS 2
  bag::Serialization serialization{};  ///< MCAP only: a ROS 1 bag and a db3 have but one
  std::string bytes{};                 ///< of the message
  friend bool operator==(const BagMessage&, const BagMessage&) = default;
};

enum class Packing : std::uint8_t {
  outside,  ///< messages stand in the file itself, not in chunks
  none,
  bz2,
  lz4,
  zstd,
};

struct BagShape {
  Packing packing{Packing::none};
  std::size_t messages_per_chunk{2};
  bool finished{true};  ///< with the index and the end that a recorder writes when it closes the file
};

template <std::integral T>
[[nodiscard]] std::string little_endian(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

/// The bytes after their length.
template <std::integral Length = std::uint32_t>
[[nodiscard]] std::string sized(std::string_view bytes) {
  return little_endian(static_cast<Length>(bytes.size())) + std::string(bytes);
}

[[nodiscard]] inline std::string packed(std::string_view bytes, Packing packing) {
  std::string result(2 * bytes.size() + 4096, '\0');
  if (packing == Packing::bz2) {
    auto size = static_cast<unsigned>(result.size());
    std::string input(bytes);
    EXPECT_EQ(
        BZ2_bzBuffToBuffCompress(result.data(), &size, input.data(), static_cast<unsigned>(input.size()), 9, 0, 0),
        BZ_OK);
    result.resize(size);
  } else if (packing == Packing::lz4) {
    LZ4F_preferences_t preferences = LZ4F_INIT_PREFERENCES;
    preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;  // as ROS 1 writes it
    result.resize(LZ4F_compressFrame(result.data(), result.size(), bytes.data(), bytes.size(), &preferences));
  } else if (packing == Packing::zstd) {
    result.resize(ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), 1));
  } else {
    result = bytes;
  }
  return result;
}

[[nodiscard]] inline std::string_view packing_name(Packing packing, std::string_view none) {
  switch (packing) {
    case Packing::bz2:
      return "bz2";
    case Packing::lz4:
      return "lz4";
    case Packing::zstd:
      return "zstd";
    default:
      return none;
  }
}

/// Numbers from 1 for the different keys, in their order of appearance.
[[nodiscard]] inline std::map<std::pair<std::string, std::string>, std::uint16_t> numbered_topics(
    std::span<const BagMessage> messages) {
  std::map<std::pair<std::string, std::string>, std::uint16_t> numbers;
  for (const BagMessage& message : messages) {
    const auto next = static_cast<std::uint16_t>(numbers.size() + 1);
    numbers.try_emplace({message.topic, message.type}, next);
  }
  return numbers;
}

/// When message i was recorded: 10 a second.
[[nodiscard]] inline std::uint64_t recorded_ns(std::size_t i) {
  return 1'700'000'000'000'000'000U + i * 100'000'000U;
}

// ROS 1.

using BagFields = std::initializer_list<std::pair<std::string_view, std::string>>;

[[nodiscard]] inline std::string rosbag1_fields(BagFields fields) {
  std::string bytes;
  for (const auto& [name, value] : fields) { bytes += sized(std::string(name) + '=' + value); }
  return bytes;
}

[[nodiscard]] inline std::string rosbag1_record(BagFields header, std::string_view data) {
  return sized(rosbag1_fields(header)) + sized(data);
}

/// A bag of format 2.0.
[[nodiscard]] inline std::string rosbag1_file(std::span<const BagMessage> messages, const BagShape& shape = {}) {
  const auto numbers = numbered_topics(messages);
  std::string file = "#ROSBAG V2.0\n" + rosbag1_record({{"op", "\x03"},
                                                        {"index_pos", little_endian(std::uint64_t{0})},
                                                        {"conn_count", little_endian(std::uint32_t{0})},
                                                        {"chunk_count", little_endian(std::uint32_t{0})}},
                                                       std::string(64, ' '));
  std::string chunk;
  std::vector<std::uint16_t> introduced;
  std::string index;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const BagMessage& message = messages[i];
    const std::uint16_t number = numbers.at({message.topic, message.type});
    const std::string id = little_endian(std::uint32_t{number});
    if (std::find(introduced.begin(), introduced.end(), number) == introduced.end()) {
      introduced.push_back(number);
      const std::string connection =
          rosbag1_record({{"op", "\x07"}, {"conn", id}, {"topic", message.topic}},
                         rosbag1_fields({{"callerid", "/test"}, {"md5sum", "0"}, {"type", message.type}}));
      chunk += connection;
      index += connection;
    }
    const auto seconds = static_cast<std::uint32_t>(recorded_ns(i) / 1'000'000'000U);
    const auto rest = static_cast<std::uint32_t>(recorded_ns(i) % 1'000'000'000U);
    chunk += rosbag1_record({{"op", "\x02"}, {"conn", id}, {"time", little_endian(seconds) + little_endian(rest)}},
                            message.bytes);
    if ((i + 1) % shape.messages_per_chunk == 0 || i + 1 == messages.size()) {
      if (shape.packing == Packing::outside) {
        file += chunk;
      } else {
        file += rosbag1_record({{"op", "\x05"},
                                {"compression", std::string(packing_name(shape.packing, "none"))},
                                {"size", little_endian(static_cast<std::uint32_t>(chunk.size()))}},
                               packed(chunk, shape.packing));
        if (shape.finished) { file += rosbag1_record({{"op", "\x04"}, {"conn", id}}, std::string(12, '\0')); }
      }
      chunk.clear();
    }
  }
  if (shape.finished) { file += index + rosbag1_record({{"op", "\x06"}}, std::string(8, '\0')); }
  return file;
}

// MCAP.

[[nodiscard]] inline std::string mcap_record(char opcode, std::string_view content) {
  return opcode + sized<std::uint64_t>(content);
}

inline constexpr std::string_view mcap_magic = "\x89MCAP0\r\n";

/// "sensor_msgs/LaserScan" as ROS 2 writes it.
[[nodiscard]] inline std::string ros2_type(std::string type) {
  if (const std::size_t slash = type.find('/'); slash != std::string::npos) { type.insert(slash, "/msg"); }
  return type;
}

[[nodiscard]] inline std::string mcap_file(std::span<const BagMessage> messages, const BagShape& shape = {}) {
  const auto numbers = numbered_topics(messages);
  std::string file = std::string(mcap_magic) + mcap_record('\x01', sized("") + sized("test"));
  std::string chunk;
  std::vector<std::uint16_t> introduced;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const BagMessage& message = messages[i];
    const std::string id = little_endian(numbers.at({message.topic, message.type}));
    if (std::find(introduced.begin(), introduced.end(), numbers.at({message.topic, message.type})) ==
        introduced.end()) {
      introduced.push_back(numbers.at({message.topic, message.type}));
      const bool is_cdr = message.serialization == bag::Serialization::cdr;
      chunk += mcap_record('\x03', id + sized(is_cdr ? ros2_type(message.type) : message.type) +
                                       sized(is_cdr ? "ros2msg" : "ros1msg") + sized("# definition"));
      chunk += mcap_record('\x04', id + id + sized(message.topic) + sized(is_cdr ? "cdr" : "ros1") + sized(""));
    }
    chunk += mcap_record('\x05', id + little_endian(static_cast<std::uint32_t>(i)) + little_endian(recorded_ns(i)) +
                                     little_endian(recorded_ns(i)) + message.bytes);
    if ((i + 1) % shape.messages_per_chunk == 0 || i + 1 == messages.size()) {
      if (shape.packing == Packing::outside) {
        file += chunk;
      } else {
        const auto crc =
            static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(chunk.data()), chunk.size()));
        file += mcap_record('\x06', little_endian(recorded_ns(0)) + little_endian(recorded_ns(i)) +
                                        little_endian(std::uint64_t{chunk.size()}) + little_endian(crc) +
                                        sized(packing_name(shape.packing, "")) +
                                        sized<std::uint64_t>(packed(chunk, shape.packing)));
      }
      chunk.clear();
    }
  }
  if (shape.finished) {
    file += mcap_record('\x0F', std::string(4, '\0')) + mcap_record('\x02', std::string(20, '\0'));
    file += mcap_magic;
  }
  return file;
}

// ROS 2's sqlite3.

/// Runs statements; what goes wrong fails the test.
inline void run_sql(const std::filesystem::path& path, const std::string& statements) {
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  char* complaint = nullptr;
  EXPECT_EQ(sqlite3_exec(database, statements.c_str(), nullptr, nullptr, &complaint), SQLITE_OK) << complaint;
  sqlite3_free(complaint);
  sqlite3_close(database);
}

[[nodiscard]] inline std::string sql_blob(std::string_view bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text("x'");
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    text += digits[byte / 16U];
    text += digits[byte % 16U];
  }
  return text + "'";
}

/// A new .db3 file; rows are stored last message first, as only their stamps give the order.
inline void write_db3(const std::filesystem::path& path, std::span<const BagMessage> messages) {
  const auto numbers = numbered_topics(messages);
  std::string sql =
      "BEGIN;"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
      " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,"
      " data BLOB NOT NULL);"
      "CREATE INDEX timestamp_idx ON messages(timestamp ASC);";
  for (const auto& [key, number] : numbers) {
    sql += "INSERT INTO topics VALUES(" + std::to_string(number) + ",'" + key.first + "','" + ros2_type(key.second) +
           "','cdr','');";
  }
  for (std::size_t i = messages.size(); i-- > 0;) {
    sql += "INSERT INTO messages(topic_id, timestamp, data) VALUES(" +
           std::to_string(numbers.at({messages[i].topic, messages[i].type})) + "," + std::to_string(recorded_ns(i)) +
           "," + sql_blob(messages[i].bytes) + ");";
  }
  run_sql(path, sql + "COMMIT;");
}

/// The metadata.yaml of a recording whose files are named.
inline void write_metadata(const std::filesystem::path& folder, std::span<const std::string> files) {
  std::ofstream file(folder / "metadata.yaml");
  file << "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n  duration:\n    nanoseconds: 0\n"
          "  relative_file_paths:\n";
  for (const std::string& name : files) { file << "    - " << name << '\n'; }
  file << "  topics_with_message_count:\n    - topic_metadata:\n        name: /scan\n  compression_format: \"\"\n"
          "  compression_mode: \"\"\n";
}

// Reading.

/// Two topics in turn; messages of different lengths, the first of none.
[[nodiscard]] inline std::vector<BagMessage> example_messages(std::size_t n, bag::Serialization serialization) {
  std::vector<BagMessage> messages;
  for (std::size_t i = 0; i < n; ++i) {
    const std::string bytes(i * 3, static_cast<char>(i));
    messages.push_back(i % 2 == 0 ? BagMessage{"/scan", "sensor_msgs/LaserScan", serialization, bytes}
                                  : BagMessage{"/odom", "nav_msgs/Odometry", serialization, bytes});
  }
  return messages;
}

/// Keeps what a reader hands out.
[[nodiscard]] inline bag::Sink keep_in(std::vector<BagMessage>& messages) {
  return [&messages](const bag::Message& message) -> Result<void> {
    std::string bytes(message.bytes.size(), '\0');
    if (!bytes.empty()) { std::memcpy(bytes.data(), message.bytes.data(), bytes.size()); }
    messages.push_back({std::string(message.topic), std::string(message.type), message.serialization, bytes});
    return {};
  };
}

/// What was handed out, and the complaint that ended it; empty when there was none.
struct BagOutcome {
  std::vector<BagMessage> messages{};
  std::string complaint{};
};

using BagReading = Result<void> (*)(const std::string&, std::span<const std::byte>, const bag::Sink&, const Progress&);

/// Reads a file that lies in memory of exactly its size.
[[nodiscard]] inline BagOutcome outcome_of(BagReading read, std::string_view file) {
  const std::vector<char> bytes(file.begin(), file.end());
  BagOutcome outcome;
  if (auto done = read("test.bag", std::as_bytes(std::span(bytes)), keep_in(outcome.messages), {}); !done) {
    outcome.complaint = done.error().message;
  }
  return outcome;
}

/// Whether `some` are among `all` in the same order.
[[nodiscard]] inline bool are_some_of(std::span<const BagMessage> some, std::span<const BagMessage> all) {
  std::size_t found = 0;
  for (const BagMessage& message : all) {
    if (found < some.size() && some[found] == message) { ++found; }
  }
  return found == some.size();
}

}  // namespace flirt
