#include "flirt/registration/join_scans.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
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

}  // namespace

ScanPoints join_scans(std::span<const Scan> scans, const ScanPointParams& params) {
  if (scans.empty()) { return {}; }
  const Scan& last = scans.back();
  ScanPoints joined = scan_points(last, params);
  TakenSquares taken(params.spacing);
  for (std::size_t i = 0; i < joined.size(); ++i) { taken.take(point_at(joined, i)); }
  for (std::size_t k = scans.size() - 1; k-- > 0 && last.odom_from_robot && scans[k].odom_from_robot;) {
    const Pose2 last_sensor_from_odom = inverse(*last.odom_from_robot * last.robot_from_sensor);
    const Pose2 last_from_earlier = last_sensor_from_odom * *scans[k].odom_from_robot * scans[k].robot_from_sensor;
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
