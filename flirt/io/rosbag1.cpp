#include "flirt/io/rosbag1.hpp"

#include "flirt/io/byte_reader.hpp"
#include "flirt/io/decompress.hpp"

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <unordered_map>

namespace flirt::bag {
namespace {

constexpr std::string_view rosbag1_magic = "#ROSBAG V2.0\n";

enum class Rosbag1Op : std::uint8_t { message = 0x02, chunk = 0x05, connection = 0x07 };

/// Those fields of a record's header that are of use here; absent ones, and numbers of a wrong size, are empty.
struct Fields {
  std::optional<std::uint8_t> op{};
  std::optional<std::uint32_t> connection{};
  std::optional<std::uint32_t> size{};  ///< of a chunk's records, unpacked
  std::string_view compression{};
  std::string_view topic{};
  std::string_view type{};
};

struct Connection {
  std::string topic{};
  std::string type{};
};

template <std::unsigned_integral T>
std::optional<T> number_in(std::span<const std::byte> value) {
  T number{0};
  if (value.size() != sizeof number) { return std::nullopt; }
  std::memcpy(&number, value.data(), sizeof number);
  return number;
}

void set_field(Fields& fields, std::string_view name, std::span<const std::byte> value) {
  if (name == "op") {
    fields.op = number_in<std::uint8_t>(value);
  } else if (name == "conn") {
    fields.connection = number_in<std::uint32_t>(value);
  } else if (name == "size") {
    fields.size = number_in<std::uint32_t>(value);
  } else if (name == "compression") {
    fields.compression = as_text(value);
  } else if (name == "topic") {
    fields.topic = as_text(value);
  } else if (name == "type") {
    fields.type = as_text(value);
  }
}

Result<Fields> parse_fields(ByteReader reader) {
  Fields fields;
  while (!reader.at_end()) {
    const std::span<const std::byte> field = reader.sized("a header field");
    if (reader.is_cut()) { return reader.cut(); }
    const std::size_t equals = as_text(field).find('=');
    if (equals == std::string_view::npos) { return reader.wrong("a header field with =, found none"); }
    set_field(fields, as_text(field.first(equals)), field.subspan(equals + 1));
  }
  return fields;
}

class BagReader {
 public:
  explicit BagReader(const Sink& sink) : sink_(sink) {}
  Result<void> read_record(ByteReader& reader);

 private:
  Result<void> add_connection(const Fields& fields, const ByteReader& data);
  Result<void> read_chunk(const Fields& fields, ByteReader& data);
  [[nodiscard]] Result<void> hand_out(const Fields& fields, ByteReader& data) const;

  const Sink& sink_;
  std::unordered_map<std::uint32_t, Connection> connections_{};
  bool is_in_chunk_{false};
};

Result<void> BagReader::read_record(ByteReader& reader) {
  const std::span<const std::byte> header = reader.sized("a record's header");
  const std::span<const std::byte> bytes = reader.sized("a record's data");
  if (reader.is_cut()) { return reader.cut(); }
  const Result<Fields> fields = parse_fields(ByteReader(reader.file(), header, reader.record()));
  if (!fields) { return tl::unexpected(fields.error()); }
  if (!fields->op) { return reader.wrong("a header field op of 1 byte, found none"); }
  ByteReader data(reader.file(), bytes, reader.record());
  switch (static_cast<Rosbag1Op>(*fields->op)) {
    case Rosbag1Op::connection:
      return add_connection(*fields, data);
    case Rosbag1Op::chunk:
      return read_chunk(*fields, data);
    case Rosbag1Op::message:
      return hand_out(*fields, data);
  }
  return {};  // the bag's header, its index
}

Result<void> BagReader::add_connection(const Fields& fields, const ByteReader& data) {
  const Result<Fields> described = parse_fields(data);
  if (!described) { return tl::unexpected(described.error()); }
  if (!fields.connection) { return data.wrong("a connection's field conn of 4 bytes, found none"); }
  connections_.insert_or_assign(*fields.connection,
                                Connection{std::string(fields.topic), std::string(described->type)});
  return {};
}

Result<void> BagReader::read_chunk(const Fields& fields, ByteReader& data) {
  if (is_in_chunk_) { return data.wrong("no chunk inside a chunk, found one"); }
  if (!fields.size) { return data.wrong("a chunk's field size of 4 bytes, found none"); }
  if (data.at_end() && fields.compression != "none") {  // "none": the records follow, outside of the chunk
    return data.wrong("a chunk that its recorder has closed, found one without data: the recording was cut");
  }
  const Result<Unpacked> unpacked = decompress(fields.compression, data.rest(), *fields.size);
  if (!unpacked) { return data.wrong(unpacked.error().message); }
  ByteReader records(data.file(), unpacked->bytes, data.record());
  is_in_chunk_ = true;
  while (!records.at_end()) {
    if (auto read = read_record(records); !read) { return read; }
  }
  is_in_chunk_ = false;
  return {};
}

Result<void> BagReader::hand_out(const Fields& fields, ByteReader& data) const {
  if (!fields.connection) { return data.wrong("a message's field conn of 4 bytes, found none"); }
  const auto connection = connections_.find(*fields.connection);
  if (connection == connections_.end()) {
    return data.wrong("a connection before its messages, found none for " + std::to_string(*fields.connection));
  }
  return sink_({connection->second.topic, connection->second.type, Serialization::ros1, data.rest()});
}

}  // namespace

bool is_rosbag1(std::span<const std::byte> bytes) {
  return starts_with(bytes, rosbag1_magic);
}

Result<void> read_rosbag1(const std::string& name, std::span<const std::byte> bytes, const Sink& sink,
                          const Progress& progress) {
  ByteReader file(name, bytes, 0);
  if (!is_rosbag1(file.take(std::min(bytes.size(), rosbag1_magic.size()), "the magic"))) {
    return file.wrong("a ROS bag, which begins with #ROSBAG V2.0, found another file");
  }
  BagReader bag(sink);
  while (!file.at_end()) {
    file.begin_record();
    if (auto read = bag.read_record(file); !read) { return read; }
    if (progress) { progress(static_cast<double>(file.position()) / static_cast<double>(bytes.size())); }
  }
  return {};
}

}  // namespace flirt::bag
