#include "flirt/sim/free_space.hpp"

#include "flirt/core/rng.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

namespace flirt {
namespace {

constexpr float unreachable = std::numeric_limits<float>::infinity();
constexpr double half_diagonal = 0.70710678118654757;  // of a cell, in cells

double cell_size_for(double area) {
  constexpr double max_cells = 12e6;
  return std::max(area < 10000 ? 0.05 : 0.1, std::sqrt(area / max_cells));
}

/// Squared distances in one dimension: the lower envelope of parabolas (Felzenszwalb and Huttenlocher 2012).
class LowerEnvelope {
 public:
  explicit LowerEnvelope(std::size_t length) : values_(length), apex_(length), start_(length + 1) {}

  /// line(i) refers to the i-th of `length` values, which are replaced.
  template <class Line>
  void transform(std::size_t length, const Line& line) {
    std::size_t parabolas = 0;
    for (std::size_t i = 0; i < length; ++i) {
      values_[i] = line(i);
      if (values_[i] == unreachable) { continue; }
      double from = -std::numeric_limits<double>::infinity();
      while (parabolas > 0) {
        from = crossing(apex_[parabolas - 1], i);
        if (from > start_[parabolas - 1]) { break; }
        from = -std::numeric_limits<double>::infinity();
        --parabolas;
      }
      apex_[parabolas] = i;
      start_[parabolas++] = from;
    }
    if (parabolas == 0) { return; }
    std::size_t k = 0;
    for (std::size_t i = 0; i < length; ++i) {
      while (k + 1 < parabolas && start_[k + 1] < static_cast<double>(i)) { ++k; }
      const double offset = static_cast<double>(i) - static_cast<double>(apex_[k]);
      line(i) = static_cast<float>(offset * offset + values_[apex_[k]]);
    }
  }

 private:
  /// Where the parabola at the later apex becomes the lower one.
  [[nodiscard]] double crossing(std::size_t earlier, std::size_t later) const {
    const auto a = static_cast<double>(earlier);
    const auto b = static_cast<double>(later);
    return ((values_[later] + b * b) - (values_[earlier] + a * a)) / (2 * (b - a));
  }
  std::vector<double> values_;
  std::vector<std::size_t> apex_;
  std::vector<double> start_;
};

/// Calls mark(point) so densely that each cell that the plan's surfaces enter by more than `step` is met.
template <class Mark>
void sample_surfaces(const FloorPlan& plan, double step, const Mark& mark) {
  for (const PlanSegment& segment : plan.segments) {
    const Point2 along = segment.end - segment.begin;
    const double steps = std::ceil(norm(along) / step);
    for (double i = 0; i <= steps; ++i) { mark(segment.begin + (steps > 0 ? i / steps : 0.0) * along); }
  }
  for (const PlanDisc& disc : plan.discs) {
    for (double y = -disc.radius; y <= disc.radius; y += step) {
      const double half_chord = std::sqrt(std::max(0.0, disc.radius * disc.radius - y * y));
      for (double x = -half_chord; x < half_chord; x += step) { mark(disc.center + Point2{x, y}); }
      mark(disc.center + Point2{half_chord, y});
    }
    for (double angle = 0; angle < 6.3; angle += step / std::max(disc.radius, step)) {
      mark(disc.center + Point2{disc.radius * std::cos(angle), disc.radius * std::sin(angle)});
    }
  }
}

/// The same for pixels that are not free.
template <class Mark>
void sample_pixels(const PixelPlan& image, double step, const Mark& mark) {
  const int samples = 1 + static_cast<int>(std::ceil(image.resolution / step));
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (image.pixels[i] == CellState::free) { continue; }
    const std::size_t column = i % image.columns;
    const std::size_t row = i / image.columns;
    for (int k = 0; k < samples * samples; ++k) {
      const int sample_column = k % samples;
      const int sample_row = k / samples;
      const double x = static_cast<double>(column) + static_cast<double>(sample_column) / (samples - 1);
      const double y = static_cast<double>(row) + static_cast<double>(sample_row) / (samples - 1);
      mark(image.map_from_image * Point2{x * image.resolution, y * image.resolution});
    }
  }
}

}  // namespace

