// flirt/slam/flirt_constraints.hpp: constraints between a scan and all scans of the map (P1 §3.2, algorithm 1, lines
// 4-9).
#pragma once

#include "flirt/graph/pose_graph.hpp"
#include "flirt/slam/closure.hpp"
#include "flirt/slam/constraint_match.hpp"
#include "flirt/slam/front_end.hpp"
#include "flirt/slam/slam_params.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// Matches each new scan with every earlier one, or with those of the window, wherever the graph has them: the best
/// constraints that pass the gates. Constraints to places that were left long ago are called loops, but are found and
/// judged like all others.
class FlirtConstraints {
 public:
  explicit FlirtConstraints(const SlamParams& params) : params_(params), matcher_(params.flirt) {}

  /// To be called for every scan that the graph gets, after its motion edge; `scans[i]` belongs to node i. A motion
  /// that was matched is the constraint to the scan before, and one of the best. O(scans · keypoints² + edges log
  /// edges).
  [[nodiscard]] std::vector<Closure> add(std::span<const SlamScan> scans, const PoseGraph& graph, MotionSource motion);

 private:
  struct Candidate {
    std::uint32_t node;
    ConstraintMatch match;
  };
  [[nodiscard]] std::vector<Candidate> candidates(std::span<const SlamScan> scans);
  [[nodiscard]] bool is_loop(std::uint32_t earlier, std::uint32_t node) const;

  SlamParams params_;
  ConstraintMatcher matcher_;
  std::vector<double> travel_{};  ///< m, per node
};

}  // namespace flirt
