#include "flirt/arena/orthogonal_corners.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

namespace flirt {
namespace {

constexpr double pi = std::numbers::pi;

/// Σ over lines of one direction of the square of the points on each: large where points line up.
class LineUp {
 public:
  explicit LineUp(const OrthogonalCornerParams& params)
      : step_(params.distance_step), last_(static_cast<std::ptrdiff_t>(std::ceil(params.distance_max / step_))) {
    counts_.resize(static_cast<std::size_t>(2 * last_ + 1));
  }

  std::uint64_t operator()(const PolarScan& scan, double normal) {
    std::ranges::fill(counts_, 0U);
    const Point2 across{std::cos(normal), std::sin(normal)};
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const double line = std::round(dot(scan.points[i], across) / step_);
      if (scan.has_return(i) && std::abs(line) <= static_cast<double>(last_)) {
        ++counts_[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(line) + last_)];
      }
    }
    std::uint64_t sum = 0;
    for (const std::uint32_t count : counts_) { sum += std::uint64_t{count} * count; }
    return sum;
  }

 private:
  double step_;
  std::ptrdiff_t last_;
  std::vector<std::uint32_t> counts_{};
};

struct Corner {
  double score{0};
  Point2 point{};       ///< m, frame of the walls
  double direction{0};  ///< rad, frame of the walls
  double reach{0};      ///< m
};

/// Counts the neighbours on the wall along y and on that along x, in the frame of the walls.
class CornerVotes {
 public:
  explicit CornerVotes(double thickness) : thickness_(thickness) {}

  void add(Point2 own, Point2 other) {
    const Point2 offset = other - own;
    if (std::abs(offset.x) < thickness_ && std::abs(offset.y) > thickness_) {
      ++along_y_;
      x_sum_ += other.x;
      offset.y > 0 ? vote(north_east, north_west) : vote(south_west, south_east);
    } else if (std::abs(offset.y) < thickness_ && std::abs(offset.x) > thickness_) {
      ++along_x_;
      y_sum_ += other.y;
      offset.x > 0 ? vote(north_east, south_east) : vote(north_west, south_west);
    }
  }

  /// Nothing where one wall prevails.
  [[nodiscard]] std::optional<Corner> corner(double evenness) const {
    const double score = (along_y_ + along_x_) / (evenness + std::abs(along_y_ - along_x_));
    if (!(score > 1) || along_x_ == 0 || along_y_ == 0) { return std::nullopt; }
    const auto quadrant = std::max_element(votes_.begin(), votes_.end()) - votes_.begin();
    return Corner{score, {x_sum_ / along_y_, y_sum_ / along_x_}, pi / 4 + pi / 2 * static_cast<double>(quadrant), 0};
  }

 private:
  enum Quadrant : std::size_t { north_east, north_west, south_west, south_east };
  void vote(Quadrant a, Quadrant b) {
    ++votes_[a];
    ++votes_[b];
  }

  double thickness_;
  double along_x_{0};
  double along_y_{0};
  double x_sum_{0};
  double y_sum_{0};
  std::array<std::uint32_t, 4> votes_{};
};

std::optional<Corner> corner_at(const PolarScan& scan, std::span<const Point2> in_walls, std::uint32_t i,
                                const OrthogonalCornerParams& params) {
  const double reach = reach_at(scan.ranges[i], params.reach);
  const Neighbours sides = neighbours_of(scan, i, reach, Boundary::excluded);
  if (std::min(sides.left.size(), sides.right.size()) < params.min_side_points) { return std::nullopt; }
  CornerVotes votes(params.wall_thickness);
  for (const std::uint32_t j : sides.left) { votes.add(in_walls[i], in_walls[j]); }
  for (const std::uint32_t j : sides.right) { votes.add(in_walls[i], in_walls[j]); }
  std::optional<Corner> corner = votes.corner(params.evenness);
  if (corner) { corner->reach = reach; }
  return corner;
}

}  // namespace

double main_direction(const PolarScan& scan, const OrthogonalCornerParams& params) {
  const auto quarter = static_cast<std::size_t>(std::max(1.0, std::round(90 / params.angle_step)));
  LineUp line_up(params);
  double best = 0;
  std::uint64_t most = 0;
  for (std::size_t t = 0; t < quarter; ++t) {
    const double angle = pi / 2 * static_cast<double>(t) / static_cast<double>(quarter);
    const std::uint64_t sum = line_up(scan, angle) + line_up(scan, angle + pi / 2);
    if (sum > most) {
      most = sum;
      best = angle;
    }
  }
  return best;
}

std::vector<Keypoint> detect_orthogonal_corners(const Scan& scan, const OrthogonalCornerParams& params) {
  const PolarScan polar = polar_scan(scan, params.limits);
  const Pose2 sensor_from_walls{0, 0, main_direction(polar, params)};
  const Pose2 walls_from_sensor = inverse(sensor_from_walls);
  std::vector<Point2> in_walls;
  in_walls.reserve(polar.size());
  for (const Point2 point : polar.points) { in_walls.push_back(walls_from_sensor * point); }

  std::vector<Corner> corners(polar.size());
  std::vector<double> scores(polar.size());
  for (std::uint32_t i = 0; i < polar.size(); ++i) {
    if (!polar.has_return(i)) { continue; }
    if (const auto corner = corner_at(polar, in_walls, i, params)) {
      corners[i] = *corner;
      scores[i] = corner->score;
    }
  }
  std::vector<Keypoint> keypoints;
  for (const std::uint32_t i : local_maxima(polar, scores, params.suppression_radius)) {
    const Corner& corner = corners[i];
    keypoints.push_back(
        {.sensor_from_keypoint = sensor_from_walls * Pose2{corner.point.x, corner.point.y, corner.direction},
         .scale = static_cast<float>(corner.reach),
         .support_radius = static_cast<float>(corner.reach),
         .response = static_cast<float>(corner.score),
         .beam = polar.beams[i]});
  }
  return keypoints;
}

}  // namespace flirt
