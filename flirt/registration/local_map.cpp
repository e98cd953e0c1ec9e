#include "flirt/registration/local_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace flirt {
namespace {

constexpr double pass_cell_size = LocalMap::cell_size / 2;
constexpr double units_per_cell = 1024;

/// ⌊v⌋ for |v| < 2³¹, without a library call on processors that have no instruction for it.
std::int32_t floor_to_int(double v) {
  const auto truncated = static_cast<std::int32_t>(v);
  return truncated - (v < truncated ? 1 : 0);
}

CellIndex cell_of(Point2 in_map, double cell_size) {
  return {floor_to_int(in_map.x / cell_size), floor_to_int(in_map.y / cell_size)};
}

/// A pose whose sine and cosine are worked out once for many points.
class Mover {
 public:
  explicit Mover(const Pose2& a_from_b)
      : x_(a_from_b.x), y_(a_from_b.y), cos_(std::cos(a_from_b.theta)), sin_(std::sin(a_from_b.theta)) {}
  [[nodiscard]] Point2 point(double x, double y) const { return {x_ + cos_ * x - sin_ * y, y_ + sin_ * x + cos_ * y}; }
  [[nodiscard]] Point2 direction(double x, double y) const { return {cos_ * x - sin_ * y, sin_ * x + cos_ * y}; }

 private:
  double x_;
  double y_;
  double cos_;
  double sin_;
};

/// Rings of the kernel by squared distance in cells, 4 bits each; the largest holds 8 cells.
constexpr std::array<int, 9> ring_of_squared{0, 1, 2, -1, 3, 4, -1, -1, 5};
constexpr int kernel_radius = 2;
/// exp(−d² / (2 · 0.15²)) · largest, by ring; 0 without any.
constexpr std::array<std::uint8_t, 9> value_of_ring{15, 12, 10, 6, 5, 3, 0, 0, 0};

std::uint8_t value_of(std::uint32_t rings) {
  return value_of_ring[static_cast<std::size_t>(std::countr_zero(rings)) / 4];
}

}  // namespace

LocalMap::LocalMap() : values_(std::size_t{value_period} * (value_period + row_length), 0) {}

void LocalMap::set_value(CellIndex index, std::uint32_t rings) {
  const auto at = static_cast<std::size_t>(row_begin(index));
  values_[at] = value_of(rings);
  const std::uint32_t column = static_cast<std::uint32_t>(index.x) & static_cast<std::uint32_t>(value_period - 1);
  // The first columns stand once more behind the last ones, so that rows can be read over the seam.
  if (column < static_cast<std::uint32_t>(row_length)) { values_[at + value_period] = values_[at]; }
}

template <LocalMap::Change change>
void LocalMap::stamp(CellIndex centre) {
  for (std::int32_t dy = -kernel_radius; dy <= kernel_radius; ++dy) {
    for (std::int32_t dx = -kernel_radius; dx <= kernel_radius; ++dx) {
      const int ring = ring_of_squared[static_cast<std::uint32_t>(dx * dx + dy * dy)];
      const std::uint32_t one = 1U << static_cast<std::uint32_t>(4 * ring);
      const CellIndex index{centre.x + dx, centre.y + dy};
      if constexpr (change == Change::add) { surface_.hold(index); }
      SurfaceCell& cell = surface_.at(index);
      cell.rings = change == Change::add ? cell.rings + one : cell.rings - one;
      cell.has_line = false;
      set_value(index, cell.rings);
      if constexpr (change == Change::remove) { surface_.release(index); }
    }
  }
}

template <LocalMap::Change change>
void LocalMap::count_surface(Point2 in_map, Point2 normal) {
  const CellIndex index = cell_of(in_map, cell_size);
  const auto x = static_cast<std::uint32_t>((in_map.x / cell_size - index.x) * units_per_cell);
  const auto y = static_cast<std::uint32_t>((in_map.y / cell_size - index.y) * units_per_cell);
  const auto normal_xx = static_cast<std::int32_t>((normal.x * normal.x - normal.y * normal.y) * units_per_cell);
  const auto normal_xy = static_cast<std::int32_t>(2 * normal.x * normal.y * units_per_cell);
  const std::int32_t normals = normal == Point2{} ? 0 : 1;
  if (change == Change::add && surface_[index].count == 0) { stamp<Change::add>(index); }
  SurfaceCell& cell = surface_.at(index);
  const auto change_by = [](auto& sum, auto value) { sum = change == Change::add ? sum + value : sum - value; };
  change_by(cell.count, 1U);
  change_by(cell.x, x);
  change_by(cell.y, y);
  change_by(cell.normal_xx, normal_xx);
  change_by(cell.normal_xy, normal_xy);
  change_by(cell.normals, normals);
  forget_lines_around(index);
  if (change == Change::remove && cell.count == 0) { stamp<Change::remove>(index); }
}

/// The cells around one with end points exist: its kernel reaches farther.
void LocalMap::forget_lines_around(CellIndex centre) {
  for (std::int32_t dy = -1; dy <= 1; ++dy) {
    for (std::int32_t dx = -1; dx <= 1; ++dx) { surface_.at({centre.x + dx, centre.y + dy}).has_line = false; }
  }
}

