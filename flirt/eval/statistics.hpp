// flirt/eval/statistics.hpp: rates with intervals, and precision-recall sweeps over a confidence.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

struct Interval {
  double low{0};
  double high{0};
};

/// A share with its Wilson 95 % score interval; 0 of 0 is rate 0 with the interval [0, 1].
struct Rate {
  std::size_t hits{0};
  std::size_t total{0};

  [[nodiscard]] double value() const {
    return total == 0 ? 0.0 : static_cast<double>(hits) / static_cast<double>(total);
  }
  [[nodiscard]] Interval wilson() const;
};

/// Two methods on the same cases, counted where they disagree.
struct Disagreements {
  std::size_t only_first{0};   ///< cases that only the first got right
  std::size_t only_second{0};  ///< cases that only the second got right

  /// Two-sided p-value of McNemar's exact test (1947): were both equally good, each disagreement would be a toss of a
  /// coin. 1 without disagreements. It takes the cases as independent; neighbouring scans are less than that.
  [[nodiscard]] double p_value() const;
};

/// first[i] and second[i] are 1 where the method got case i right, 0 where not; NaN: the case does not count.
[[nodiscard]] Disagreements disagreements(std::span<const double> first, std::span<const double> second);

/// One query's answer, as a sweep over the confidence sees it.
struct ScoredAnswer {
  double confidence{0};
  bool answered{false};    ///< false: no pose was given; `confidence` and `correct` mean nothing
  bool correct{false};     ///< the pose is right, whoever asked
  bool answerable{false};  ///< counts in the denominator of recall
};

struct PrecisionRecallPoint {
  double confidence{0};  ///< accepted: answers of this confidence or more
  double precision{0};   ///< correct / accepted
  double recall{0};      ///< correct and answerable / answerable
};

/// Precision and recall at every distinct confidence, from the highest down. A correct answer to a query that is not
/// answerable is neither a false positive nor a gain in recall: it counts as correct in the precision only. O(n log n).
[[nodiscard]] std::vector<PrecisionRecallPoint> precision_recall(std::span<const ScoredAnswer> answers);

/// Largest recall among the points with at least this precision; 0 when there is none.
[[nodiscard]] double recall_at_precision(std::span<const PrecisionRecallPoint> curve, double precision);

/// Area under the curve: Σ (recall_k − recall_(k−1)) · precision_k.
[[nodiscard]] double average_precision(std::span<const PrecisionRecallPoint> curve);

/// Answers whose confidence lies in [low, high): how often they were right.
struct ReliabilityBin {
  double low{0};
  double high{0};
  double mean_confidence{0};  ///< 0 for an empty bin
  Rate right{};
};

/// The answers given, in bins that end at `edges` (rising, the last one 1 or more): a confidence is calibrated when the
/// rate of each bin is its mean confidence.
[[nodiscard]] std::vector<ReliabilityBin> reliability(std::span<const ScoredAnswer> answers,
                                                      std::span<const double> edges);

/// The q-quantile (0..1) by linear interpolation; 0 for no values. The order of `values` does not matter.
[[nodiscard]] double quantile(std::vector<double> values, double q);

}  // namespace flirt
