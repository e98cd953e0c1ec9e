#include "flirt/eval/map_quality.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/core/parallel.hpp"
#include "flirt/core/rng.hpp"
#include "flirt/features/normal.hpp"
#include "flirt/grid/evidence_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace flirt {
namespace {

constexpr int line_window = 5;      // points that a line is laid through
constexpr double line_reach = 0.5;  // m, the outer points of the window are not further from its middle

/// A point with the line through it and its neighbours, sensor frame.
struct LinePoint {
  double angle{0};  ///< rad, of its beam
  Point2 point{};
  Point2 normal{};
  bool has_line{false};  ///< its neighbours are on the same wall
};

/// In order of their angles.
std::vector<LinePoint> line_points(const Scan& scan) {
  const std::vector<BeamPoint> hits = hit_points(scan);
  std::vector<double> x;
  std::vector<double> y;
  for (const BeamPoint& hit : hits) {
    x.push_back(hit.point.x);
    y.push_back(hit.point.y);
  }
  std::vector<double> normals;
  if (hits.size() >= line_window) { estimate_normals(x, y, line_window, false, normals); }
  constexpr std::size_t half = line_window / 2;
  std::vector<LinePoint> points(hits.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    points[i].point = hits[i].point;
    points[i].angle = std::atan2(hits[i].point.y, hits[i].point.x);
    if (i < half || i + half >= hits.size()) { continue; }
    points[i].normal = {std::cos(normals[i]), std::sin(normals[i])};
    points[i].has_line = norm(hits[i - half].point - hits[i].point) <= line_reach &&
                         norm(hits[i + half].point - hits[i].point) <= line_reach;
  }
  std::sort(points.begin(), points.end(), [](const LinePoint& a, const LinePoint& b) { return a.angle < b.angle; });
  return points;
}

/// The nearest point within max_distance; all such lie in a narrow fan of beams. Nothing near −π looks across to +π:
/// a few points behind the sensor of a full turn lose a partner.
const LinePoint* nearest(const std::vector<LinePoint>& points, Point2 at, double max_distance) {
  const double range = norm(at);
  const double half_fan = range > max_distance ? std::asin(max_distance / range) : std::numbers::pi;
  const double angle = std::atan2(at.y, at.x);
  auto point = std::lower_bound(points.begin(), points.end(), angle - half_fan,
                                [](const LinePoint& p, double value) { return p.angle < value; });
  const LinePoint* best = nullptr;
  double least = max_distance * max_distance;
  for (; point != points.end() && point->angle <= angle + half_fan; ++point) {
    const double squared = squared_norm(point->point - at);
    if (squared > least) { continue; }
    least = squared;
    best = &*point;
  }
  return best;
}

struct Residuals {
  double squares{0};  ///< m²
  std::size_t points{0};
  std::size_t pairs{0};
};

/// Of a scan's points from the lines of another.
Residuals compare(const std::vector<LinePoint>& query, const std::vector<LinePoint>& other,
                  const Pose2& other_from_query, const MapQualityParams& params) {
  Residuals sum{.pairs = 1};
  std::size_t near = 0;
  for (const LinePoint& point : query) {
    const Point2 at = other_from_query * point.point;
    const LinePoint* const partner = nearest(other, at, params.max_distance);
    if (partner == nullptr) { continue; }
    ++near;
    if (!partner->has_line) { continue; }
    const double residual = dot(partner->normal, at - partner->point);
    sum.squares += residual * residual;
    ++sum.points;
  }
  const bool overlaps = near > 0 && static_cast<double>(near) >= params.min_overlap * static_cast<double>(query.size());
  return overlaps ? sum : Residuals{};
}

std::vector<std::size_t> draw_partners(std::size_t scan, std::span<const Pose2> map_from_sensor,
                                       const MapQualityParams& params) {
  std::vector<std::size_t> near;
  for (std::size_t j = 0; j < map_from_sensor.size(); ++j) {
    if (j != scan && distance(map_from_sensor[scan], map_from_sensor[j]) <= params.reach) { near.push_back(j); }
  }
  Rng rng(params.seed, scan);
  const std::size_t kept = std::min<std::size_t>(near.size(), params.partners);
  for (std::size_t k = 0; k < kept; ++k) {
    std::swap(near[k], near[k + rng.below(static_cast<std::uint32_t>(near.size() - k))]);
  }
  near.resize(kept);
  return near;
}

std::size_t count_occupied(const EvidenceGrid& grid) {
  std::size_t n = 0;
  grid.for_each_row([&n](CellIndex /*first*/, std::span<const EvidenceCell> row) {
    n += static_cast<std::size_t>(
        std::count_if(row.begin(), row.end(), [](const EvidenceCell& cell) { return cell.occupied(); }));
  });
  return n;
}

}  // namespace

MapQuality map_quality(const ScanLog& log, std::span<const Pose2> map_from_robot, const MapQualityParams& params,
                       std::size_t threads) {
  FLIRT_ASSERT(map_from_robot.size() == log.scans.size());
  std::vector<Pose2> map_from_sensor;
  std::vector<std::vector<LinePoint>> points;
  EvidenceGrid grid({.cell_size = params.cell_size});
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    map_from_sensor.push_back(map_from_robot[i] * log.scans[i].robot_from_sensor);
    points.push_back(line_points(log.scans[i]));
    grid.add(log.scans[i], map_from_sensor.back());
  }
  std::vector<Residuals> of_scan(log.scans.size());
  parallel_for(log.scans.size(), thread_count(threads), [&](std::size_t i, std::size_t /*thread*/) {
    for (const std::size_t j : draw_partners(i, map_from_sensor, params)) {
      const Residuals pair = compare(points[i], points[j], inverse(map_from_sensor[j]) * map_from_sensor[i], params);
      of_scan[i].squares += pair.squares;
      of_scan[i].points += pair.points;
      of_scan[i].pairs += pair.pairs;
    }
  });
  MapQuality quality{.occupied_cells = count_occupied(grid)};
  double squares = 0;
  for (const Residuals& sum : of_scan) {
    squares += sum.squares;
    quality.points += sum.points;
    quality.pairs += sum.pairs;
  }
  if (quality.points > 0) { quality.point_to_line_rms = std::sqrt(squares / static_cast<double>(quality.points)); }
  return quality;
}

}  // namespace flirt
