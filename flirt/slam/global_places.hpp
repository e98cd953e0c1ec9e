// flirt/slam/global_places.hpp: where in the map built so far a scan was taken, whatever the graph believes.
#pragma once

#include "flirt/grid/evidence_grid.hpp"
#include "flirt/registration/map_fields.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace flirt {

/// A place that localization found for a scan, of its robot.
struct FoundPlace {
  Pose2 map_from_robot{};
  Eigen::Matrix3d information{Eigen::Matrix3d::Identity()};  ///< of the pose, in the robot's frame, as of an edge
};

/// The evidence of some scans, kept from query to query; scans that the graph moved are taken out and put in anew.
class GlobalPlaces {
 public:
  /// The map becomes that of the first `earlier` scans; at most `most` of them are placed in one call, and true says
  /// that all are. O(scans + what changed).
  [[nodiscard]] bool update(std::span<const SlamScan> scans, std::span<const Pose2> map_from_node, std::size_t earlier,
                            std::size_t most);
  /// The pose of a scan's robot in that map, when localization finds it there and nowhere else (Verdict::unique).
  /// O(cells of the map).
  [[nodiscard]] std::optional<FoundPlace> find(const Scan& scan);

 private:
  EvidenceGrid grid_{EvidenceGridParams{}};  // spelt out: GCC 12 takes the default argument for uninitialized
  std::vector<Pose2> map_from_placed_{};     ///< per node in the grid, of the robot
  MapFields fields_{};                       ///< of the grid
};

}  // namespace flirt
