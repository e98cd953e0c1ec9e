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
void rasterize(const CellGrid& grid, const PlanSegment& segment, const Place& place) {
  const Point2 begin = segment.begin;
  const Point2 end = segment.end;
  const Point2 along = end - begin;
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

/// Range along the ray, at least `from`; +inf (or not a number) when they do not meet.
inline double RayCaster::Surface::range(Point2 origin, Point2 direction, double from) const {
  const double closing = dot(normal, direction);
  if (std::abs(closing) <= parallel_sine) { return range_along(origin, direction, from); }
  const double range = (offset - dot(normal, origin)) / closing;
  const double at = dot(along, origin) + range * dot(along, direction);
  const bool meets = (at >= first) & (at <= last) & (range >= from - slack);  // one branch instead of three
  return meets ? std::max(range, from) : infinity;
}

RayCaster::Surface RayCaster::Surface::of(const PlanSegment& segment) {
  const Point2 way = segment.end - segment.begin;
  const double length = norm(way);
  const Point2 along = length > 0 ? (1 / length) * way : Point2{1, 0};
  const Point2 normal{-along.y, along.x};
  const double first = dot(along, segment.begin) - slack;
  return {normal, dot(normal, segment.begin), along, first, first + length + 2 * slack, segment.material};
}

/// The same for a ray that runs along the line: the range to the nearer end.
double RayCaster::Surface::range_along(Point2 origin, Point2 direction, double from) const {
  if (std::abs(offset - dot(normal, origin)) > slack) { return infinity; }
  const double at = dot(along, origin);
  const double sign = dot(along, direction) > 0 ? 1 : -1;
  const double a = sign * (first + slack - at);
  const double b = sign * (last - slack - at);
  return std::max(a, b) < from - slack ? infinity : std::max(std::min(a, b), from);
}

RayCaster::RayCaster(const FloorPlan& plan) {
  if (!plan.segments.empty() || !plan.discs.empty()) { place_surfaces(plan); }
  if (!plan.image.pixels.empty()) { place_pixels(plan.image); }
}

/// Sorts surfaces and discs into cells: counts, then offsets, then entries.
void RayCaster::place_surfaces(const FloorPlan& plan) {
  grid_ = grid_over(bounds({plan.segments, plan.discs, {}}), plan.segments.size() + plan.discs.size());
  cells_.resize(grid_.steps_to_content.size() + 1);
  for (const PlanSegment& segment : plan.segments) {
    rasterize(grid_, segment, [&](std::size_t cell) { ++cells_[cell].first_surface; });
  }
  for (const PlanDisc& disc : plan.discs) {
    rasterize(grid_, disc, [&](std::size_t cell) { ++cells_[cell].first_disc; });
  }
  Cell end;
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
    const bool has_content = cells_[cell].first_surface + cells_[cell].first_disc > 0;
    if (has_content) { grid_.steps_to_content[cell] = 0; }
    end = {end.first_surface + cells_[cell].first_surface, end.first_disc + cells_[cell].first_disc};
    cells_[cell] = end;
  }
  // Each entry moves its cell's offset from the end to the beginning.
  surfaces_.resize(end.first_surface);
  discs_.resize(end.first_disc);
  for (const PlanSegment& segment : plan.segments) {
    const Surface surface = Surface::of(segment);
    rasterize(grid_, segment, [&](std::size_t cell) { surfaces_[--cells_[cell].first_surface] = surface; });
  }
  for (const PlanDisc& disc : plan.discs) {
    rasterize(grid_, disc, [&](std::size_t cell) { discs_[--cells_[cell].first_disc] = disc; });
  }
  measure_steps(grid_);
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
  const Surface* surface = nullptr;
  const PlanDisc* disc = nullptr;
  walk(grid_, origin, direction, from, to, [&](const CellVisit& visit) {
    const Cell& cell = cells_[visit.cell];
    const Cell& next = cells_[visit.cell + 1];
    for (std::uint32_t k = cell.first_surface; k < next.first_surface; ++k) {
      const double range = surfaces_[k].range(origin, direction, from);
      if (range < nearest) {
        nearest = range;
        surface = &surfaces_[k];
        disc = nullptr;
      }
    }
    for (std::uint32_t k = cell.first_disc; k < next.first_disc; ++k) {
      const double range = range_to_disc(discs_[k], origin, direction, from);
      if (range < nearest) {
        nearest = range;
        disc = &discs_[k];
      }
    }
    return nearest <= visit.leave;  // what lies in later cells is further away
  });
  if (!(nearest <= to)) { return {infinity}; }
  if (disc != nullptr) {
    const double aside = cross(direction, disc->center - origin) / std::max(disc->radius, slack);
    return {nearest, Material::solid, std::sqrt(std::max(0.0, 1 - aside * aside))};
  }
  return {nearest, surface->material, std::min(1.0, std::abs(dot(surface->normal, direction)))};
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
  if (grid_.columns > 0) { hit = nearest_surface(origin, direction, from, to); }
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
