#include "flirt/sim/floor_plan.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace flirt {
namespace {

constexpr double everywhere = std::numeric_limits<double>::infinity();

void extend(Rectangle& box, Point2 point) {
  box.low = {std::min(box.low.x, point.x), std::min(box.low.y, point.y)};
  box.high = {std::max(box.high.x, point.x), std::max(box.high.y, point.y)};
}

double distance_to_segment(const PlanSegment& segment, Point2 point) {
  const Point2 along = segment.end - segment.begin;
  const Point2 offset = point - segment.begin;
  const double length_squared = squared_norm(along);
  const double share = length_squared > 0 ? std::clamp(dot(offset, along) / length_squared, 0.0, 1.0) : 0.0;
  return norm(offset - share * along);
}

double distance_to_pixels(const PixelPlan& image, Point2 point) {
  const Point2 in_image = inverse(image.map_from_image) * point;
  double nearest_squared = everywhere;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (image.pixels[i] != CellState::occupied) { continue; }
    const std::size_t column = i % image.columns;
    const std::size_t row = i / image.columns;
    const double x = static_cast<double>(column) * image.resolution;
    const double y = static_cast<double>(row) * image.resolution;
    const Point2 nearest{std::clamp(in_image.x, x, x + image.resolution),
                         std::clamp(in_image.y, y, y + image.resolution)};
    nearest_squared = std::min(nearest_squared, squared_norm(in_image - nearest));
  }
  return std::sqrt(nearest_squared);
}

}  // namespace

FloorPlan plan_from_image(const GreyImage& image, const GridMapMetadata& metadata) {
  PixelPlan pixels{metadata.origin, metadata.resolution, image.width, image.height, {}};
  pixels.pixels.reserve(image.pixels.size());
  for (std::size_t row = image.height; row-- > 0;) {
    for (std::size_t column = 0; column < image.width; ++column) {
      pixels.pixels.push_back(cell_state(image.at(column, row), metadata));
    }
  }
  return {{}, {}, std::move(pixels)};
}

std::vector<Point2> image_corners(const PixelPlan& image) {
  if (image.pixels.empty()) { return {}; }
  const double width = static_cast<double>(image.columns) * image.resolution;
  const double height = static_cast<double>(image.rows) * image.resolution;
  const Pose2& map_from_image = image.map_from_image;
  return {map_from_image * Point2{0, 0}, map_from_image * Point2{width, 0}, map_from_image * Point2{width, height},
          map_from_image * Point2{0, height}};
}

Rectangle bounds(const FloorPlan& plan) {
  Rectangle box{{everywhere, everywhere}, {-everywhere, -everywhere}};
  for (const PlanSegment& segment : plan.segments) {
    extend(box, segment.begin);
    extend(box, segment.end);
  }
  for (const PlanDisc& disc : plan.discs) {
    extend(box, disc.center - Point2{disc.radius, disc.radius});
    extend(box, disc.center + Point2{disc.radius, disc.radius});
  }
  for (const Point2 corner : image_corners(plan.image)) { extend(box, corner); }
  return box.low.x > box.high.x ? Rectangle{} : box;
}

double distance_to_surface(const FloorPlan& plan, Point2 point) {
  double nearest = distance_to_pixels(plan.image, point);
  for (const PlanSegment& segment : plan.segments) { nearest = std::min(nearest, distance_to_segment(segment, point)); }
  for (const PlanDisc& disc : plan.discs) {
    nearest = std::min(nearest, std::max(0.0, norm(point - disc.center) - disc.radius));
  }
  return nearest;
}

}  // namespace flirt
