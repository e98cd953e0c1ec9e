// flirt/eval/localization.hpp: finding single scans of a log in the map that the log's other scans make.
//
// Two protocols. `paper`: only the query itself leaves the map (P1 §4.1, P2 §IV-D); its neighbours in time stay, so the
// figures say how well scans match, not whether a lost robot is found. `revisit`: everything within 10 m of travel
// leaves the map: the robot must recognise a place from an earlier visit.
#pragma once

#include "flirt/core/scan.hpp"
#include "flirt/eval/coverage.hpp"
#include "flirt/eval/localization_answer.hpp"
#include "flirt/eval/revisit.hpp"
#include "flirt/eval/statistics.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/map/place_map.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace flirt {

enum class LocalizationProtocol : std::uint8_t { paper, revisit };
constexpr auto enum_names(LocalizationProtocol /*tag*/) {
  return std::array{std::pair{LocalizationProtocol::paper, std::string_view("paper")},
                    std::pair{LocalizationProtocol::revisit, std::string_view("revisit")}};
}

/// The least number of inliers of the papers' curves (P1 Fig. 5): the matching itself must not ask for more.
inline constexpr std::uint32_t paper_n_min = 3;

/// How one answer is picked from a solution set. `closest` looks at the truth: the upper bound, for evaluation only.
enum class PickBy : std::uint8_t { closest, corresp, residual };
constexpr auto enum_names(PickBy /*tag*/) {
  return std::array{std::pair{PickBy::closest, std::string_view("closest")},
                    std::pair{PickBy::corresp, std::string_view("corresp")},
                    std::pair{PickBy::residual, std::string_view("residual")}};
}

struct LocalizationBenchParams {
  LocalizationProtocol protocol{LocalizationProtocol::paper};
  std::size_t every{1};  ///< query every K-th scan
  std::size_t join{1};   ///< scans, with the query, asked as one (`revisit`); needs odometry
  PoseTolerance tolerance{};
  double block_length{10.0};  ///< m of path in one block of the bootstrap
  RevisitParams revisit{};
  LocalizeParams localize{};
  std::uint64_t seed{0};  ///< of the bootstrap
};

/// P1 Fig. 5: precision and recall of one strategy over the least number of inliers, over all queries.
struct StrategyCurve {
  PickBy strategy{PickBy::closest};
  std::vector<std::uint32_t> n_min{};  ///< 3..15
  std::vector<Rate> precision{};       ///< correct of answered
  std::vector<Rate> recall{};          ///< correct of all queries
  Interval recall_bootstrap{};         ///< of recall at the least n_min, by blocks of trajectory

  /// p_GL read as correct of all queries (recall at the least n_min) and as precision at the least n_min.
  [[nodiscard]] Rate p_gl() const { return recall.front(); }
  [[nodiscard]] Rate precision_at_least() const { return precision.front(); }
  /// p_CL: largest recall among thresholds whose precision is 0.95 or more.
  [[nodiscard]] double p_cl() const;
};

struct RevisitSummary {
  Rate success{};          ///< right pose at 0.5 m and 10°, of the answerable queries
  Rate precise_success{};  ///< the same at 0.25 m and 5°
  Interval success_bootstrap{};
  Interval precise_bootstrap{};
  std::vector<PrecisionRecallPoint> curve{};
  std::vector<ReliabilityBin> reliability{};  ///< of the confidence
  Rate unique_right{};                        ///< right among all answers called unique, whoever asked
  Rate unique_found{};                        ///< answerable queries that were called unique and right
  Coverage nees{};                            ///< of the stated covariances, over the right answers
};

struct LocalizationTimes {
  double detect_median{0};     ///< µs a scan
  double describe_median{0};   ///< µs a scan
  double per_query_median{0};  ///< µs, everything from the scan to the verdict
  double per_query_p95{0};     ///< µs
  double per_pair{0};          ///< µs, mean over all query-scan pairs; 0 unless scans are matched one by one
  double search_median{0};     ///< µs, coarse candidates
  double rank_median{0};       ///< µs, candidates ranked by their beams
  double refine_median{0};     ///< µs, refinement, score, verdict
  double prepare_median{0};    ///< µs, neighbours taken out of the evidence: not part of a query
};

struct LocalizationBench {
  std::size_t queries{0};
  std::size_t answerable{0};
  std::size_t map_scans{0};
  double features_per_scan{0};
  std::vector<StrategyCurve> strategies{};  ///< under `paper`
  std::optional<RevisitSummary> revisit{};  ///< under `revisit`
  LocalizationTimes times{};
  std::vector<LocalizationAnswer> answers{};  ///< one per query and strategy, in query order
  std::vector<std::uint32_t> blocks{};        ///< block of trajectory of each query, for the bootstrap
};

/// Runs a protocol over the log, which needs poses (truth). `map` is the map of all its scans in log order. The answers
/// are the same on any number of threads.
[[nodiscard]] LocalizationBench bench_localization(const ScanLog& log, const PlaceMap& map,
                                                   const LocalizationBenchParams& params, std::size_t threads,
                                                   const Progress& progress = {});

}  // namespace flirt
