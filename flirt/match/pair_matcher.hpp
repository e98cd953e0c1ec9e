// flirt/match/pair_matcher.hpp: candidates and alignment of one scan against many.
#pragma once

#include "flirt/match/columns.hpp"
#include "flirt/match/match.hpp"
#include "flirt/match/ransac.hpp"

#include <optional>
#include <span>

namespace flirt {

/// Matches one query with many references, read-only columns both; allocates nothing once it has seen its largest pair.
/// Not shared between threads: one matcher each. Results depend on the two scans and the parameters alone.
class PairMatcher {
 public:
  explicit PairMatcher(const MatchParams& match_params = {}, const RansacParams& ransac_params = {})
      : match_params_(match_params), matcher_(match_params), ransac_(ransac_params) {}

  /// The columns must outlive the calls that follow.
  void set_query(const FeatureColumns& query) {
    query_ = query;
    matcher_.set_query(query.descriptors);
    ransac_.set_query(query.keypoints);
  }

  /// Candidates, then the best motion. O(query · reference · stride) and O(hypotheses · query · reference).
  [[nodiscard]] std::optional<PairAlignment> align(const FeatureColumns& reference) {
    reference_ = reference;
    return ransac_.align(reference.keypoints, matcher_.candidates(reference.descriptors));
  }

  /// Of the last call of align, as are the next two.
  [[nodiscard]] std::span<const Match> candidates() const { return matcher_.last_candidates(); }
  [[nodiscard]] std::span<const IndexPair> inliers() const { return ransac_.inliers(); }
  /// Covariance of (x, y, theta) of the last alignment found.
  [[nodiscard]] Eigen::Matrix3d covariance() const { return ransac_.covariance(); }
  /// The lists and the covariance that belong to `found`, the result of the last call of align.
  [[nodiscard]] Alignment details(const PairAlignment& found) const {
    return {found.reference_from_query, ransac_.covariance(),
            with_distances(ransac_.inliers(), candidates(), match_params_.distance, query_.descriptors,
                           reference_.descriptors),
            found.residual};
  }

 private:
  MatchParams match_params_;
  Matcher matcher_;
  Ransac ransac_;
  FeatureColumns query_{};
  FeatureColumns reference_{};
};

}  // namespace flirt
