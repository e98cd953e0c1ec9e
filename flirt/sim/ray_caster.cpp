#include "flirt/sim/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flirt {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double slack = 1e-9;           // m, by which the ends of segments are extended so that corners do not leak
constexpr double parallel_sine = 1e-12;  // a ray at a smaller angle to a segment runs along it
constexpr double cell_margin = 1e-6;     // m, by which surfaces reach into the cells beside them

std::int32_t cell_of(double position, double low, double cell_size, std::int32_t cells) {
  return std::clamp(static_cast<std::int32_t>(std::floor((position - low) / cell_size)), 0, cells - 1);
}

/// An empty grid over the box, about one cell for each surface, so that both walking and testing stay short.
CellGrid grid_over(const Rectangle& box, std::size_t surfaces) {
  constexpr double max_cells = 4e6;
  const double area = std::max(box.width(), 1e-3) * std::max(box.height(), 1e-3);
  const double cells = std::clamp(2.0 * static_cast<double>(surfaces), 1.0, max_cells);
  const double longest = std::max({box.width(), box.height(), 1e-3});
  CellGrid grid;
  grid.cell_size = std::max(std::sqrt(area / cells), longest / 4000.0);
  grid.origin = box.low - Point2{2 * cell_margin, 2 * cell_margin};
  grid.columns = static_cast<std::int32_t>((box.width() + 4 * cell_margin) / grid.cell_size) + 1;
  grid.rows = static_cast<std::int32_t>((box.height() + 4 * cell_margin) / grid.cell_size) + 1;
  grid.steps_to_content.assign(grid.index(0, grid.rows), 255);
  return grid;
}

/// Calls place(cell) for each cell that the segment touches, row by row.
template <class Place>
void rasterize(const CellGrid& grid, Point2 begin, Point2 along, const Place& place) {
  const Point2 end = begin + along;
  const double low_y = std::min(begin.y, end.y) - cell_margin;
  const double high_y = std::max(begin.y, end.y) + cell_margin;
  const std::int32_t last_row = cell_of(high_y, grid.origin.y, grid.cell_size, grid.rows);
  for (std::int32_t row = cell_of(low_y, grid.origin.y, grid.cell_size, grid.rows); row <= last_row; ++row) {
    const double floor_y = grid.origin.y + row * grid.cell_size - cell_margin;
    const double ceiling_y = floor_y + grid.cell_size + 2 * cell_margin;
    double first = 0;
    double last = 1;
    if (along.y != 0) {
      const double a = (floor_y - begin.y) / along.y;
      const double b = (ceiling_y - begin.y) / along.y;
      first = std::clamp(std::min(a, b), 0.0, 1.0);
      last = std::clamp(std::max(a, b), 0.0, 1.0);
    }
    const double x1 = begin.x + first * along.x;
    const double x2 = begin.x + last * along.x;
    const std::int32_t last_column =
        cell_of(std::max(x1, x2) + cell_margin, grid.origin.x, grid.cell_size, grid.columns);
    for (std::int32_t column = cell_of(std::min(x1, x2) - cell_margin, grid.origin.x, grid.cell_size, grid.columns);
         column <= last_column; ++column) {
      place(grid.index(column, row));
    }
  }
}

template <class Place>
void rasterize(const CellGrid& grid, const PlanDisc& disc, const Place& place) {
  const double reach = disc.radius + cell_margin;
  const std::int32_t last_row = cell_of(disc.center.y + reach, grid.origin.y, grid.cell_size, grid.rows);
  const std::int32_t last_column = cell_of(disc.center.x + reach, grid.origin.x, grid.cell_size, grid.columns);
  const std::int32_t first_column = cell_of(disc.center.x - reach, grid.origin.x, grid.cell_size, grid.columns);
  for (std::int32_t row = cell_of(disc.center.y - reach, grid.origin.y, grid.cell_size, grid.rows); row <= last_row;
       ++row) {
    for (std::int32_t column = first_column; column <= last_column; ++column) { place(grid.index(column, row)); }
  }
}

/// Range along the ray to a segment, at least `from`; +inf when they do not meet.
double range_to_segment(Point2 begin, Point2 along, double tolerance, Point2 origin, Point2 direction, double from) {
  const Point2 offset = begin - origin;
  const double denominator = cross(direction, along);
  const double aside = cross(offset, direction);
  if (std::abs(denominator) * tolerance > parallel_sine * slack) {
    const double share = aside / denominator;
    if (share < -tolerance || share > 1 + tolerance) { return infinity; }
    const double range = cross(offset, along) / denominator;
    return range >= from - slack ? std::max(range, from) : infinity;
  }
  if (std::abs(aside) > slack) { return infinity; }  // parallel
  const double a = dot(offset, direction);
  const double b = a + dot(along, direction);
  if (std::max(a, b) < from - slack) { return infinity; }
  return std::max(std::min(a, b), from);
}

/// Range along the ray to a filled disc, at least `from`; +inf when they do not meet.
double range_to_disc(const PlanDisc& disc, Point2 origin, Point2 direction, double from) {
  const Point2 offset = disc.center - origin;
  const double aside = cross(direction, offset);
  const double half_chord_squared = disc.radius * disc.radius - aside * aside;
  if (half_chord_squared < 0) { return infinity; }
  const double middle = dot(offset, direction);
  const double half_chord = std::sqrt(half_chord_squared);
  return middle + half_chord >= from ? std::max(middle - half_chord, from) : infinity;
}

}  // namespace

