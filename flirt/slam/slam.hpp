// flirt/slam/slam.hpp: a consistent map from scans as they come, with odometry or without (navigation paper, section
// 3.2, algorithm 1, with the scan as a whole in place of its features).
//
//   Slam slam(params);
//   for (const Scan& scan : log.scans) { slam.add(scan); }
//   slam.finish();
//   use(slam.graph().map_from_node);                        // one pose a scan, of the robot
#pragma once

#include "flirt/core/scan.hpp"
#include "flirt/graph/pose_graph.hpp"
#include "flirt/slam/front_end.hpp"
#include "flirt/slam/session.hpp"
#include "flirt/slam/slam_params.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace flirt {

/// What happened to one scan.
struct SlamStep {
  Pose2 map_from_robot{};  ///< as known now; later closures may move it
  MotionSource source{MotionSource::first};
  double score{0};                          ///< of the scan in the map of the last metres
  bool unobservable{false};                 ///< the motion could not be seen in some direction
  Structure structure{Structure::unknown};  ///< what the keypoints tell, where the front-end looks at them
  std::uint32_t closures{0};                ///< earlier visits found
};

/// Where the time went, s of wall clock.
struct SlamTimes {
  double points{0};
  double front_end{0};
  double loops{0};
  double optimize{0};
  double polish{0};
};

struct SlamSummary {
  std::size_t scans{0};
  std::size_t closures{0};
  std::size_t anywhere{0};      ///< of them, those found by a search of the whole map
  std::size_t unobservable{0};  ///< motions that could not be seen in some direction
  std::size_t pieces{0};        ///< parts of two scans or more that only such motions join to the rest of the map
  std::size_t wide{0};          ///< scans that only the wide search found
  std::size_t predictions{0};   ///< scans whose motion is the prediction
  std::size_t featureless{0};   ///< scans with few keypoints, where the front-end looks at them
  std::size_t cluttered{0};     ///< scans with many, of which few agreed with the scan before
  std::size_t optimizations{0};
  std::size_t repaired{0};  ///< scans that were put elsewhere at the end
  std::size_t pairs{0};     ///< of scans that were aligned with each other at the end
  double pair_residual{0};  ///< m, root mean square of their points' distances from the other's lines
  SlamTimes seconds{};
};

/// Every scan is accepted; one without use gets the predicted pose. Node i of the graph is scan i, its pose that of the
/// robot. Same scans, same answer.
class Slam {
 public:
  explicit Slam(const SlamParams& params = {});
  ~Slam();
  Slam(Slam&&) noexcept;
  Slam& operator=(Slam&&) noexcept;
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  SlamStep add(const Scan& scan);
  /// Joins this run to an earlier map, whose node i is `scans[i]`: its scans and nodes come first, those of this run
  /// after them, in the earlier map's frame. When the run is not found there (`agreeing` is 0), nothing changes. To be
  /// called once, before `finish`; no scans may be added after it. O(queries · cells of the map).
  SessionJoin join(std::span<const Scan> scans, const PoseGraph& graph);
  /// Optimizes all, then aligns overlapping scans jointly; not with a window. More scans may be added after it.
  void finish();

  [[nodiscard]] const PoseGraph& graph() const;
  /// Of the scans added; those of an earlier map have none.
  [[nodiscard]] const std::vector<SlamStep>& steps() const;
  [[nodiscard]] SlamSummary summary() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace flirt
