// flirt/eval/arena.hpp: our features and matcher and the rivals', in every combination, on the same queries.
//
// Every query scan is matched once with every other scan of the log. From these matches both protocols are answered:
// `paper` (only the query leaves the map) and `revisit` (10 m of travel around it do); see flirt/eval/localization.hpp.
#pragma once

#include "flirt/arena/any_features.hpp"
#include "flirt/arena/glarot.hpp"
#include "flirt/core/parallel.hpp"
#include "flirt/core/result.hpp"
#include "flirt/core/scan.hpp"
#include "flirt/eval/arena_matcher.hpp"
#include "flirt/eval/localization_answer.hpp"
#include "flirt/eval/revisit.hpp"
#include "flirt/eval/statistics.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace flirt {

/// A way from two scans to a motion between them.
struct Contender {
  NamedDetector detector{};
  std::optional<NamedDescriptor> descriptor{};  ///< none: all pairs of keypoints are candidates
  ArenaMatcher matcher{ArenaMatcher::ransac};
};

/// Every combination that makes sense, our default (curvature, beta-grid, ransac) first: each detector with each
/// descriptor and matcher, and with the matchers that need no descriptor. Empty lists: all; names as in
/// any_features.hpp and ArenaMatcher, those that do not exist choose nothing.
[[nodiscard]] std::vector<Contender> contenders(const std::vector<std::string>& detectors,
                                                const std::vector<std::string>& descriptors,
                                                const std::vector<std::string>& matchers);

struct ArenaParams {
  std::size_t every{1};  ///< query every K-th scan
  PoseTolerance tolerance{};
  RevisitParams revisit{};
  ArenaMatcherParams matchers{};  ///< but for `match`, which the descriptor decides
  GlarotParams glarot{};
  double common_radius{0.5};  ///< m, of all regions for repeatability and precision
};

/// What descriptors of this name are compared by: the bound of each one's authors.
[[nodiscard]] MatchParams match_params_of(const AnyDescriptorParams& descriptor);

enum class ArenaProtocol : std::uint8_t { paper, revisit };
constexpr auto enum_names(ArenaProtocol /*tag*/) {
  return std::array{std::pair{ArenaProtocol::paper, std::string_view("paper")},
                    std::pair{ArenaProtocol::revisit, std::string_view("revisit")}};
}
inline constexpr std::array arena_protocols{ArenaProtocol::paper, ArenaProtocol::revisit};

/// The answer of one query.
struct ArenaAnswer {
  std::uint32_t inliers{0};       ///< of the match with most; 0: no match
  bool right_by_inliers{false};   ///< the pose of the match with most inliers (then the least residual) is right
  bool right_by_residual{false};  ///< the pose of the match with the least residual is right
  bool counts{true};              ///< the map can answer it
};

/// Precision and recall of the match with most inliers, accepted from `inliers` on.
struct ArenaPoint {
  std::uint32_t inliers{0};
  Rate precision{};
  Rate recall{};
};

struct ArenaProtocolResult {
  std::vector<ArenaAnswer> answers{};  ///< one per query
  Rate by_inliers{};
  Rate by_residual{};
  std::vector<ArenaPoint> curve{};  ///< from 3 inliers to 15
  double recall_at_95{0};           ///< largest recall on the curve with a precision of 0.95 or more
  Disagreements with_default{};     ///< by residual: first ours, second this one
};

/// CPU time of one thread.
struct ArenaTimes {
  double detect_us{0};    ///< a scan
  double describe_us{0};  ///< a scan
  double match_us{0};     ///< a pair of scans
};

struct ContenderResult {
  std::string detector{};
  std::string descriptor{};
  std::string matcher{};
  double keypoints{0};          ///< a scan
  Rate repeatability{};         ///< keypoints that the next scan has, too, of those whose place it shows
  double average_precision{0};  ///< of nearest descriptors in the next scan; 0 without a descriptor
  std::array<ArenaProtocolResult, arena_protocols.size()> protocols{};
  ArenaTimes times{};
};

/// How early GLAROT ranks a scan taken within correct_distance, whatever its heading.
struct ShortlistResult {
  std::string detector{};
  std::array<std::array<Rate, 3>, arena_protocols.size()> recall{};  ///< among the first 1, 10, 100
  double build_us{0};                                                ///< a scan, CPU
  double compare_us{0};                                              ///< a pair, CPU
};
inline constexpr std::array<std::size_t, 3> shortlist_lengths{1, 10, 100};

struct Arena {
  std::size_t queries{0};
  std::size_t answerable{0};
  std::size_t scans{0};
  std::vector<ContenderResult> contenders{};  ///< in order of the list; then our localizer by the beams themselves
  std::vector<ShortlistResult> shortlists{};  ///< one per detector
};

/// Runs all contenders over the log, which needs poses. The first one is what the others are compared with. The same
/// but for the times on any number of threads. O(contenders · queries · scans · cost of a match).
[[nodiscard]] Result<Arena> bench_arena(const ScanLog& log, const std::vector<Contender>& list,
                                        const ArenaParams& params, std::size_t threads, const Progress& progress = {});

}  // namespace flirt
