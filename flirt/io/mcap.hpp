// flirt/io/mcap.hpp: recordings in the container format MCAP. Internal to flirt/io.
#pragma once

#include "flirt/io/bag.hpp"

#include <cstddef>
#include <span>
#include <string>

namespace flirt::bag {

[[nodiscard]] bool is_mcap(std::span<const std::byte> bytes);

/// Hands out the messages of the data section in its order, those of encoding "ros1" or "cdr"; other channels and
/// records are skipped. Channels without schema have no type. Chunks plain, lz4 or zstd, with their checksums. `name`
/// stands in complaints, with the byte of the record or chunk. Errors: a recording without end (after all that is whole
/// was handed out), damage, messages of unknown channels, what the sink returns. O(bytes).
/// Format: https://mcap.dev/spec
[[nodiscard]] Result<void> read_mcap(const std::string& name, std::span<const std::byte> bytes, const Sink& sink,
                                     const Progress& progress);

}  // namespace flirt::bag
