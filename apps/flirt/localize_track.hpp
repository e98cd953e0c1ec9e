// apps/flirt/localize_track.hpp: `flirt localize --track`, a log's scans in order, each with the ones before it.
#pragma once

#include "flirt/core/scan.hpp"
#include "flirt/io/log.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/map/tracker.hpp"

#include "apps/flirt/command.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace flirt::app {

/// One scan's answer beside the pose that its log states, where it states one.
struct TrackedScan {
  TrackStep step;
  std::optional<Pose2> pose_in_log{};  ///< map_from_robot
  double time_us{0};

  /// `unique`, and within 0.5 m and 10° of the log's pose.
  [[nodiscard]] bool is_right() const;
  /// `unique`, and not within them.
  [[nodiscard]] bool is_wrong() const;
};

struct TrackSummary {
  std::size_t scans{0};
  std::optional<std::size_t> until_localized{};          ///< scans until the first unique answer, that one included
  std::optional<std::size_t> until_rightly_localized{};  ///< the same until the first right one; needs poses
  std::size_t unique{0};
  std::size_t ambiguous{0};
  std::size_t lost{0};
  std::optional<std::size_t> right{};               ///< unique and right; needs poses
  std::optional<std::size_t> wrong{};               ///< unique and wrong; needs poses
  std::optional<std::size_t> wrong_convergences{};  ///< times that answers became unique and wrong; needs poses
  std::size_t searches{0};
  std::size_t injections{0};
};
[[nodiscard]] TrackSummary summarise(std::span<const TrackedScan> scans);

/// A log whose scans carry the odometry there is.
struct DrivenLog {
  ScanLog log;
  std::string odometry;             ///< "own", "repeats_poses" (a corrected log: those stand for it), or "none"
  bool has_corrected_poses{false};  ///< log.map_from_robot is more than that odometry
};
[[nodiscard]] DrivenLog with_odometry(LoadedLog loaded);

/// Tracks the log through the map; one Tracker, all scans in order.
[[nodiscard]] std::vector<TrackedScan> track(const PlaceMap& map, const DrivenLog& driven, const TrackerParams& params,
                                             const Session& session);

/// {odometry, summary, queries}: a query for each scan, of the form that `flirt localize` has for single scans, with at
/// most `most_places` of its hypotheses.
[[nodiscard]] nlohmann::ordered_json track_json(const DrivenLog& driven, std::span<const TrackedScan> scans,
                                                std::size_t most_places);

[[nodiscard]] std::string track_line(std::size_t scan, const TrackedScan& tracked);
[[nodiscard]] std::string track_text(const DrivenLog& driven, std::span<const TrackedScan> scans);

}  // namespace flirt::app
