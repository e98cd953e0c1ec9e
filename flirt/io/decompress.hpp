// flirt/io/decompress.hpp: bz2, LZ4 frames and zstd in memory, from data that nobody vouches for. Internal to flirt/io.
#pragma once

#include "flirt/core/result.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace flirt {

/// Bytes of a recording: where they lay when they were not compressed, else in memory of their own.
struct Unpacked {
  std::vector<std::byte> memory{};
  std::span<const std::byte> bytes{};
};

/// The `expected_bytes` in a stream, or in several one after the other, whose compression a recording names: "",
/// "none", "bz2", "lz4" or "zstd". Memory grows with what the data yield, whatever size is expected of them. Errors, to
/// stand after "expected": another compression or size, damage, data cut short, more than 4 GiB expected. O(bytes).
[[nodiscard]] Result<Unpacked> decompress(std::string_view compression, std::span<const std::byte> input,
                                          std::uint64_t expected_bytes);

}  // namespace flirt
