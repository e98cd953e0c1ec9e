#include "flirt/registration/surface_alignment.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flirt {
namespace {

/// Adds w (JᵀJ, Jᵀr) of the residual r = n · (point − line), n in the frame of the robot.
struct Sums {
  double xx{0}, xy{0}, xt{0}, yy{0}, yt{0}, tt{0};
  double gx{0}, gy{0}, gt{0};
  double weight{0};
  double squared{0};
  std::size_t pairs{0};

  void add(double nx, double ny, double px, double py, double residual, double weighted) {
    const double nt = px * ny - py * nx;
    xx += weighted * nx * nx;
    xy += weighted * nx * ny;
    xt += weighted * nx * nt;
    yy += weighted * ny * ny;
    yt += weighted * ny * nt;
    tt += weighted * nt * nt;
    gx += weighted * nx * residual;
    gy += weighted * ny * residual;
    gt += weighted * nt * residual;
  }
  [[nodiscard]] AlignmentTerms terms() const {
    AlignmentTerms out;
    out.information << xx, xy, xt, xy, yy, yt, xt, yt, tt;
    out.gradient << gx, gy, gt;
    out.weight = weight;
    out.squared_residuals = squared;
    out.pairs = pairs;
    return out;
  }
};

double robust_weight(double squared, double width) {
  const double root = 1.0 / (1.0 + squared / (width * width));
  return root * root;
}

/// atan2 to 0.01 rad: enough to find a bin of bearings.
float rough_bearing(float x, float y) {
  const float ax = std::abs(x);
  const float ay = std::abs(y);
  const float ratio = std::min(ax, ay) / std::max(std::max(ax, ay), 1e-9F);
  float angle = ratio * (1.0584F - 0.273F * ratio);
  angle = ay > ax ? std::numbers::pi_v<float> / 2 - angle : angle;
  angle = x < 0 ? std::numbers::pi_v<float> - angle : angle;
  return y < 0 ? -angle : angle;
}

std::size_t bin_of(float bearing) {
  const auto bin = static_cast<int>((bearing + std::numbers::pi_v<float>)*(static_cast<float>(SurfacePoints::bins) /
                                                                           (2 * std::numbers::pi_v<float>)));
  return static_cast<std::size_t>(std::clamp(bin, 0, static_cast<int>(SurfacePoints::bins) - 1));
}

/// The nearest point of `reference` within reach whose normal is within 32° of the given one; its size when there is
/// none.
std::size_t nearest_alike(const SurfacePoints& reference, float x, float y, float normal_x, float normal_y) {
  constexpr int reach_bins = 1;
  constexpr std::size_t reach_points = 5;
  constexpr float reach = 0.2F;   // m
  constexpr float alike = 0.85F;  // cosine
  const auto ray_x = x - static_cast<float>(reference.origin.x);
  const auto ray_y = y - static_cast<float>(reference.origin.y);
  const auto bin = static_cast<int>(bin_of(rough_bearing(ray_x, ray_y)));
  constexpr auto bins = static_cast<int>(SurfacePoints::bins);
  const auto low = static_cast<std::size_t>(std::max(0, bin - reach_bins));
  const auto high = static_cast<std::size_t>(std::min(bins, bin + reach_bins + 1));
  float best = reach * reach;
  std::size_t nearest = reference.size();
  const auto look_at = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const float dx = x - reference.x[i];
      const float dy = y - reference.y[i];
      const float squared = dx * dx + dy * dy;
      if (squared < best && normal_x * reference.normal_x[i] + normal_y * reference.normal_y[i] > alike) {
        best = squared;
        nearest = i;
      }
    }
  };
  const auto begin_of = [&](std::size_t a_bin) {
    const std::size_t first = reference.first_after[a_bin];
    return first > reach_points ? first - reach_points : 0;
  };
  const auto end_of = [&](std::size_t a_bin) {
    return std::min<std::size_t>(reference.size(), reference.first_after[a_bin] + reach_points);
  };
  look_at(begin_of(low), end_of(high));
  // Bearings of ±π are one direction: near it the other end of the list has neighbours, too.
  if (bin < reach_bins + 1) {
    look_at(std::max(end_of(high), begin_of(static_cast<std::size_t>(bins + bin - reach_bins))), reference.size());
  }
  if (bin >= bins - reach_bins - 1) {
    look_at(0, std::min(begin_of(low), end_of(static_cast<std::size_t>(bin + reach_bins + 1 - bins))));
  }
  return nearest;
}

}  // namespace

AlignmentTerms& AlignmentTerms::operator+=(const AlignmentTerms& other) {
  information += other.information;
  gradient += other.gradient;
  weight += other.weight;
  squared_residuals += other.squared_residuals;
  pairs += other.pairs;
  return *this;
}

