// flirt/io/pgm.hpp: PGM images in memory (portable grey maps, binary P5 and text P2).
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/grid/grey_image.hpp"

#include <cstddef>
#include <string>
#include <string_view>

namespace flirt {

/// Of the largest image that is read, PGM or PNG.
inline constexpr std::size_t most_pixels = std::size_t{1} << 28U;
/// Of its width and of its height: what readers of PNG take.
inline constexpr std::size_t most_pixels_a_side = 1'000'000;

/// The bytes of a binary PGM file with 256 levels.
[[nodiscard]] std::string encode_pgm(const GreyImage& image);

/// Reads P2 and P5 with comments and up to 65536 levels, scaled to 0..255. Errors: another magic number, sizes that the
/// bytes do not hold, values above the maximum. `name` stands in front of the error message.
[[nodiscard]] Result<GreyImage> decode_pgm(std::string_view bytes, std::string_view name);

}  // namespace flirt
