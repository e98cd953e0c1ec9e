#include "flirt/slam/global_places.hpp"

#include "flirt/map/verdict.hpp"
#include "flirt/registration/search.hpp"

namespace flirt {

bool GlobalPlaces::update(std::span<const SlamScan> scans, std::span<const Pose2> map_from_node, std::size_t earlier,
                          std::size_t most) {
  constexpr double moved = 0.05;   // m
  constexpr double turned = 0.01;  // rad
  std::size_t changes = 0;
  for (std::size_t node = 0; node < earlier && changes < most; ++node) {
    const Scan& scan = scans[node].scan;
    const bool is_new = node == map_from_placed_.size();
    if (is_new) {
      map_from_placed_.push_back(map_from_node[node]);
    } else {
      Pose2& placed = map_from_placed_[node];
      if (distance(placed, map_from_node[node]) < moved && heading_difference(placed, map_from_node[node]) < turned) {
        continue;
      }
      grid_.remove(scan, placed * scan.robot_from_sensor);
      placed = map_from_node[node];
    }
    grid_.add(scan, map_from_node[node] * scan.robot_from_sensor);
    ++changes;
  }
  if (changes > 0) { fields_ = updated_fields(fields_, grid_); }
  return changes < most;
}

std::optional<FoundPlace> GlobalPlaces::find(const Scan& scan) {
  if (fields_.empty()) { return std::nullopt; }
  const ScanPoints points = scan_points(scan);
  if (points.size() == 0) { return std::nullopt; }
  const std::vector<ScoredPose> poses = search(fields_, points);
  if (judge_answer(poses, points.size()).verdict != Verdict::unique) { return std::nullopt; }
  const ScoredPose& best = poses.front();
  return FoundPlace{best.map_from_sensor * inverse(scan.robot_from_sensor),
                    robot_information(best.covariance, best.map_from_sensor, scan.robot_from_sensor)};
}

}  // namespace flirt