RayCaster::RayCaster(const FloorPlan& plan) : discs_(plan.discs) {
  surfaces_.reserve(plan.segments.size());
  for (const PlanSegment& segment : plan.segments) {
    const Point2 along = segment.end - segment.begin;
    surfaces_.push_back({segment.begin, along, slack / std::max(norm(along), slack), segment.material});
  }
  if (!surfaces_.empty() || !discs_.empty()) {
    cells_ = grid_over(bounds({plan.segments, plan.discs, {}}), surfaces_.size() + discs_.size());
    place_surfaces();
  }
  if (!plan.image.pixels.empty()) { place_pixels(plan.image); }
}

/// Sorts surfaces and discs into cells: counts, then offsets, then entries.
void RayCaster::place_surfaces() {
  const auto for_each_entry = [&](const auto& entry) {
    for (std::uint32_t i = 0; i < surfaces_.size(); ++i) {
      rasterize(cells_, surfaces_[i].begin, surfaces_[i].along, [&](std::size_t cell) { entry(cell, i); });
    }
    for (std::uint32_t i = 0; i < discs_.size(); ++i) {
      const std::uint32_t item = static_cast<std::uint32_t>(surfaces_.size()) + i;
      rasterize(cells_, discs_[i], [&](std::size_t cell) { entry(cell, item); });
    }
  };
  first_of_cell_.assign(cells_.steps_to_content.size() + 1, 0);
  for_each_entry([&](std::size_t cell, std::uint32_t) {
    ++first_of_cell_[cell + 1];
    cells_.steps_to_content[cell] = 0;
  });
  for (std::size_t cell = 1; cell < first_of_cell_.size(); ++cell) { first_of_cell_[cell] += first_of_cell_[cell - 1]; }
  items_.resize(first_of_cell_.back());
  std::vector<std::uint32_t> next = first_of_cell_;
  for_each_entry([&](std::size_t cell, std::uint32_t item) { items_[next[cell]++] = item; });
  measure_steps(cells_);
}

void RayCaster::place_pixels(const PixelPlan& image) {
  pixels_.cell_size = image.resolution;
  pixels_.columns = static_cast<std::int32_t>(image.columns);
  pixels_.rows = static_cast<std::int32_t>(image.rows);
  pixels_.steps_to_content.resize(image.pixels.size());
  std::transform(image.pixels.begin(), image.pixels.end(), pixels_.steps_to_content.begin(),
                 [](CellState state) { return static_cast<std::uint8_t>(state == CellState::occupied ? 0 : 255); });
  measure_steps(pixels_);
  image_from_map_ = inverse(image.map_from_image);
}

RayHit RayCaster::nearest_surface(Point2 origin, Point2 direction, double from, double to) const {
  double nearest = infinity;
  std::uint32_t nearest_item = 0;
  walk(cells_, origin, direction, from, to, [&](const CellVisit& visit) {
    for (std::uint32_t k = first_of_cell_[visit.cell]; k < first_of_cell_[visit.cell + 1]; ++k) {
      const std::uint32_t item = items_[k];
      const double range = item < surfaces_.size()
                               ? range_to_segment(surfaces_[item].begin, surfaces_[item].along,
                                                  surfaces_[item].tolerance, origin, direction, from)
                               : range_to_disc(discs_[item - surfaces_.size()], origin, direction, from);
      if (range < nearest) {
        nearest = range;
        nearest_item = item;
      }
    }
    return nearest <= visit.leave;  // what lies in later cells is further away
  });
  if (!(nearest <= to)) { return {infinity}; }
  if (nearest_item >= surfaces_.size()) {
    const PlanDisc& disc = discs_[nearest_item - surfaces_.size()];
    const double aside = cross(direction, disc.center - origin) / std::max(disc.radius, slack);
    return {nearest, Material::solid, std::sqrt(std::max(0.0, 1 - aside * aside))};
  }
  const Surface& surface = surfaces_[nearest_item];
  const double length = std::max(norm(surface.along), slack);
  return {nearest, surface.material, std::min(1.0, std::abs(cross(direction, surface.along)) / length)};
}

RayHit RayCaster::nearest_pixel(Point2 origin, Point2 direction, double from, double to) const {
  RayHit hit{infinity};
  const Point2 start = image_from_map_ * origin;
  const double c = std::cos(image_from_map_.theta);
  const double s = std::sin(image_from_map_.theta);
  const Point2 turned{c * direction.x - s * direction.y, s * direction.x + c * direction.y};
  walk(pixels_, start, turned, from, to, [&](const CellVisit& visit) {
    const double cosine = visit.crossed == GridAxis::y ? std::abs(turned.y) : std::abs(turned.x);
    hit = {visit.enter, Material::solid, visit.crossed == GridAxis::none ? 1.0 : cosine};
    return true;
  });
  return hit;
}

std::optional<RayHit> RayCaster::first_hit(Point2 origin, Point2 direction, double from, double to) const {
  RayHit hit{infinity};
  if (cells_.columns > 0) { hit = nearest_surface(origin, direction, from, to); }
  if (pixels_.columns > 0) {
    const RayHit pixel = nearest_pixel(origin, direction, from, to);
    if (pixel.range < hit.range) { hit = pixel; }
  }
  return hit.range <= to ? std::optional(hit) : std::nullopt;
}

double RayCaster::cast(Point2 origin, double angle, double max_range) const {
  const std::optional<RayHit> hit = first_hit(origin, {std::cos(angle), std::sin(angle)}, 0, max_range);
  return hit ? hit->range : max_range;
}

std::vector<double> RayCaster::cast(const Pose2& map_from_sensor, const Beams& beams, std::size_t count) const {
  std::vector<double> ranges(count);
  for (std::size_t i = 0; i < count; ++i) {
    ranges[i] = cast(map_from_sensor.translation(), map_from_sensor.theta + beams.angle(i), beams.range_max);
  }
  return ranges;
}

}  // namespace flirt
