// Chunks of recordings: one stream of a compressor or several, whole or damaged.
#include "flirt/io/decompress.hpp"

#include "flirt/core/rng.hpp"

#include "tests/io/bag_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace flirt {
namespace {

using testing::HasSubstr;

constexpr std::array compressed_packings{Packing::bz2, Packing::lz4, Packing::zstd};

Result<std::string> unpacked(Packing packing, const std::string& bytes, std::size_t expected) {
  const auto found = decompress(packing_name(packing, "none"), std::as_bytes(std::span(bytes)), expected);
  if (!found) { return tl::unexpected(found.error()); }
  return std::string(reinterpret_cast<const char*>(found->bytes.data()), found->bytes.size());
}

std::string long_text() {
  std::string text;
  for (int i = 0; i < 30'000; ++i) { text += std::to_string(i * 7919 % 1000) + ' '; }
  return text;
}

TEST(Decompress, ReadsSeveralStreamsAsOne) {
  const std::string text = long_text();
  for (const Packing packing : compressed_packings) {
    for (const std::size_t first : {std::size_t{0}, std::size_t{1}, text.size() / 3, text.size()}) {
      const std::string streams = packed(std::string_view(text).substr(0, first), packing) +
                                  packed(std::string_view(text).substr(first), packing);
      EXPECT_TRUE(unpacked(packing, streams, text.size()) == text) << packing_name(packing, "none") << ' ' << first;
    }
  }
}

TEST(Decompress, TheLastStreamMayNotEndEarlyNorHoldMore) {
  const std::string text = long_text();
  for (const Packing packing : compressed_packings) {
    const std::string one = packed(text, packing);
    EXPECT_THAT(unpacked(packing, one, text.size() + 1).error().message,
                HasSubstr("found " + std::to_string(text.size())));
    EXPECT_THAT(unpacked(packing, one + one, text.size() + 1).error().message, HasSubstr("found more"));
    EXPECT_THAT(unpacked(packing, one + one.substr(0, one.size() / 2), 2 * text.size()).error().message,
                HasSubstr("cut short"));
    EXPECT_THAT(unpacked(packing, one + "no stream at all, but text", 2 * text.size()).error().message,
                HasSubstr("damage"));
  }
}

TEST(Decompress, CutOrFlippedAnywhereGivesBytesOrAnError) {
  const std::string text = long_text().substr(0, 2000);
  Rng rng(7);
  for (const Packing packing : compressed_packings) {
    const std::string streams = packed(text, packing) + packed(text, packing);
    for (std::size_t size = 0; size < streams.size(); ++size) {
      EXPECT_FALSE(unpacked(packing, streams.substr(0, size), 2 * text.size())) << size;
      std::string flipped = streams;
      flipped[size] = static_cast<char>(flipped[size] ^ static_cast<char>(1 + rng.below(255)));
      if (const auto found = unpacked(packing, flipped, 2 * text.size())) { EXPECT_EQ(found->size(), 2 * text.size()); }
    }
  }
}

}  // namespace
}  // namespace flirt