FreeSpace::FreeSpace(const FloorPlan& plan, double radius) : radius_(radius), caster_(plan) {
  const Rectangle box = bounds(plan);
  cell_size_ = cell_size_for(box.width() * box.height());
  if (box.width() == 0 && box.height() == 0) { return; }  // nothing there, hence no inside
  origin_ = box.low;
  needed_clearance_ = std::hypot(radius, half_diagonal * cell_size_);
  columns_ = static_cast<std::int32_t>(box.width() / cell_size_) + 1;
  rows_ = static_cast<std::int32_t>(box.height() / cell_size_) + 1;
  distance_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), unreachable);
  measure_distances(plan);
  inside_.resize(distance_.size());
  for (std::size_t cell = 0; cell < distance_.size(); ++cell) {
    inside_[cell] = clearance(center_of(cell)) >= needed_clearance_ ? 1 : 0;
  }
  keep_one_space();
}

std::int64_t FreeSpace::cell_of(Point2 point) const {
  const auto column = static_cast<std::int64_t>(std::floor((point.x - origin_.x) / cell_size_));
  const auto row = static_cast<std::int64_t>(std::floor((point.y - origin_.y) / cell_size_));
  return column < 0 || column >= columns_ || row < 0 || row >= rows_ ? -1 : row * columns_ + column;
}

Point2 FreeSpace::center_of(std::size_t cell) const {
  const auto columns = static_cast<std::size_t>(columns_);
  const std::size_t column = cell % columns;
  const std::size_t row = cell / columns;
  return origin_ + cell_size_ * Point2{static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5};
}

void FreeSpace::measure_distances(const FloorPlan& plan) {
  const auto mark = [&](Point2 point) {
    const std::int64_t cell = cell_of(point);
    if (cell >= 0) { distance_[static_cast<std::size_t>(cell)] = 0; }
  };
  sample_surfaces(plan, cell_size_ / 4, mark);
  sample_pixels(plan.image, cell_size_ / 2, mark);
  const auto columns = static_cast<std::size_t>(columns_);
  const auto rows = static_cast<std::size_t>(rows_);
  LowerEnvelope envelope(std::max(columns, rows));
  for (std::size_t x = 0; x < columns; ++x) {
    envelope.transform(rows, [&](std::size_t y) -> float& { return distance_[y * columns + x]; });
  }
  for (std::size_t y = 0; y < rows; ++y) {
    envelope.transform(columns, [&](std::size_t x) -> float& { return distance_[y * columns + x]; });
  }
  for (float& distance : distance_) { distance = std::sqrt(distance) * static_cast<float>(cell_size_); }
}

double FreeSpace::clearance(Point2 point) const {
  const std::int64_t found = cell_of(point);
  if (found < 0) { return 0; }
  const auto cell = static_cast<std::size_t>(found);
  const double to_center = norm(point - center_of(cell));
  return std::max(0.0, distance_[cell] - to_center - half_diagonal * cell_size_);
}

bool FreeSpace::contains(Point2 point) const {
  const std::int64_t cell = cell_of(point);
  return cell >= 0 && inside_[static_cast<std::size_t>(cell)] != 0 && clearance(point) >= needed_clearance_;
}

bool FreeSpace::contains(Point2 a, Point2 b) const {
  const double steps = std::max(1.0, std::ceil(norm(b - a) / cell_size_));
  for (double i = 0; i <= steps; ++i) {
    if (!contains(a + (i / steps) * (b - a))) { return false; }
  }
  return true;
}

double FreeSpace::area() const {
  return cell_size_ * cell_size_ * static_cast<double>(std::count(inside_.begin(), inside_.end(), 1));
}

bool FreeSpace::is_enclosed(Point2 point) const {
  constexpr int directions = 16;
  constexpr double sight = 20.0;  // m
  int seen = 0;
  for (int i = 0; i < directions; ++i) {
    seen += caster_.cast(point, (i + 0.5) * 2 * std::numbers::pi / directions, sight) < sight ? 1 : 0;
  }
  return 4 * seen >= 3 * directions;
}

std::vector<std::size_t> FreeSpace::connected_cells(std::size_t first, std::vector<std::uint8_t>& seen) const {
  std::vector<std::size_t> cells{first};
  seen[first] = 1;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const auto x = static_cast<std::int32_t>(cells[k] % static_cast<std::size_t>(columns_));
    const auto y = static_cast<std::int32_t>(cells[k] / static_cast<std::size_t>(columns_));
    for (const CellStep& step : cell_steps) {
      if (x + step.right < 0 || x + step.right >= columns_ || y + step.up < 0 || y + step.up >= rows_) { continue; }
      const std::size_t next = static_cast<std::size_t>(y + step.up) * static_cast<std::size_t>(columns_) +
                               static_cast<std::size_t>(x + step.right);
      if (inside_[next] == 0 || seen[next] != 0) { continue; }
      seen[next] = 1;
      cells.push_back(next);
    }
  }
  return cells;
}

