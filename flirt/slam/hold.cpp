#include "flirt/slam/hold.hpp"

#include "flirt/slam/slam_scan.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <span>
#include <vector>

namespace flirt {
namespace {

/// A point of a wall at a grazing angle, far from its neighbours: where it is hit depends on where the robot stands.
bool grazes(const SurfacePoints& points, std::size_t i) {
  constexpr double cos_in_line = 0.985;  // 10°
  constexpr double far = 0.2;            // m
  if (i == 0 || i + 1 == points.size()) { return points.normal_x[i] == 0 && points.normal_y[i] == 0; }
  const auto at = [&](std::size_t k) { return Point2{points.x[k], points.y[k]}; };
  const Point2 before = at(i) - at(i - 1);
  const Point2 after = at(i + 1) - at(i);
  return std::max(norm(before), norm(after)) > far && dot(before, after) > cos_in_line * norm(before) * norm(after);
}

SurfacePoints without_grazed(const SurfacePoints& points) {
  SurfacePoints kept;
  kept.origin = points.origin;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (grazes(points, i)) { continue; }
    kept.x.push_back(points.x[i]);
    kept.y.push_back(points.y[i]);
    kept.normal_x.push_back(points.normal_x[i]);
    kept.normal_y.push_back(points.normal_y[i]);
  }
  return kept;
}

/// Score by which a pose leads over the better of those aside along a direction, frame of the robot.
double lead_over_aside(const LocalMap& map, std::span<const SurfacePoints> scans, const Pose2& map_from_robot,
                       Point2 direction_in_robot) {
  constexpr double aside = 0.3;  // m
  std::vector<SurfacePoints> telling;
  std::ranges::transform(scans, std::back_inserter(telling), without_grazed);
  double best = -1e9;
  for (const double step : {-aside, aside}) {
    const Pose2 there = map_from_robot * Pose2{step * direction_in_robot.x, step * direction_in_robot.y, 0};
    best = std::max(best, score_of(map.agreement(telling, there)));
  }
  return score_of(map.agreement(telling, map_from_robot)) - best;
}

/// Σ JᵀJ of distances from surfaces over a motion of the robot in its own frame.
struct Information {
  Eigen::Matrix3d sum{Eigen::Matrix3d::Zero()};
  int surfaces{0};

  void add(const SurfacePoints& points, std::size_t i) {
    const double nx = points.normal_x[i];
    const double ny = points.normal_y[i];
    const Eigen::Vector3d jacobian(nx, ny, points.x[i] * ny - points.y[i] * nx);
    sum += jacobian * jacobian.transpose();
    ++surfaces;
  }
  [[nodiscard]] double along(Point2 direction) const {
    const Eigen::Vector2d d(direction.x, direction.y);
    return d.dot(sum.topLeftCorner<2, 2>() * d);
  }
  [[nodiscard]] Hold weakest() const {
    if (surfaces == 0) { return {}; }
    const double heading = std::max(sum(2, 2), 1e-9);
    const Eigen::Matrix2d translation =
        sum.topLeftCorner<2, 2>() - sum.topRightCorner<2, 1>() * sum.bottomLeftCorner<1, 2>() / heading;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(translation);
    const Eigen::Vector2d direction = solver.eigenvectors().col(0);
    return {.weakest = solver.eigenvalues().x() / surfaces, .direction = {direction.x(), direction.y()}};
  }
};

bool has_surface(const SurfacePoints& points, std::size_t i) {
  return points.normal_x[i] != 0 || points.normal_y[i] != 0;
}

/// Whether a point lies on a surface of the map that faces its way.
bool lies_on_surface(const LocalMap& map, Point2 in_map, Point2 normal) {
  constexpr double near = 0.1;      // m
  constexpr double same_way = 0.7;  // cosine, 45°
  const LinePiece* line = map.line_at(in_map);
  if (line == nullptr) { return false; }
  const Point2 line_normal{line->normal_x, line->normal_y};
  return std::abs(dot(line_normal, in_map - Point2{line->x, line->y})) < near &&
         std::abs(dot(line_normal, normal)) > same_way;
}

}  // namespace

Hold hold_of(const SurfacePoints& points) {
  Information information;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (has_surface(points, i)) { information.add(points, i); }
  }
  return information.weakest();
}

Hold hold_of(std::span<const SurfacePoints> scans, const LocalMap& map, const Pose2& map_from_robot) {
  const Pose2 turn{0, 0, map_from_robot.theta};
  Information agreeing;
  Information contradicting;
  Information standing;  // all that does not contradict
  for (const SurfacePoints& points : scans) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!has_surface(points, i)) { continue; }
      const Point2 in_map = map_from_robot * Point2{points.x[i], points.y[i]};
      const bool is_free = map.is_free(in_map);  // also where somebody stood for a moment
      const bool is_in_the_open = is_free && map.line_at(in_map) == nullptr;
      if (!is_free && lies_on_surface(map, in_map, turn * Point2{points.normal_x[i], points.normal_y[i]})) {
        agreeing.add(points, i);
      }
      (is_in_the_open ? contradicting : standing).add(points, i);
    }
  }
  Hold hold = standing.weakest();
  hold.lead = lead_over_aside(map, scans, map_from_robot, hold.direction);
  hold.doubted = contradicting.along(hold.direction) > agreeing.along(hold.direction);
  return hold;
}

bool know_at_most(double information, Point2 direction, Eigen::Matrix3d& known) {
  const Eigen::Vector3d d(direction.x, direction.y, 0);
  if (d.dot(known * d) <= information) { return false; }
  const Eigen::Matrix3d rest = Eigen::Matrix3d::Identity() - d * d.transpose();
  known = rest * known * rest + information * d * d.transpose();
  return true;
}

double inverse_deviation(const Hold& hold, const SlamParams& params) {
  constexpr double deviation_of_lead = 0.06;  // m, of a scan whose pose leads by a score of 1
  return std::max(hold.lead, params.unobservable_drop) / deviation_of_lead;
}

bool holds(const Hold& hold, const SlamParams& params) {
  return !hold.doubted && (hold.weakest >= params.unobservable_share || hold.lead >= params.unobservable_drop);
}

}  // namespace flirt
