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

/// The evidence of the scans that count as earlier, kept from query to query; scans that the graph moved are taken out
/// and put in anew.
class GlobalPlaces {
 public:
  /// The pose of the newest scan's robot in the map of the first `earlier` scans, when localization finds it there and
  /// nowhere else (Verdict::unique). O(cells of the map) besides what moved.
  [[nodiscard]] std::optional<Pose2> find(std::span<const SlamScan> scans, std::span<const Pose2> map_from_node,
                                          std::size_t earlier);

 private:
  void update(std::span<const SlamScan> scans, std::span<const Pose2> map_from_node, std::size_t earlier);

  EvidenceGrid grid_{};
  std::vector<Pose2> map_from_placed_{};  ///< per node in the grid, of the robot
  std::optional<MapFields> fields_{};     ///< of the grid, until that changes
};

}  // namespace flirt
