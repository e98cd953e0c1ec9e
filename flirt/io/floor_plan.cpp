#include "flirt/io/floor_plan.hpp"

#include "flirt/io/ros_map.hpp"
#include "flirt/io/segments.hpp"

#include <string>

namespace flirt {

Result<FloorPlan> read_floor_plan(const std::filesystem::path& path, std::optional<double> resolution) {
  const std::string ending = path.extension().string();
  if (ending == ".png" || ending == ".pgm") {
    if (!resolution) { return fail(path.string() + ": expected a resolution for the image, found none"); }
    const Result<GreyImage> image = read_grey_image(path);
    if (!image) { return tl::unexpected(image.error()); }
    return plan_from_image(*image, {.image = path.filename().string(), .resolution = *resolution});
  }
  if (resolution) { return fail(path.string() + ": expected no resolution: only images need one"); }
  if (ending == ".yaml" || ending == ".yml") {
    return read_grid_map(path).map([](const GridMapImage& map) { return plan_from_image(map.image, map.metadata); });
  }
  return read_segments(path);
}

}  // namespace flirt
