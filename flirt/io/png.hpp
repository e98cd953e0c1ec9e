// flirt/io/png.hpp: PNG images in memory, by libpng.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/grid/grey_image.hpp"

#include <string>
#include <string_view>

namespace flirt {

/// The bytes of an 8-bit grey PNG file. width · height must be the number of pixels, both above zero.
[[nodiscard]] std::string encode_png(const GreyImage& image);

/// Reads grey, RGB, palette, 1- to 16-bit and interlaced PNG bytes. Colours become the mean of red, green and blue, as
/// in map_server, without gamma; transparency blends towards 205, the grey that map_server writes for unknown cells.
/// Errors: not a PNG, broken or cut short, more than 2^28 pixels. `name` stands in front of the error message.
[[nodiscard]] Result<GreyImage> decode_png(std::string_view bytes, std::string_view name);

}  // namespace flirt