template <LocalMap::Change change>
void LocalMap::count_passes(Point2 from, Point2 to) {
  const auto in_cells = [](Point2 point) { return fixed_point({point.x / pass_cell_size, point.y / pass_cell_size}); };
  const auto visit = [&](CellIndex index, std::uint16_t PassCell::* counter) {
    if constexpr (change == Change::add) {
      passes_.hold(index);
      ++(passes_.at(index).*counter);
    } else {
      --(passes_.at(index).*counter);
      passes_.release(index);
    }
  };
  const FixedPoint2 end = in_cells(to);
  traverse(in_cells(from), end, [&](std::int32_t x, std::int32_t y) { visit({x, y}, &PassCell::passes); });
  visit(end.index(), &PassCell::hits);
}

template <LocalMap::Change change>
void LocalMap::count(const SurfacePoints& points, const Pose2& map_from_robot) {
  const Mover to_map(map_from_robot);
  const Point2 from = map_from_robot * points.origin;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point2 to = to_map.point(points.x[i], points.y[i]);
    count_surface<change>(to, to_map.direction(points.normal_x[i], points.normal_y[i]));
    count_passes<change>(from, to);
  }
}

void LocalMap::add(const SurfacePoints& points, const Pose2& map_from_robot) {
  count<Change::add>(points, map_from_robot);
  ++scans_;
}

void LocalMap::remove(const SurfacePoints& points, const Pose2& map_from_robot) {
  count<Change::remove>(points, map_from_robot);
  --scans_;
}

const LinePiece* LocalMap::line_at(Point2 in_map) const {
  const CellIndex index = cell_of(in_map, cell_size);
  const SurfaceCell& cell = surface_[index];
  if (cell.has_line) { return &cell.line; }
  if (cell.rings == 0) { return nullptr; }
  const auto line = line_around(index);
  if (!line) { return nullptr; }
  cell.line = *line;
  cell.has_line = true;
  return &cell.line;
}

std::optional<LinePiece> LocalMap::line_around(CellIndex centre) const {
  double n = 0;
  double x = 0;
  double y = 0;
  double normal_xx = 0;
  double normal_xy = 0;
  double normals = 0;
  for (std::int32_t dy = -1; dy <= 1; ++dy) {
    for (std::int32_t dx = -1; dx <= 1; ++dx) {
      const SurfaceCell& cell = surface_[{centre.x + dx, centre.y + dy}];
      if (cell.count == 0) { continue; }
      const double count = cell.count;
      n += count;
      x += cell.x / units_per_cell + count * dx;
      y += cell.y / units_per_cell + count * dy;
      normal_xx += cell.normal_xx / units_per_cell;
      normal_xy += cell.normal_xy / units_per_cell;
      normals += cell.normals;
    }
  }
  if (n == 0) { return std::nullopt; }
  LinePiece piece;
  piece.x = static_cast<float>((centre.x + x / n) * cell_size);
  piece.y = static_cast<float>((centre.y + y / n) * cell_size);
  if (2 * normals < n) { return piece; }
  const double direction = 0.5 * std::atan2(normal_xy, normal_xx);
  const double nx = std::cos(direction);
  const double ny = std::sin(direction);
  piece.normal_x = static_cast<float>(nx);
  piece.normal_y = static_cast<float>(ny);
  // Agreement of the normals: 1 on one wall, 0 in a corner.
  const double coherence = std::hypot(normal_xx, normal_xy) / normals;
  piece.roundness = static_cast<float>(coherence > 0.7 ? 0.0 : 1.0 - coherence);
  return piece;
}

int LocalMap::crossing_beams(const SurfacePoints& points, const Pose2& map_from_robot) const {
  constexpr double margin = 0.3;  // m before a beam's end
  const Mover to_map(map_from_robot);
  const Point2 from = map_from_robot * points.origin;
  int crossing = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point2 ray = to_map.point(points.x[i], points.y[i]) - from;
    const double length = norm(ray);
    const auto steps = static_cast<int>((length - margin) / pass_cell_size);
    const double step_x = ray.x / length;
    const double step_y = ray.y / length;
    double x = from.x / pass_cell_size;
    double y = from.y / pass_cell_size;
    for (int step = 0; step < steps; ++step) {
      x += step_x;
      y += step_y;
      if (passes_[{floor_to_int(x), floor_to_int(y)}].solid()) {
        ++crossing;
        break;
      }
    }
  }
  return crossing;
}

bool LocalMap::is_free(Point2 in_map) const {
  return passes_[cell_of(in_map, pass_cell_size)].free();
}

Agreed LocalMap::agreement(std::span<const SurfacePoints> scans, const Pose2& map_from_robot) const {
  constexpr double sigma = 0.1;  // m
  const Mover to_map(map_from_robot);
  Agreed sum;
  std::size_t count = 0;
  for (const SurfacePoints& points : scans) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point2 at = to_map.point(points.x[i], points.y[i]);
      double likelihood = 0;
      if (const LinePiece* line = line_at(at)) {
        const Point2 d{at.x - line->x, at.y - line->y};
        const double across = d.x * line->normal_x + d.y * line->normal_y;
        const double along = -d.x * line->normal_y + d.y * line->normal_x;
        const double squared = across * across + line->roundness * along * along;
        likelihood = std::exp(-squared / (2 * sigma * sigma));
      }
      const PassCell& pass = passes_[cell_of(at, pass_cell_size)];
      sum.likelihood += likelihood;
      sum.free += pass.free() ? 1 - likelihood : 0;
      sum.unknown += likelihood == 0 && pass == PassCell{} ? 1 : 0;
    }
    sum.through += crossing_beams(points, map_from_robot);
    count += points.size();
  }
  const double n = std::max(1.0, static_cast<double>(count));
  return {sum.likelihood / n, sum.free / n, sum.unknown / n, sum.through / n};
}

}  // namespace flirt
