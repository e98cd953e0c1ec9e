#include "flirt/io/mcap.hpp"

#include "flirt/io/byte_reader.hpp"
#include "flirt/io/decompress.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_map>

namespace flirt::bag {
namespace {

constexpr std::string_view mcap_magic = "\x89MCAP0\r\n";

enum class McapOp : std::uint8_t {
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  data_end = 0x0F
};

struct Channel {
  std::string topic{};
  std::string type{};
  std::optional<Serialization> serialization{};  ///< nothing: messages are skipped
};

std::optional<Serialization> serialization_named(std::string_view encoding) {
  if (encoding == "ros1") { return Serialization::ros1; }
  if (encoding == "cdr") { return Serialization::cdr; }
  return std::nullopt;
}

class McapReader {
 public:
  explicit McapReader(const Sink& sink) : sink_(sink) {}
  Result<void> read_record(ByteReader& reader);
  /// Nothing of the data section follows.
  [[nodiscard]] bool has_ended() const { return has_ended_; }

 private:
  Result<void> add_schema(ByteReader& record);
  Result<void> add_channel(ByteReader& record);
  Result<void> read_chunk(ByteReader& record);
  [[nodiscard]] Result<void> hand_out(ByteReader& record) const;

  const Sink& sink_;
  std::unordered_map<std::uint16_t, std::string> schemas_{};  ///< types by number
  std::unordered_map<std::uint16_t, Channel> channels_{};
  bool is_in_chunk_{false};
  bool has_ended_{false};
};

Result<void> McapReader::read_record(ByteReader& reader) {
  const auto op = reader.number<std::uint8_t>("a record's opcode");
  const std::span<const std::byte> content = reader.sized<std::uint64_t>("a record");
  if (reader.is_cut()) { return reader.cut(); }
  ByteReader record(reader.file(), content, reader.record());
  switch (static_cast<McapOp>(op)) {
    case McapOp::schema:
      return add_schema(record);
    case McapOp::channel:
      return add_channel(record);
    case McapOp::message:
      return hand_out(record);
    case McapOp::chunk:
      return read_chunk(record);
    case McapOp::data_end:
    case McapOp::footer:
      has_ended_ = !is_in_chunk_;
      return {};
  }
  return {};  // the file's header, indexes, attachments, metadata
}

Result<void> McapReader::add_schema(ByteReader& record) {
  const auto id = record.number<std::uint16_t>("a schema's id");
  const std::span<const std::byte> name = record.sized("a schema's name");
  if (record.is_cut()) { return record.cut(); }
  schemas_.insert_or_assign(id, plain_type(as_text(name)));
  return {};
}

Result<void> McapReader::add_channel(ByteReader& record) {
  const auto id = record.number<std::uint16_t>("a channel's id");
  const auto schema = record.number<std::uint16_t>("a channel's schema");
  const std::span<const std::byte> topic = record.sized("a channel's topic");
  const std::span<const std::byte> encoding = record.sized("a channel's encoding");
  if (record.is_cut()) { return record.cut(); }
  const auto type = schemas_.find(schema);
  if (schema != 0 && type == schemas_.end()) {
    return record.wrong("a schema before its channels, found none for " + std::to_string(schema));
  }
  channels_.insert_or_assign(id, Channel{std::string(as_text(topic)), schema == 0 ? std::string() : type->second,
                                         serialization_named(as_text(encoding))});
  return {};
}

Result<void> McapReader::read_chunk(ByteReader& record) {
  if (is_in_chunk_) { return record.wrong("no chunk inside a chunk, found one"); }
  (void)record.take(2 * sizeof(std::uint64_t), "a chunk's times");
  const auto size = record.number<std::uint64_t>("a chunk's size");
  const auto crc = record.number<std::uint32_t>("a chunk's checksum");
  const std::span<const std::byte> compression = record.sized("a chunk's compression");
  const std::span<const std::byte> packed = record.sized<std::uint64_t>("a chunk's records");
  if (record.is_cut()) { return record.cut(); }
  const Result<Unpacked> unpacked = decompress(as_text(compression), packed, size);
  if (!unpacked) { return record.wrong(unpacked.error().message); }
  const std::span<const std::byte> bytes = unpacked->bytes;
  if (crc != 0 && crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()) != crc) {
    return record.wrong("a chunk that its checksum fits, found damage");
  }
  ByteReader records(record.file(), bytes, record.record());
  is_in_chunk_ = true;
  while (!records.at_end()) {
    if (auto read = read_record(records); !read) { return read; }
  }
  is_in_chunk_ = false;
  return {};
}

Result<void> McapReader::hand_out(ByteReader& record) const {
  const auto id = record.number<std::uint16_t>("a message's channel");
  (void)record.take(sizeof(std::uint32_t) + 2 * sizeof(std::uint64_t), "a message's sequence and times");
  if (record.is_cut()) { return record.cut(); }
  const auto channel = channels_.find(id);
  if (channel == channels_.end()) {
    return record.wrong("a channel before its messages, found none for " + std::to_string(id));
  }
  const auto& [topic, type, serialization] = channel->second;
  if (!serialization) { return {}; }
  return sink_({topic, type, *serialization, record.rest()});
}

}  // namespace

bool is_mcap(std::span<const std::byte> bytes) {
  return starts_with(bytes, mcap_magic);
}

Result<void> read_mcap(const std::string& name, std::span<const std::byte> bytes, const Sink& sink,
                       const Progress& progress) {
  ByteReader file(name, bytes, 0);
  if (!is_mcap(file.take(std::min(bytes.size(), mcap_magic.size()), "the magic"))) {
    return file.wrong("an MCAP file, which begins with MCAP0, found another file");
  }
  McapReader mcap(sink);
  while (!mcap.has_ended()) {
    file.begin_record();
    if (file.at_end()) { return file.wrong("the end of a recording, found the end of the file: it was cut"); }
    if (auto read = mcap.read_record(file); !read) { return read; }
    if (progress) { progress(static_cast<double>(file.position()) / static_cast<double>(bytes.size())); }
  }
  if (progress) { progress(1.0); }
  return {};
}

}  // namespace flirt::bag
