// apps/flirt/localize_report.hpp: what many localized scans come to, as text and as a report to look at.
#pragma once

#include "flirt/core/scan.hpp"
#include "flirt/eval/statistics.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/map/place_map.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace flirt::app {

/// One scan's answer beside the pose that its log states, where it states one.
struct LocalizedScan {
  std::size_t scan{0};
  Verdict verdict{Verdict::lost};
  std::optional<Pose2> map_from_sensor{};
  std::optional<Pose2> pose_in_log{};
  double time_us{0};

  /// Within 0.5 m and 10° of the log's pose.
  [[nodiscard]] bool agrees() const;
};

struct LocalizeSummary {
  Rate agree{};            ///< of the scans whose log states a pose
  Rate agree_if_unique{};  ///< of those answered `unique`
  std::size_t unique{0};
  std::size_t ambiguous{0};
  std::size_t lost{0};
  double time_median_us{0};
  double time_p95_us{0};
};
[[nodiscard]] LocalizeSummary summarise(std::span<const LocalizedScan> scans);

/// A few lines for people.
[[nodiscard]] std::string summary_text(const LocalizeSummary& summary);

/// The occupied cells of the map.
[[nodiscard]] std::vector<Point2> map_points(const PlaceMap& map);

/// P1 Fig. 6 as SVG: the map, the hypotheses as triangles, and the scan at the best of them. `points` as of map_points.
[[nodiscard]] std::string localization_picture(std::vector<Point2> points, const Scan& scan,
                                               const LocalizationResult& result,
                                               const std::optional<Pose2>& pose_in_log, const std::string& title);

struct CaptionedFigure {
  std::string svg;
  std::string caption;
};

/// A page with the summary, a plan of right and wrong answers, and the given examples.
[[nodiscard]] std::string localize_report(const std::string& title, std::span<const LocalizedScan> scans,
                                          std::vector<Point2> points, std::span<const CaptionedFigure> examples);

}  // namespace flirt::app
