// flirt/io/ros_map.hpp: grid maps as ROS keeps them, an image and a YAML file beside it, and grey images alone.
#pragma once

#include "flirt/core/result.hpp"
#include "flirt/grid/grey_image.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace flirt {

/// Reads a PGM or PNG file; which one is told from its first bytes.
[[nodiscard]] Result<GreyImage> read_grey_image(const std::filesystem::path& path);

/// Writes a PNG, or a PGM when the name ends in .pgm; at once or not at all.
[[nodiscard]] Result<void> write_grey_image(const std::filesystem::path& path, const GreyImage& image);

/// Reads the YAML text of a ROS grid map: `key: value` lines; image, resolution and origin are required, thresholds,
/// negate and mode have map_server's usual values. Keys of others are ignored. Errors: anything that is not of that
/// shape, keys given twice, a resolution or threshold that makes no sense. `name` stands in front of the message.
[[nodiscard]] Result<GridMapMetadata> parse_grid_map_yaml(std::string_view text, std::string_view name);

[[nodiscard]] std::string grid_map_yaml(const GridMapMetadata& metadata);

struct GridMapImage {
  GreyImage image{};
  GridMapMetadata metadata{};
};

/// Reads the YAML file and the image it names.
[[nodiscard]] Result<GridMapImage> read_grid_map(const std::filesystem::path& yaml_path);

/// Writes the image under the name in its metadata into the folder of the YAML file, then the YAML file.
[[nodiscard]] Result<void> write_grid_map(const std::filesystem::path& yaml_path, const GridMapImage& map);

}  // namespace flirt
