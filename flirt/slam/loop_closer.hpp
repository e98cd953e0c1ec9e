// flirt/slam/loop_closer.hpp: earlier visits of a place, found with the scans of the last metres moved as one.
#pragma once

#include "flirt/graph/pose_graph.hpp"
#include "flirt/registration/local_map.hpp"
#include "flirt/registration/surface_alignment.hpp"
#include "flirt/slam/closure.hpp"
#include "flirt/slam/global_places.hpp"
#include "flirt/slam/slam_params.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace flirt {

/// Keeps a local map of the earlier scans around the robot, from query to query. A place found is believed when it
/// agrees well, clearly better than any other in the window and than poses beside it, and when the query before or
/// after found the same displacement of the graph. A displacement or turn larger than the way since the last closure
/// makes likely has to be found again and again over some metres: twin rooms are left by then. One four times as large
/// is never believed, unless the robot was lost on the way: then any is. The front-end `automatic`, when no earlier
/// visit was found for long, also asks for the place of single scans in the whole map; such a place is then verified
/// like any other, and several in a row must agree.
class LoopCloser {
 public:
  explicit LoopCloser(const SlamParams& params) : params_(params) {}

  /// To be called for every scan that the graph gets; `scans[i]` belongs to node i. Closures that the scan brings.
  [[nodiscard]] std::vector<Closure> add(std::span<const SlamScan> scans, const PoseGraph& graph);

 private:
  struct Placed {
    std::size_t node;
    Pose2 map_from_node;
  };
  struct Found {
    std::size_t node{0};
    Pose2 map_from_robot{};
    Eigen::Matrix3d information{Eigen::Matrix3d::Zero()};
    std::vector<std::size_t> near{};  ///< nodes of earlier scans
    std::vector<Pose2> map_from_near{};
    double score{0};
    double margin{0};
    std::size_t query{0};  ///< number of the query
    ClosureSource source{ClosureSource::near};
  };
  struct Drift {
    double translation;
    double rotation;
  };

  [[nodiscard]] std::vector<SurfacePoints> query_scans(std::span<const SlamScan> scans,
                                                       std::span<const Pose2> map_from_node) const;
  [[nodiscard]] bool is_earlier(std::size_t node) const;
  [[nodiscard]] bool gather(std::span<const SlamScan> scans, std::span<const Pose2> map_from_node, const Pose2& around,
                            double radius);
  void add_nearest(Found& found) const;
  [[nodiscard]] std::optional<Found> search(std::span<const SurfacePoints> query, std::size_t node, const Pose2& at,
                                            double extent, double turn) const;
  [[nodiscard]] std::vector<Closure> near(std::span<const SlamScan> scans, std::span<const Pose2> map_from_node,
                                          std::span<const SurfacePoints> query);
  [[nodiscard]] std::vector<Closure> anywhere(std::span<const SlamScan> scans, std::span<const Pose2> map_from_node,
                                              std::span<const SurfacePoints> query);
  void measure_way(const PoseGraph& graph);
  [[nodiscard]] Drift likely_drift() const;
  [[nodiscard]] Drift window() const;
  [[nodiscard]] double surprise(const Found& found, std::span<const Pose2> map_from_node) const;
  [[nodiscard]] bool is_sure(std::span<const Found> agreeing) const;
  void forget(std::vector<Found>& waiting, const Found& newest, std::span<const Pose2> map_from_node) const;
  [[nodiscard]] std::vector<Closure> closures(std::span<const Found> agreeing,
                                              std::span<const Pose2> map_from_node) const;
  [[nodiscard]] Closure closure(const Found& found, std::span<const Pose2> map_from_node) const;

  SlamParams params_;
  LocalMap map_{};
  std::vector<Placed> placed_{};
  std::vector<double> travel_{};  ///< m, per node
  double last_query_{0};          ///< m of travel
  double last_closure_{0};        ///< m of travel
  double unseen_{0};              ///< m², variance of the motions since the last closure that were not seen well
  double unseen_turn_{0};         ///< rad², the same of their turns
  std::optional<std::size_t>
      lost_at_{};                 ///< node of the last motion of which nothing was seen, until a closure spans it
  std::size_t last_unseen_{0};    ///< node of the last motion that was not seen; scans before it do not move with it
  std::size_t queries_{0};        ///< so far
  std::vector<Found> waiting_{};  ///< places found near the pose in the graph, not yet believed; they agree
  GlobalPlaces places_{};
  std::optional<std::size_t> places_ready_{};  ///< query after which they were those of all earlier scans
  double last_search_{0};                      ///< m of travel, of the whole map
  std::vector<Found> waiting_anywhere_{};      ///< places found in the whole map that agree with each other
};

}  // namespace flirt