AlignmentTerms alignment_terms(const LocalMap& map, const SurfacePoints& points, const Pose2& map_from_robot,
                               double width) {
  const double c = std::cos(map_from_robot.theta);
  const double s = std::sin(map_from_robot.theta);
  Sums sums;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double px = points.x[i];
    const double py = points.y[i];
    const Point2 at{map_from_robot.x + c * px - s * py, map_from_robot.y + s * px + c * py};
    const LinePiece* line = map.line_at(at);
    if (line == nullptr) { continue; }
    const double dx = at.x - line->x;
    const double dy = at.y - line->y;
    const double across = dx * line->normal_x + dy * line->normal_y;
    const double along = dy * line->normal_x - dx * line->normal_y;
    const double squared = across * across + line->roundness * along * along;
    const double w = robust_weight(squared, width);
    const double nx = c * line->normal_x + s * line->normal_y;
    const double ny = c * line->normal_y - s * line->normal_x;
    sums.add(nx, ny, px, py, across, w);
    if (line->roundness > 0) { sums.add(-ny, nx, px, py, along, w * line->roundness); }
    sums.weight += w;
    sums.squared += w * squared;
    ++sums.pairs;
  }
  return sums.terms();
}

AlignmentTerms alignment_terms(const SurfacePoints& reference, const SurfacePoints& query,
                               const Pose2& reference_from_query, double width) {
  const auto c = static_cast<float>(std::cos(reference_from_query.theta));
  const auto s = static_cast<float>(std::sin(reference_from_query.theta));
  const auto x0 = static_cast<float>(reference_from_query.x);
  const auto y0 = static_cast<float>(reference_from_query.y);
  Sums sums;
  for (std::size_t i = 0; i < query.size(); ++i) {
    if (query.normal_x[i] == 0 && query.normal_y[i] == 0) { continue; }
    const float x = x0 + c * query.x[i] - s * query.y[i];
    const float y = y0 + s * query.x[i] + c * query.y[i];
    const float normal_x = c * query.normal_x[i] - s * query.normal_y[i];
    const float normal_y = s * query.normal_x[i] + c * query.normal_y[i];
    const std::size_t at = nearest_alike(reference, x, y, normal_x, normal_y);
    if (at == reference.size()) { continue; }
    const float line_x = reference.normal_x[at];
    const float line_y = reference.normal_y[at];
    const double residual = (x - reference.x[at]) * line_x + (y - reference.y[at]) * line_y;
    const double w = robust_weight(residual * residual, width);
    sums.add(c * line_x + s * line_y, c * line_y - s * line_x, query.x[i], query.y[i], residual, w);
    sums.weight += w;
    sums.squared += w * residual * residual;
    ++sums.pairs;
  }
  return sums.terms();
}

namespace {

/// Newton steps on the terms that `terms_at(pose, width)` gives, the width shrinking.
template <class TermsAt>
AlignedPose aligned(const TermsAt& terms_at, const Pose2& start, const AlignmentPrior& prior,
                    const AlignParams& params) {
  constexpr double shrink = 0.6;
  AlignedPose aligned{start, {}};
  double width = params.start_width;
  for (int i = 0; i < params.iterations; ++i) {
    aligned.terms = terms_at(aligned.map_from_robot, width);
    const Pose2 back = inverse(aligned.map_from_robot) * prior.map_from_robot;
    const Eigen::Vector3d from_prior(-back.x, -back.y, -back.theta);
    const Eigen::Matrix3d information = aligned.terms.information + prior.information;
    const Eigen::Vector3d gradient = aligned.terms.gradient + prior.information * from_prior;
    const Eigen::Vector3d step = -information.ldlt().solve(gradient);
    aligned.map_from_robot = stepped(aligned.map_from_robot, step);
    if (width <= params.end_width && step.head<2>().norm() < 5e-4 && std::abs(step.z()) < 2e-4) { break; }
    width = std::max(params.end_width, shrink * width);
  }
  return aligned;
}

}  // namespace

AlignedPose align_to_map(const LocalMap& map, std::span<const SurfacePoints> scans, const Pose2& start,
                         const AlignmentPrior& prior, const AlignParams& params) {
  const auto terms_at = [&](const Pose2& map_from_robot, double width) {
    AlignmentTerms terms;
    for (const SurfacePoints& points : scans) { terms += alignment_terms(map, points, map_from_robot, width); }
    return terms;
  };
  return aligned(terms_at, start, prior, params);
}

AlignedPose align_to_scan(const SurfacePoints& reference, const SurfacePoints& query, const Pose2& start,
                          const AlignmentPrior& prior, const AlignParams& params) {
  const auto terms_at = [&](const Pose2& reference_from_query, double width) {
    return alignment_terms(reference, query, reference_from_query, width);
  };
  return aligned(terms_at, start, prior, params);
}

}  // namespace flirt
