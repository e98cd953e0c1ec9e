// flirt/eval/transform_cases.hpp: the papers' test bed for features: reference locations, and the changed scans that
// each is compared with (P2 §IV-A, Fig. 4).
#pragma once

#include "flirt/core/parallel.hpp"
#include "flirt/core/scan.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

/// How a scan is changed.
enum class ScanTransform : std::uint8_t {
  viewpoint,     ///< another scan of the log that sees part of the same
  noise,         ///< normal noise along the beams
  subsampling,   ///< readings left out
  oversampling,  ///< readings put in between
};
constexpr auto enum_names(ScanTransform /*tag*/) {
  return std::array{std::pair{ScanTransform::viewpoint, std::string_view("viewpoint")},
                    std::pair{ScanTransform::noise, std::string_view("noise")},
                    std::pair{ScanTransform::subsampling, std::string_view("subsampling")},
                    std::pair{ScanTransform::oversampling, std::string_view("oversampling")}};
}
inline constexpr std::array all_transforms{ScanTransform::viewpoint, ScanTransform::noise, ScanTransform::subsampling,
                                           ScanTransform::oversampling};
inline constexpr std::size_t transform_count = all_transforms.size();

/// One point of a curve: how, and how much.
struct Condition {
  ScanTransform transform{ScanTransform::viewpoint};
  double level{0};  ///< overlap as a share; σ in m; factor
};

/// Overlap .5 to .9, σ 0 to 0.5 m, factors 2 to 4 (P2 §IV-A).
[[nodiscard]] std::vector<Condition> paper_conditions();

struct TransformParams {
  double overlap_tolerance{0.1};   ///< m, between two points that count as the same
  double overlap_half_width{.05};  ///< a scan of this much more or less overlap belongs to a level
  double reach{15.0};              ///< m, scans farther away are not asked for their overlap
  std::uint32_t partners{0};       ///< scans a location and level of overlap, at most, drawn from all; 0: all
  std::uint64_t seed{0};           ///< of the locations, the noise and the draw of partners
};

/// A scan of one of several logs.
struct Location {
  std::size_t log{0};
  std::size_t scan{0};

  friend bool operator==(const Location&, const Location&) = default;
};

/// `count` different scans of log number `log`, or all that have three hits or more. A longer list begins with the
/// shorter one of the same seed. O(scans · beams).
[[nodiscard]] std::vector<Location> draw_locations(const ScanLog& scans, std::size_t log, std::size_t count,
                                                   std::uint64_t seed);

/// A changed scan of a location.
struct TransformCase {
  std::size_t condition{0};  ///< index into the conditions
  Scan scan{};
  Pose2 reference_from_sensor{};  ///< maps the changed scan into the reference scan's frame, by the true poses
};

/// All cases of a location, in order of the conditions. Overlap is the share of the reference's points that have a
/// point of the other scan within the tolerance at the true poses; the reference itself is no partner. `log` has poses.
/// O(scans in reach · points).
[[nodiscard]] std::vector<TransformCase> cases_of(const ScanLog& log, const Location& location,
                                                  std::span<const Condition> conditions, const TransformParams& params);

/// End points of all hits, moved by `reference_from_sensor`.
[[nodiscard]] std::vector<Point2> points_of(const Scan& scan, const Pose2& reference_from_sensor);

}  // namespace flirt
