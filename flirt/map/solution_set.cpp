#include "flirt/map/solution_set.hpp"

#include "flirt/core/parallel.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flirt {
namespace {

/// The covariance of a pose seen from `a` as that of the same pose seen from the map: positions turn, headings don't.
Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance_in_a, const Pose2& map_from_a) {
  const double c = std::cos(map_from_a.theta);
  const double s = std::sin(map_from_a.theta);
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() << c, -s, s, c;
  return rotation * covariance_in_a * rotation.transpose();
}

DescriptorRows all_descriptors(const PlaceMap& map) {
  return {.rows = map.columns().descriptor_rows.data(),
          .roots = map.columns().descriptor_roots.data(),
          .count = static_cast<std::uint32_t>(map.feature_count()),
          .dimension = map.descriptor_dimension(),
          .stride = map.descriptor_stride()};
}

/// What one thread finds in its share of the map.
struct Finds {
  std::vector<Hypothesis> hypotheses;
  bool saw_map_scan{false};
  bool saw_candidate{false};
};

void match_map_scan(const PlaceMap& map, std::size_t map_scan, const FeatureColumns& features, PairMatcher& matcher,
                    const RansacParams& params, Finds& finds) {
  finds.saw_map_scan = true;
  const std::optional<PairAlignment> found = matcher.align(features);
  finds.saw_candidate = finds.saw_candidate || !matcher.candidates().empty();
  if (!found) { return; }
  const Pose2& map_from_reference = map.map_from_sensor(map_scan);
  finds.hypotheses.push_back({.map_from_sensor = map_from_reference * found->reference_from_query,
                              .covariance = turned(matcher.covariance(), map_from_reference),
                              .map_scan = static_cast<std::uint32_t>(map_scan),
                              .inliers = found->inliers,
                              .residual = found->residual,
                              .score = score_from_residual(found->residual, params.inlier_distance)});
}

/// All finds in one. The order is that of the threads: what follows must not rely on it.
Finds merged(std::vector<Finds> parts) {
  Finds all = std::move(parts.front());
  for (std::size_t i = 1; i < parts.size(); ++i) {
    all.hypotheses.insert(all.hypotheses.end(), parts[i].hypotheses.begin(), parts[i].hypotheses.end());
    all.saw_map_scan = all.saw_map_scan || parts[i].saw_map_scan;
    all.saw_candidate = all.saw_candidate || parts[i].saw_candidate;
  }
  return all;
}

Reason why_lost(const Finds& finds, std::size_t keypoints, std::uint32_t min_inliers) {
  if (!finds.saw_map_scan) { return Reason::empty_map; }
  if (keypoints == 0) { return Reason::no_keypoints; }
  if (keypoints < min_inliers) { return Reason::few_keypoints; }
  return finds.saw_candidate ? Reason::few_inliers : Reason::no_match;
}

double score_of(const SolutionSet& result, std::size_t place) {
  return place < result.places.size() ? result.hypotheses[result.places[place].hypothesis].score : 0.0;
}

/// By how much the first place explains the query better than the second, as a share of the first, in [0, 1].
double margin(const SolutionSet& result) {
  const double first = score_of(result, 0);
  return first > 0 ? std::max(0.0, 1.0 - score_of(result, 1) / first) : 0.0;
}

/// In [0, 1): 1/2 when `half` map scans agree.
double agreement(std::uint32_t support, double half) {
  return support / (support + half);
}

void judge(SolutionSet& result, const SolutionSetParams& params) {
  const double lead = margin(result);
  result.confidence = lead * agreement(result.places.front().support, params.half_support);
  if (result.confidence >= params.min_confidence) {
    result.verdict = Verdict::unique;
    result.reason = Reason::clear_winner;
  } else {
    result.verdict = Verdict::ambiguous;
    result.reason = lead < params.min_confidence ? Reason::second_place_too_close : Reason::little_support;
  }
}

}  // namespace

SolutionSetFinder::SolutionSetFinder(PlaceMap map, const SolutionSetParams& params, std::size_t threads)
    : map_(std::move(map)),
      params_(params),
      matchers_(thread_count(threads), PairMatcher(params.match, params.ransac)) {}

void SolutionSetFinder::sketch_map() {
  const bool by_nearest = params_.match.strategy == MatchStrategy::nearest;
  const bool useful = by_nearest && params_.match.distance == Distance::chi_square && map_.feature_count() > 0;
  if (!useful || !sketches_.empty()) { return; }
  const DescriptorRows rows = all_descriptors(map_);
  sketch_axes_ = fit_sketch_axes(rows);
  sketches_.resize(std::size_t{rows.count} * sketch_size);
  constexpr std::size_t block = 1024;
  parallel_for((rows.count + block - 1) / block, matchers_.size(), [&](std::size_t i, std::size_t /*thread*/) {
    const std::size_t first = i * block;
    const std::size_t last = std::min<std::size_t>(first + block, rows.count);
    sketch_rows(sketch_axes_, rows, first, last,
                std::span(sketches_).subspan(first * sketch_size, (last - first) * sketch_size));
  });
}

FeatureColumns SolutionSetFinder::map_features(std::size_t map_scan) const {
  FeatureColumns features = map_.features(map_scan);
  if (!sketches_.empty()) {
    features.descriptors.sketches = sketches_.data() + map_.columns().feature_begin[map_scan] * sketch_size;
  }
  return features;
}

SolutionSet SolutionSetFinder::find(const Features& features, ScanInterval excluded) {
  sketch_map();
  std::vector<std::uint32_t> map_scans;
  map_scans.reserve(map_.size());
  for (std::uint32_t scan = 0; scan < map_.size(); ++scan) {
    if (!excluded.contains(scan)) { map_scans.push_back(scan); }
  }
  return find_among(features, map_scans);
}

SolutionSet SolutionSetFinder::find_among(const Features& features, std::span<const std::uint32_t> map_scans) {
  const KeypointTable table = table_of(features.keypoints);
  DescriptorRows rows = rows_of(features.descriptors);
  std::vector<std::int16_t> sketches;
  if (!sketches_.empty() && rows.count > 0) {
    sketches = sketches_of(sketch_axes_, rows);
    rows.sketches = sketches.data();
  }
  for (PairMatcher& matcher : matchers_) { matcher.set_query({table.columns(), rows}); }

  std::vector<Finds> parts(matchers_.size());
  constexpr std::size_t grain = 64;
  for (Finds& finds : parts) { finds.hypotheses.reserve(map_scans.size() / parts.size() + grain); }
  parallel_for(
      map_scans.size(), matchers_.size(),
      [&](std::size_t i, std::size_t thread) {
        match_map_scan(map_, map_scans[i], map_features(map_scans[i]), matchers_[thread], params_.ransac,
                       parts[thread]);
      },
      {}, grain);
  Finds finds = merged(std::move(parts));

  SolutionSet result;
  result.hypotheses = std::move(finds.hypotheses);
  sort_hypotheses(result.hypotheses, params_.order);
  set_weights(result.hypotheses);
  result.places = distinct_places(result.hypotheses, params_.distinct_distance, params_.distinct_heading);
  if (result.places.empty()) {
    result.reason = why_lost(finds, features.keypoints.size(), params_.ransac.min_inliers);
  } else {
    judge(result, params_);
  }
  return result;
}

}  // namespace flirt
