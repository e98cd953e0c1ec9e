// flirt/eval/tracking.hpp: how many scans a lost robot drives until it knows where it is, and how often it is sure of a
// wrong place.
//
// Drives of a few metres are drawn from a log. In a log of its own map, all that lies within 10 m of travel around the
// drive leaves the map: the places must be known from an earlier visit. The same drives are tracked from hypotheses and
// from particles all over the map.
#pragma once

#include "flirt/core/parallel.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/core/scan_interval.hpp"
#include "flirt/eval/revisit.hpp"
#include "flirt/eval/statistics.hpp"
#include "flirt/map/place_map.hpp"
#include "flirt/map/tracker.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

/// What the drives have to do with the map.
enum class DriveKind : std::uint8_t {
  known,      ///< at least `covered` of the scans are answerable (eval/revisit.hpp)
  unmapped,   ///< at most 1 − `covered` of them are: the robot drives where the map shows little or nothing
  kidnapped,  ///< a known drive, and then another one elsewhere, with odometry as if nothing had happened
  foreign,    ///< through another building
};
constexpr auto enum_names(DriveKind /*tag*/) {
  return std::array{std::pair{DriveKind::known, std::string_view("known")},
                    std::pair{DriveKind::unmapped, std::string_view("unmapped")},
                    std::pair{DriveKind::kidnapped, std::string_view("kidnapped")},
                    std::pair{DriveKind::foreign, std::string_view("foreign")}};
}

/// What makes an answer count as sure.
enum class TrackCriterion : std::uint8_t {
  verdict,  ///< Verdict::unique
  spread,   ///< 0.9 of the weight lies in one cluster: what plain Monte Carlo localization has
};
constexpr auto enum_names(TrackCriterion /*tag*/) {
  return std::array{std::pair{TrackCriterion::verdict, std::string_view("verdict")},
                    std::pair{TrackCriterion::spread, std::string_view("spread")}};
}

struct TrackingBenchParams {
  std::size_t drives{40};                            ///< of each kind, at most: as many as the log has room for
  double length{20};                                 ///< m of path of a drive
  double covered{0.8};                               ///< share of answerable scans that makes a drive known
  double correct_distance{0.5};                      ///< m, a pose farther from the truth is wrong
  double correct_heading{radians_from_degrees(10)};  ///< rad
  double sure_share{0.9};                            ///< of the weight, for the criterion `spread`
  RevisitParams revisit{};
  TrackerParams tracker{};
  std::uint64_t seed{0};  ///< of the drives, and of the particles of each
};

/// Scans in a row, and the map scans that leave the map for them.
struct DrivePart {
  ScanInterval scans{};
  ScanInterval removed{};
};
struct TrackedDrive {
  DriveKind kind{DriveKind::known};
  std::vector<DrivePart> parts{};  ///< one; two when kidnapped, of which the second counts
};

/// Drives in the log's own map; starts are drawn with `params.seed` and no closer than half a drive. `log` needs poses.
[[nodiscard]] std::vector<TrackedDrive> drives_in_own_map(const ScanLog& log, const TrackingBenchParams& params,
                                                          std::size_t threads, const Progress& progress = {});
/// Drives in the map of another log: `known`, in the same building and frame, or `foreign`.
[[nodiscard]] std::vector<TrackedDrive> drives_in_other_map(const ScanLog& log, DriveKind kind,
                                                            const TrackingBenchParams& params);

/// One scan's answer.
struct TrackedAnswer {
  std::size_t scan{0};
  double way{0};  ///< m driven since the drive's (last) part began
  TrackStep step{};
  bool agrees{false};  ///< the pose is right, whatever the verdict
};

struct DriveOutcome {
  TrackedDrive drive{};
  TrackInitialisation initialisation{TrackInitialisation::hypotheses};
  std::vector<TrackedAnswer> answers{};  ///< of the last part
  double cpu_us{0};                      ///< a scan, mean over all parts, of the processor's time
};

/// What became of a drive by one criterion.
struct DriveResult {
  std::optional<std::size_t> scans_until{};  ///< the first answer that is sure and right, that one included
  double metres_until{0};                    ///< driven until then
  std::size_t sure{0};
  std::size_t wrong{0};         ///< sure, but elsewhere
  std::size_t convergences{0};  ///< times that answers became sure and wrong
};
[[nodiscard]] DriveResult judge_drive(const DriveOutcome& outcome, TrackCriterion criterion,
                                      const TrackingBenchParams& params);

/// All drives of one kind, by one way to start and one criterion.
struct TrackingSummary {
  DriveKind kind{DriveKind::known};
  TrackInitialisation initialisation{TrackInitialisation::hypotheses};
  TrackCriterion criterion{TrackCriterion::verdict};
  std::size_t drives{0};
  Rate localized{};                      ///< drives that were ever sure and right
  std::optional<double> scans_median{};  ///< until then, over all drives; nothing: half of them never were
  std::optional<double> scans_95{};
  std::optional<double> metres_median{};
  std::optional<double> metres_95{};
  Rate wrong_scans{};   ///< sure and wrong, of all scans
  Rate wrong_drives{};  ///< with any such scan
  std::size_t convergences{0};
  Rate right_scans{};       ///< sure and right, of all scans
  double cpu_us_median{0};  ///< a scan
};

/// Tracks each drive; answers are the same on any number of threads. `log` needs poses and odometry; `map` is the one
/// that the drives' removed scans belong to.
[[nodiscard]] std::vector<DriveOutcome> track_drives(const PlaceMap& map, const ScanLog& log,
                                                     std::span<const TrackedDrive> drives,
                                                     TrackInitialisation initialisation,
                                                     const TrackingBenchParams& params, std::size_t threads,
                                                     const Progress& progress = {});
/// The summary of those outcomes that are of the kind; none has no drives.
[[nodiscard]] TrackingSummary summarise(std::span<const DriveOutcome> outcomes, DriveKind kind,
                                        TrackInitialisation initialisation, TrackCriterion criterion,
                                        const TrackingBenchParams& params);

}  // namespace flirt
