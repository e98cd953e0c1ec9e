#include "flirt/io/byte_reader.hpp"

namespace flirt::bag {

std::span<const std::byte> ByteReader::take(std::uint64_t n, std::string_view what) {
  if (is_cut()) { return {}; }
  const std::size_t left = bytes_.size() - at_;
  if (n > left) {
    missing_ = std::to_string(n) + " bytes of " + std::string(what) + ", found " + std::to_string(left) +
               ": cut short or damaged";
    at_ = bytes_.size();
    return {};
  }
  const std::span<const std::byte> taken = bytes_.subspan(at_, static_cast<std::size_t>(n));
  at_ += taken.size();
  return taken;
}

tl::unexpected<Error> ByteReader::wrong(std::string_view expected_and_found) const {
  return fail(std::string(file_) + ": at byte " + std::to_string(record_) + ": expected " +
              std::string(expected_and_found));
}

}  // namespace flirt::bag
