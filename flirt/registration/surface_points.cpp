#include "flirt/registration/surface_points.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

namespace flirt {
namespace {

constexpr std::size_t fewest_on_line = 3;  // points

struct Surface {
  Point2 point;
  Point2 normal;  // (0, 0): none
};

/// The neighbours of a point along the sweep: not farther than `radius`, without jumps.
struct Neighbours {
  std::size_t begin;
  std::size_t end;
};

Neighbours neighbours(const std::vector<BeamPoint>& hits, std::size_t at, double radius) {
  constexpr std::uint32_t longest_gap = 3;  // beams without return in between
  const Point2 centre = hits[at].point;
  const auto joined = [&](std::size_t a, std::size_t b) {
    const std::uint32_t gap = hits[a].beam > hits[b].beam ? hits[a].beam - hits[b].beam : hits[b].beam - hits[a].beam;
    return gap <= longest_gap && norm(hits[a].point - hits[b].point) <= radius;
  };
  std::size_t begin = at;
  while (begin > 0 && joined(begin, begin - 1) && norm(hits[begin - 1].point - centre) <= radius) { --begin; }
  std::size_t end = at + 1;
  while (end < hits.size() && joined(end - 1, end) && norm(hits[end].point - centre) <= radius) { ++end; }
  return {begin, end};
}

/// A point and the ones before and after it where they lie in line, though far apart: a wall at a grazing angle.
Neighbours in_line(const std::vector<BeamPoint>& hits, std::size_t at, double cos_in_line) {
  constexpr double farthest = 1;  // m
  const Neighbours alone{at, at + 1};
  if (at == 0 || at + 1 == hits.size()) { return alone; }
  const Point2 before = hits[at].point - hits[at - 1].point;
  const Point2 after = hits[at + 1].point - hits[at].point;
  if (std::max(norm(before), norm(after)) > farthest) { return alone; }
  return dot(before, after) > cos_in_line * norm(before) * norm(after) ? Neighbours{at - 1, at + 2} : alone;
}

/// The line through the neighbours, when there are three or more and they lie on one.
Surface fit(const std::vector<BeamPoint>& hits, std::size_t at, Neighbours around) {
  constexpr double roundest = 0.1;  // smaller over larger variance
  const Point2 point = hits[at].point;
  if (around.end - around.begin < fewest_on_line) { return {point, {}}; }
  const auto n = static_cast<double>(around.end - around.begin);
  Point2 sum;
  for (std::size_t i = around.begin; i < around.end; ++i) { sum = sum + hits[i].point; }
  const Point2 mean = 1.0 / n * sum;
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (std::size_t i = around.begin; i < around.end; ++i) {
    const Point2 d = hits[i].point - mean;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  const double half_difference = std::hypot(0.5 * (xx - yy), xy);
  const double middle = 0.5 * (xx + yy);
  if (!(middle - half_difference < roundest * (middle + half_difference))) { return {point, {}}; }
  const double along = 0.5 * std::atan2(2 * xy, xx - yy);
  Point2 normal{-std::sin(along), std::cos(along)};
  if (dot(normal, mean) > 0) { normal = -1.0 * normal; }
  return {point - dot(normal, point - mean) * normal, normal};
}

void index_bearings(SurfacePoints& points) {
  points.first_after.assign(SurfacePoints::bins + 1, 0);
  const auto width = static_cast<float>(2 * std::numbers::pi / SurfacePoints::bins);
  std::size_t at = 0;
  for (std::size_t bin = 0; bin <= SurfacePoints::bins; ++bin) {
    const float lower = static_cast<float>(bin) * width - std::numbers::pi_v<float>;
    while (at < points.size() && points.bearing[at] < lower) { ++at; }
    points.first_after[bin] = static_cast<std::uint16_t>(at);
  }
}

void append(SurfacePoints& points, const Surface& surface, const Pose2& robot_from_sensor) {
  const Point2 in_robot = robot_from_sensor * surface.point;
  const Point2 normal = Pose2{0, 0, robot_from_sensor.theta} * surface.normal;
  points.x.push_back(static_cast<float>(in_robot.x));
  points.y.push_back(static_cast<float>(in_robot.y));
  points.normal_x.push_back(static_cast<float>(normal.x));
  points.normal_y.push_back(static_cast<float>(normal.y));
  const Point2 ray = in_robot - robot_from_sensor.translation();
  points.bearing.push_back(static_cast<float>(std::atan2(ray.y, ray.x)));
}

void sort_by_bearing(SurfacePoints& points) {
  if (std::ranges::is_sorted(points.bearing)) { return; }
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return points.bearing[i]; });
  for (std::vector<float>* column : {&points.x, &points.y, &points.normal_x, &points.normal_y, &points.bearing}) {
    std::vector<float> sorted(column->size());
    std::ranges::transform(order, sorted.begin(), [&](std::size_t i) { return (*column)[i]; });
    *column = std::move(sorted);
  }
}

}  // namespace

SurfacePoints surface_points(const Scan& scan, const SurfacePointParams& params) {
  constexpr std::size_t most = 65535;
  constexpr double beams_in_reach = 2.5;
  const double cos_in_line = std::cos(params.in_line);
  SurfacePoints points;
  points.origin = scan.robot_from_sensor.translation();
  const std::vector<BeamPoint> hits = hit_points(scan);
  std::optional<Point2> last;
  for (std::size_t i = 0; i < hits.size() && points.size() < most; ++i) {
    const double range = scan.ranges[hits[i].beam];
    if (range < params.range_min || range >= params.range_max) { continue; }
    if (last && norm(hits[i].point - *last) < params.spacing) { continue; }
    last = hits[i].point;
    const double radius = std::max(params.fit_radius, beams_in_reach * range * std::abs(scan.beams.angle_step));
    Neighbours around = neighbours(hits, i, radius);
    if (around.end - around.begin < fewest_on_line) { around = in_line(hits, i, cos_in_line); }
    append(points, fit(hits, i, around), scan.robot_from_sensor);
  }
  sort_by_bearing(points);
  index_bearings(points);
  return points;
}

SurfacePoints seen_from(const SurfacePoints& points, const Pose2& other_from_robot, std::size_t stride) {
  const Pose2 turn{0, 0, other_from_robot.theta};
  SurfacePoints seen;
  seen.origin = other_from_robot * points.origin;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const Point2 point = other_from_robot * Point2{points.x[i], points.y[i]};
    const Point2 normal = turn * Point2{points.normal_x[i], points.normal_y[i]};
    seen.x.push_back(static_cast<float>(point.x));
    seen.y.push_back(static_cast<float>(point.y));
    seen.normal_x.push_back(static_cast<float>(normal.x));
    seen.normal_y.push_back(static_cast<float>(normal.y));
  }
  return seen;
}

}  // namespace flirt
