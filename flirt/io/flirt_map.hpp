// flirt/io/flirt_map.hpp: place maps as files that open in place.
//
// Little-endian. Header (32 bytes): magic "FLIRTMAP", byte order mark, version, size of the file, number of sections,
// CRC-32 of the whole file with this field as 0. Then one table entry per section (name, offset, bytes, size of an
// element, flags), then the sections, each at a multiple of 64 bytes: one per column of the map, the shape of the
// descriptors, and the feature parameters as JSON. A reader skips sections it does not know when they are marked as
// optional, and refuses the file when they are not. docs/formats.md has the layout byte by byte.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/map/place_map.hpp"

#include <filesystem>

namespace flirt {

/// Writes the map to a file that appears at `path` only when it is complete. Equal maps give equal bytes.
[[nodiscard]] Result<void> write_place_map(const std::filesystem::path& path, const PlaceMap& map);

/// Maps the file into memory and checks it as a whole (checksum, then that the columns fit together), at about a
/// gigabyte a second; the columns of the result lie in the file, which may be replaced (write_place_map does so) but
/// must not be cut while the map is in use. Any cut or changed byte is an error.
[[nodiscard]] Result<PlaceMap> read_place_map(const std::filesystem::path& path);

}  // namespace flirt
