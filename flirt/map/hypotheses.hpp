// flirt/map/hypotheses.hpp: where a scan may have been taken: single matches, and the distinct places they agree on.
#pragma once

#include "flirt/core/pose2.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

/// One match of the query with one map scan: a sample of p(x | z, m) (P1 §3.1).
struct Hypothesis {
  Pose2 map_from_sensor{};  ///< pose of the query's sensor
  Eigen::Matrix3d covariance{
      Eigen::Matrix3d::Zero()};  ///< of (x, y, theta): m², m·rad, rad²; of the match alone, the map taken as exact
  std::uint32_t map_scan{0};     ///< the map scan that was matched
  std::uint32_t inliers{0};      ///< |E|, matches that agree
  double residual{0};            ///< m², mean truncated squared distance over all query keypoints
  double weight{0};              ///< of the sample: 1/residual, normalised to sum 1 over all hypotheses
  double score{0};               ///< how much of the query the match explains, in [0, 1]; see `score_from_residual`
};

/// Hypotheses that say the same place: a mode of p(x | z, m).
struct Place {
  std::uint32_t hypothesis{0};  ///< index of its best one, which stands for it
  std::uint32_t support{0};     ///< hypotheses (map scans) that say so
  std::uint32_t inliers{0};     ///< the most of any
  double weight{0};             ///< sum of the weights of its hypotheses; all places sum to 1
};

/// Which of two hypotheses is better (P1 §4.1).
enum class HypothesisOrder : std::uint8_t {
  corresp,   ///< more inliers, then smaller residual
  residual,  ///< smaller residual, then more inliers
};
constexpr auto enum_names(HypothesisOrder /*tag*/) {
  return std::array{std::pair{HypothesisOrder::corresp, std::string_view("corresp")},
                    std::pair{HypothesisOrder::residual, std::string_view("residual")}};
}

/// Sets the weights of samples of p(x | z, m): 1/residual, normalised to sum 1 (P1 §3.1). Residuals below 1e-6 m²
/// (a millimetre a keypoint) count as that, so that an exact match does not silence all others.
void set_weights(std::span<Hypothesis> hypotheses);

/// Best first; of equally good ones the lower map scan first.
void sort_hypotheses(std::span<Hypothesis> hypotheses, HypothesisOrder order);

/// 1 when every query keypoint lies on one of the map scan, 0 when none is within the inlier distance: the residual as
/// a share of what it would be then, √5.99 · inlier_distance being the radius of an inlier (m).
[[nodiscard]] double score_from_residual(double residual, double inlier_distance);

/// Groups sorted hypotheses into places: each one not yet taken founds a place and takes all others within
/// `max_distance` (m) and `max_heading` (rad). Places come in the order of their founders. Positions are
/// finite. O(hypotheses · places nearby).
[[nodiscard]] std::vector<Place> distinct_places(std::span<const Hypothesis> sorted, double max_distance,
                                                 double max_heading);

}  // namespace flirt
