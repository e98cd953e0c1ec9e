// flirt/io/byte_reader.hpp: numbers and texts out of little-endian bytes, and where something was wrong.
// Internal to flirt/io.
#pragma once

#include "flirt/core/result.hpp"

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace flirt::bag {

static_assert(std::endian::native == std::endian::little, "recordings are little-endian, so the machine must match");

/// The bytes as text.
[[nodiscard]] inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

[[nodiscard]] inline bool starts_with(std::span<const std::byte> bytes, std::string_view magic) {
  return as_text(bytes).starts_with(magic);
}

/// Takes values from the front of a span. After something was missing all that is taken is 0 or empty: a caller takes
/// what it needs and asks once whether all of it was there.
class ByteReader {
 public:
  /// `record`: where in the file the record with these bytes begins (the chunk, for what was in one); complaints name
  /// it, and the file.
  ByteReader(std::string_view file, std::span<const std::byte> bytes, std::size_t record)
      : file_(file), bytes_(bytes), record_(record) {}

  /// From here on complaints name this place. Only for a reader that began at the file's first byte.
  void begin_record() { record_ = at_; }
  [[nodiscard]] std::size_t record() const { return record_; }
  [[nodiscard]] std::size_t position() const { return at_; }
  [[nodiscard]] std::string_view file() const { return file_; }
  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

  template <std::unsigned_integral T>
  [[nodiscard]] T number(std::string_view what) {
    T value{0};
    const std::span<const std::byte> raw = take(sizeof value, what);
    if (raw.size() == sizeof value) { std::memcpy(&value, raw.data(), sizeof value); }
    return value;
  }

  [[nodiscard]] std::span<const std::byte> take(std::uint64_t n, std::string_view what);
  /// Bytes after their number.
  template <std::unsigned_integral Length = std::uint32_t>
  [[nodiscard]] std::span<const std::byte> sized(std::string_view what) {
    return take(number<Length>(what), what);
  }
  [[nodiscard]] std::span<const std::byte> rest() { return take(bytes_.size() - at_, {}); }

  [[nodiscard]] bool is_cut() const { return !missing_.empty(); }
  /// What was missing first.
  [[nodiscard]] tl::unexpected<Error> cut() const { return wrong(missing_); }
  /// "FILE: at byte N: expected …, found …".
  [[nodiscard]] tl::unexpected<Error> wrong(std::string_view expected_and_found) const;

 private:
  std::string_view file_;
  std::span<const std::byte> bytes_;
  std::size_t record_;
  std::size_t at_{0};
  std::string missing_{};  ///< "4 bytes of a header, found 2: cut short or damaged"; empty while nothing was
};

}  // namespace flirt::bag
