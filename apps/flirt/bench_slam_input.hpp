// apps/flirt/bench_slam_input.hpp: the logs of `flirt bench slam`, with what each is judged by.
#pragma once

#include "flirt/core/scan.hpp"
#include "flirt/core/stamped_pose.hpp"
#include "flirt/eval/trajectory_metrics.hpp"

#include "apps/flirt/command.hpp"

#include <optional>
#include <string>
#include <vector>

namespace flirt::app {

/// A log to map.
struct SlamInput {
  std::string name;
  std::string file;
  ScanLog log{};                      ///< without poses: what is under test does not see them
  std::vector<StampedPose> truth{};   ///< empty: not known
  std::vector<Pose2> corrected{};     ///< the truth, one a scan; empty unless every scan has one
  std::vector<Relation> relations{};  ///< official ones
  std::string odometry{};             ///< "own", "synthetic" or "none"
  std::optional<double> bound{};      ///< m, ATE that a start has to keep

  [[nodiscard]] bool has_odometry() const { return odometry != "none"; }
};

/// Reads what `NAME=FILE[,truth=FILE][,relations=FILE][,odometry=own|synthetic|none][,bound=M]` says. The truth is the
/// log's own corrected poses unless given. Synthetic odometry adds errors, drawn from the session's seed, to the
/// motions between corrected poses. Throws UsageError for a text of another form, BadInput for files.
SlamInput read_slam_input(const std::string& text, const Session& session);

/// Every `every`-th scan.
void thin(SlamInput& input, std::size_t every);

}  // namespace flirt::app