/// How many cells of a coarse raster are enclosed.
std::size_t FreeSpace::enclosed_cells(const std::vector<std::size_t>& cells) const {
  const auto raster = std::max<std::size_t>(1, static_cast<std::size_t>(0.5 / cell_size_));
  const auto columns = static_cast<std::size_t>(columns_);
  return static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), [&](std::size_t cell) {
    return cell % columns % raster == 0 && cell / columns % raster == 0 && is_enclosed(center_of(cell));
  }));
}

/// Of all connected spaces keeps that with the most enclosed cells; among equals the largest.
void FreeSpace::keep_one_space() {
  std::pair<std::size_t, std::size_t> most{0, 0};
  std::vector<std::size_t> best;
  std::vector<std::uint8_t> seen(inside_.size(), 0);
  for (std::size_t first = 0; first < inside_.size(); ++first) {
    if (inside_[first] == 0 || seen[first] != 0) { continue; }
    std::vector<std::size_t> cells = connected_cells(first, seen);
    const std::pair<std::size_t, std::size_t> score{enclosed_cells(cells), cells.size()};
    if (score <= most) { continue; }
    most = score;
    best = std::move(cells);
  }
  std::fill(inside_.begin(), inside_.end(), std::uint8_t{0});
  for (const std::size_t cell : best) { inside_[cell] = 1; }
}

std::vector<Point2> FreeSpace::nearest(Point2 point, double reach) const {
  if (contains(point)) { return {point}; }
  std::vector<Point2> found;
  double nearest = reach;
  for (double y = point.y - reach; y <= point.y + reach; y += cell_size_) {
    for (double x = point.x - reach; x <= point.x + reach; x += cell_size_) {
      const std::int64_t cell = cell_of({x, y});
      if (cell < 0 || inside_[static_cast<std::size_t>(cell)] == 0) { continue; }
      const Point2 center = center_of(static_cast<std::size_t>(cell));
      if (norm(center - point) > nearest) { continue; }
      nearest = norm(center - point);
      found = {center};
    }
  }
  return found;
}

std::vector<Point2> FreeSpace::spread(double spacing, std::uint64_t seed) const {
  std::vector<std::size_t> cells;
  for (std::size_t cell = 0; cell < inside_.size(); ++cell) {
    if (inside_[cell] != 0) { cells.push_back(cell); }
  }
  Rng rng(seed);
  for (std::size_t i = cells.size(); i > 1; --i) {
    std::swap(cells[i - 1], cells[rng.below(static_cast<std::uint32_t>(i))]);
  }
  // Buckets as wide as the spacing: a point that is too near lies in one of nine.
  const auto bucket_columns = static_cast<std::size_t>(columns_ * cell_size_ / spacing) + 3;
  std::vector<std::vector<Point2>> buckets(bucket_columns *
                                           (static_cast<std::size_t>(rows_ * cell_size_ / spacing) + 3));
  std::vector<Point2> points;
  for (const std::size_t cell : cells) {
    const Point2 point = center_of(cell);
    const std::size_t bucket = (1 + static_cast<std::size_t>((point.y - origin_.y) / spacing)) * bucket_columns + 1 +
                               static_cast<std::size_t>((point.x - origin_.x) / spacing);
    bool is_far = true;
    for (const std::size_t row : {bucket - bucket_columns, bucket, bucket + bucket_columns}) {
      for (const std::size_t near : {row - 1, row, row + 1}) {
        for (const Point2 other : buckets[near]) { is_far = is_far && norm(other - point) >= spacing; }
      }
    }
    if (!is_far) { continue; }
    buckets[bucket].push_back(point);
    points.push_back(point);
  }
  std::vector<Point2> enclosed;
  std::copy_if(points.begin(), points.end(), std::back_inserter(enclosed),
               [&](Point2 point) { return is_enclosed(point); });
  return 5 * enclosed.size() < points.size() ? points : enclosed;
}

}  // namespace flirt
