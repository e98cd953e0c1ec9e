#include "flirt/eval/statistics.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <cmath>

namespace flirt {
Interval Rate::wilson() const {
  if (total == 0) { return {0, 1}; }
  constexpr double z = 1.959963984540054;
  const auto n = static_cast<double>(total);
  const double p = value();
  const double centre = (p + z * z / (2 * n)) / (1 + z * z / n);
  const double half = z / (1 + z * z / n) * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

Disagreements disagreements(std::span<const double> first, std::span<const double> second) {
  FLIRT_ASSERT(first.size() == second.size());
  Disagreements result;
  for (std::size_t i = 0; i < first.size(); ++i) {
    result.only_first += first[i] > second[i] ? 1 : 0;
    result.only_second += second[i] > first[i] ? 1 : 0;
  }
  return result;
}

double Disagreements::p_value() const {
  const std::size_t tosses = only_first + only_second;
  const auto n = static_cast<double>(tosses);
  double tail = 0;  // P(at most the smaller count of heads), by log binomial coefficients: 2⁻ⁿ alone may underflow
  for (std::size_t k = 0; k <= std::min(only_first, only_second); ++k) {
    const auto heads = static_cast<double>(k);
    tail += std::exp(std::lgamma(n + 1) - std::lgamma(heads + 1) - std::lgamma(n - heads + 1) - n * std::log(2.0));
  }
  return std::min(1.0, 2 * tail);
}

std::vector<PrecisionRecallPoint> precision_recall(std::span<const ScoredAnswer> answers) {
  std::vector<ScoredAnswer> ranked;
  std::size_t answerable = 0;
  for (const ScoredAnswer& answer : answers) {
    answerable += answer.answerable ? 1 : 0;
    if (answer.answered) { ranked.push_back(answer); }
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const ScoredAnswer& a, const ScoredAnswer& b) { return a.confidence > b.confidence; });

  std::vector<PrecisionRecallPoint> curve;
  std::size_t correct = 0;
  std::size_t found = 0;
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    correct += ranked[i].correct ? 1 : 0;
    found += ranked[i].correct && ranked[i].answerable ? 1 : 0;
    const bool last_of_ties = i + 1 == ranked.size() || ranked[i + 1].confidence < ranked[i].confidence;
    if (!last_of_ties) { continue; }
    curve.push_back({ranked[i].confidence, Rate{correct, i + 1}.value(), Rate{found, answerable}.value()});
  }
  return curve;
}

double recall_at_precision(std::span<const PrecisionRecallPoint> curve, double precision) {
  double best = 0;
  for (const PrecisionRecallPoint& point : curve) {
    if (point.precision >= precision) { best = std::max(best, point.recall); }
  }
  return best;
}

double average_precision(std::span<const PrecisionRecallPoint> curve) {
  double area = 0;
  double previous_recall = 0;
  for (const PrecisionRecallPoint& point : curve) {
    area += (point.recall - previous_recall) * point.precision;
    previous_recall = point.recall;
  }
  return area;
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) { return 0; }
  std::sort(values.begin(), values.end());
  const double position = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

std::vector<ReliabilityBin> reliability(std::span<const ScoredAnswer> answers, std::span<const double> edges) {
  std::vector<ReliabilityBin> bins;
  double low = 0;
  for (const double high : edges) {
    ReliabilityBin bin{.low = low, .high = high};
    double sum = 0;
    for (const ScoredAnswer& answer : answers) {
      if (!answer.answered || answer.confidence < low || answer.confidence >= high) { continue; }
      ++bin.right.total;
      bin.right.hits += answer.correct ? 1 : 0;
      sum += answer.confidence;
    }
    if (bin.right.total > 0) { bin.mean_confidence = sum / static_cast<double>(bin.right.total); }
    bins.push_back(bin);
    low = high;
  }
  return bins;
}

}  // namespace flirt
