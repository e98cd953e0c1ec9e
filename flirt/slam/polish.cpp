#include "flirt/slam/polish.hpp"

#include "flirt/graph/optimize.hpp"
#include "flirt/registration/surface_alignment.hpp"
#include "flirt/registration/surface_points.hpp"
#include "flirt/slam/scan_overlap.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace flirt {
namespace {

/// The pair's terms as an edge: where its own optimum lies, and how well that is known.
PoseEdge pair_edge(const ScanPair& pair, const Pose2& a_from_b, const AlignmentTerms& terms, double range_sigma) {
  const Eigen::Matrix3d least = 1e-3 * static_cast<double>(terms.pairs) * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d information = terms.information + least;
  const Eigen::Vector3d step = -information.ldlt().solve(terms.gradient);
  return {pair.a, pair.b, stepped(a_from_b, step), terms.information / (range_sigma * range_sigma), EdgeKind::motion};
}

/// Points of each scan that have a normal, so that they can be drawn onto lines.
std::vector<double> surface_counts(std::span<const SurfacePoints> scans) {
  std::vector<double> counts;
  for (const SurfacePoints& points : scans) {
    double count = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      count += points.normal_x[i] != 0 || points.normal_y[i] != 0 ? 1 : 0;
    }
    counts.push_back(count);
  }
  return counts;
}

/// Edges of all pairs that see enough of each other, after those that were there before.
PolishSummary add_pair_edges(PoseGraph& joint, std::span<const ScanPair> pairs, std::span<const SurfacePoints> scans,
                             double width, double range_sigma) {
  constexpr double least_paired = 0.3;  // of the points must find a partner
  constexpr std::size_t fewest = 10;    // points
  const std::vector<double> counts = surface_counts(scans);
  PolishSummary summary{.fit = std::vector<double>(scans.size(), 0.0)};
  double squared = 0;
  double weight = 0;
  for (const ScanPair& pair : pairs) {
    const Pose2 a_from_b = inverse(joint.map_from_node[pair.a]) * joint.map_from_node[pair.b];
    const AlignmentTerms terms = alignment_terms(scans[pair.a], scans[pair.b], a_from_b, width);
    const double most = std::min(counts[pair.a], counts[pair.b]);
    if (terms.pairs < fewest || static_cast<double>(terms.pairs) < least_paired * most) { continue; }
    joint.edges.push_back(pair_edge(pair, a_from_b, terms, range_sigma));
    ++summary.pairs;
    squared += terms.squared_residuals;
    weight += terms.weight;
    for (const std::uint32_t node : {pair.a, pair.b}) {
      summary.fit[node] = std::max(summary.fit[node], std::min(1.0, terms.weight / most));
    }
  }
  summary.residual = weight > 0 ? std::sqrt(squared / weight) : 0;
  return summary;
}

}  // namespace

PolishSummary polish(PoseGraph& graph, std::span<const SurfacePoints> scans, const SlamParams& params) {
  constexpr double first_width = 0.12;
  constexpr double last_width = 0.03;
  PolishSummary summary;
  const std::vector<ScanPair> pairs = overlapping_pairs(graph.map_from_node, scans, params.polish_pairs);
  for (std::uint32_t round = 0; round < params.polish_rounds; ++round) {
    PoseGraph joint = graph;
    for (PoseEdge& edge : joint.edges) { edge.information *= params.polish_keep; }
    summary = add_pair_edges(joint, pairs, scans, round == 0 ? first_width : last_width, params.range_sigma);
    static_cast<void>(
        optimize(joint, {.iterations = 1, .trust_radius = undamped}));  // the terms hold no longer once the poses moved
    graph.map_from_node = joint.map_from_node;
  }
  return summary;
}

}  // namespace flirt
