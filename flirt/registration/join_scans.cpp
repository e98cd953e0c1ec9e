#include "flirt/registration/join_scans.hpp"

#include "flirt/registration/local_map.hpp"
#include "flirt/registration/surface_alignment.hpp"
#include "flirt/registration/surface_points.hpp"
#include "flirt/registration/window_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>

namespace flirt {
namespace {

/// Squares of the spacing's size that hold a point already.
class TakenSquares {
 public:
  explicit TakenSquares(double size) : size_(std::max(size, 1e-3)) {}
  /// True when the point's square was empty.
  bool take(Point2 point) {
    return squares_.emplace(std::llround(point.x / size_), std::llround(point.y / size_)).second;
  }

 private:
  double size_;
  std::set<std::pair<std::int64_t, std::int64_t>> squares_;
};

Point2 point_at(const ScanPoints& points, std::size_t i) {
  return {points.x[i], points.y[i]};
}

/// Scans joined so far, in the robot frame of the last one.
class JoinedMap {
 public:
  explicit JoinedMap(const Scan& last) { map_.add(surface_points(last), {}); }

  /// Adds an earlier scan: where odometry puts it, or where it fits better near there.
  Pose2 add(const Scan& scan, const Pose2& last_from_robot) {
    const SurfacePoints points = surface_points(scan);
    const Pose2 pose = fitted(points, last_from_robot).value_or(last_from_robot);
    map_.add(points, pose);
    return pose;
  }

 private:
  [[nodiscard]] std::optional<Pose2> fitted(const SurfacePoints& points, const Pose2& last_from_robot) const {
    constexpr std::size_t fewest_points = 15;
    constexpr double least_share = 0.5;  // of the points that find a line: scans of different rooms tell nothing
    const SearchWindow window{
        .map_from_robot = last_from_robot, .half_extent = 0.3, .half_turn = radians_from_degrees(12), .candidates = 1};
    if (points.size() < fewest_points) { return std::nullopt; }
    const auto found = search_window(map_, std::span(&points, 1), window);
    if (found.empty()) { return std::nullopt; }
    const Pose2& start = found.front().map_from_robot;
    const AlignedPose aligned =
        align_to_map(map_, std::span(&points, 1), start, {start, Eigen::Vector3d(2, 2, 2).asDiagonal()});
    const bool enough = static_cast<double>(aligned.terms.pairs) >= least_share * static_cast<double>(points.size());
    const bool near = distance(aligned.map_from_robot, last_from_robot) <= 2 * window.half_extent &&
                      heading_difference(aligned.map_from_robot, last_from_robot) <= 1.5 * window.half_turn;
    return enough && near ? std::optional(aligned.map_from_robot) : std::nullopt;
  }

  LocalMap map_;
};

}  // namespace

ScanPoints join_scans(std::span<const Scan> scans, const ScanPointParams& params) {
  if (scans.empty()) { return {}; }
  const Scan& last = scans.back();
  ScanPoints joined = scan_points(last, params);
  TakenSquares taken(params.spacing);
  for (std::size_t i = 0; i < joined.size(); ++i) { taken.take(point_at(joined, i)); }
  if (scans.size() == 1 || !last.odom_from_robot) { return joined; }
  JoinedMap map(last);
  const Pose2 sensor_from_robot = inverse(last.robot_from_sensor);
  Pose2 last_from_later;  // of the scan after, by the map
  for (std::size_t k = scans.size() - 1; k-- > 0 && scans[k].odom_from_robot;) {
    const Pose2 later_from_robot = inverse(*scans[k + 1].odom_from_robot) * *scans[k].odom_from_robot;
    const Pose2 last_from_robot = map.add(scans[k], last_from_later * later_from_robot);
    const Pose2 last_from_earlier = sensor_from_robot * last_from_robot * scans[k].robot_from_sensor;
    last_from_later = last_from_robot;
    const ScanPoints earlier = scan_points(scans[k], params);
    for (std::size_t i = 0; i < earlier.size(); ++i) {
      const Point2 point = last_from_earlier * point_at(earlier, i);
      if (!taken.take(point)) { continue; }
      joined.x.push_back(static_cast<float>(point.x));
      joined.y.push_back(static_cast<float>(point.y));
      joined.range.push_back(0);
    }
  }
  return joined;
}

}  // namespace flirt
