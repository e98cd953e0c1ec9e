// flirt/sim/floor_plan.hpp: what a simulated laser can see: lines, discs and the pixels of a map image.
#pragma once

#include "flirt/core/pose2.hpp"
#include "flirt/grid/grey_image.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace flirt {

enum class Material : std::uint8_t {
  solid,  ///< every beam returns
  glass,  ///< most beams pass, see LidarParams
};

/// A thin straight surface, seen from both sides.
struct PlanSegment {
  Point2 begin{};  ///< m, map frame
  Point2 end{};    ///< m, map frame
  Material material{Material::solid};
};

/// A filled disc: a column, a table leg, a person's leg.
struct PlanDisc {
  Point2 center{};   ///< m, map frame
  double radius{0};  ///< m
};

/// A map image as filled squares. Pixel (column, row) covers [column, column + 1] × [row, row + 1] · resolution in the
/// image's frame: row 0 is the lowest, y points up. Beams end on occupied pixels and pass unknown ones; robots and
/// people keep out of both.
struct PixelPlan {
  Pose2 map_from_image{};
  double resolution{0};  ///< m, side of a pixel
  std::size_t columns{0};
  std::size_t rows{0};
  std::vector<CellState> pixels{};  ///< rows × columns, row by row from the lowest
};

/// A world to drive and measure in. Any mixture of the three kinds is a world.
struct FloorPlan {
  std::vector<PlanSegment> segments{};
  std::vector<PlanDisc> discs{};
  PixelPlan image{};  ///< no pixels: no image
};

/// A floor plan with places worth driving to.
struct World {
  FloorPlan plan{};
  std::vector<Point2> places{};  ///< m, map frame; empty: places are spread over the free space
  std::vector<Point2> tour{};    ///< m; what a drive visits, in this order; empty: places, as DriveParams say
};

/// An axis-parallel rectangle.
struct Rectangle {
  Point2 low{};   ///< m
  Point2 high{};  ///< m

  [[nodiscard]] double width() const { return high.x - low.x; }
  [[nodiscard]] double height() const { return high.y - low.y; }
};

/// A grid map as a plan, by the thresholds of its metadata. O(pixels).
[[nodiscard]] FloorPlan plan_from_image(const GreyImage& image, const GridMapMetadata& metadata);

/// The smallest rectangle around everything in the plan; nothing there: the empty rectangle at the origin. O(plan).
[[nodiscard]] Rectangle bounds(const FloorPlan& plan);

/// The corners of the image in the map frame, counter-clockwise from pixel (0, 0).
[[nodiscard]] std::vector<Point2> image_corners(const PixelPlan& image);

/// Distance from a point to the nearest surface, m; 0 within a disc or an occupied pixel; +inf in an empty plan.
/// By trying everything: O(plan).
[[nodiscard]] double distance_to_surface(const FloorPlan& plan, Point2 point);

}  // namespace flirt
