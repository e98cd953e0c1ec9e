#include "flirt/slam/polish.hpp"

#include "flirt/graph/optimize.hpp"
#include "flirt/registration/surface_alignment.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace flirt {
namespace {

constexpr double reach = 3;             // m between the robots of a pair
constexpr double heading_metres = 1.5;  // m that a radian between headings counts as

double apart(const Pose2& a, const Pose2& b) {
  return distance(a, b) + heading_metres * heading_difference(a, b);
}

/// Nodes by squares of `reach`.
class NodesNearby {
 public:
  explicit NodesNearby(std::span<const Pose2> map_from_node) {
    for (std::uint32_t i = 0; i < map_from_node.size(); ++i) {
      cells_[key(square(map_from_node[i].x), square(map_from_node[i].y))].push_back(i);
    }
  }
  template <class Visit>
  void for_each(const Pose2& pose, const Visit& visit) const {
    for (std::int32_t dy = -1; dy <= 1; ++dy) {
      for (std::int32_t dx = -1; dx <= 1; ++dx) {
        const auto found = cells_.find(key(square(pose.x) + dx, square(pose.y) + dy));
        if (found == cells_.end()) { continue; }
        for (const std::uint32_t node : found->second) { visit(node); }
      }
    }
  }

 private:
  static std::int32_t square(double v) { return static_cast<std::int32_t>(std::floor(v / reach)); }
  static std::uint64_t key(std::int32_t x, std::int32_t y) {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32U) | static_cast<std::uint32_t>(y);
  }
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_{};
};

/// The pair's terms as an edge: where its own optimum lies, and how well that is known.
PoseEdge pair_edge(const ScanPair& pair, const Pose2& a_from_b, const AlignmentTerms& terms, double range_sigma) {
  const Eigen::Matrix3d least = 1e-3 * static_cast<double>(terms.pairs) * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d information = terms.information + least;
  const Eigen::Vector3d step = -information.ldlt().solve(terms.gradient);
  return {pair.a, pair.b, stepped(a_from_b, step), terms.information / (range_sigma * range_sigma), EdgeKind::motion};
}

/// Points of each scan that have a normal, so that they can be drawn onto lines.
std::vector<double> surface_counts(std::span<const SlamScan> scans) {
  std::vector<double> counts;
  for (const SlamScan& scan : scans) {
    double count = 0;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      count += scan.points.normal_x[i] != 0 || scan.points.normal_y[i] != 0 ? 1 : 0;
    }
    counts.push_back(count);
  }
  return counts;
}

/// Edges of all pairs that see enough of each other, after those that were there before.
PolishSummary add_pair_edges(PoseGraph& joint, std::span<const ScanPair> pairs, std::span<const SlamScan> scans,
                             double width, double range_sigma) {
  constexpr double least_share = 0.3;  // of the points must find a partner
  constexpr std::size_t fewest = 10;   // points
  const std::vector<double> counts = surface_counts(scans);
  PolishSummary summary{.fit = std::vector<double>(scans.size(), 0.0)};
  double squared = 0;
  double weight = 0;
  for (const ScanPair& pair : pairs) {
    const Pose2 a_from_b = inverse(joint.map_from_node[pair.a]) * joint.map_from_node[pair.b];
    const AlignmentTerms terms = alignment_terms(scans[pair.a].points, scans[pair.b].points, a_from_b, width);
    const double most = std::min(counts[pair.a], counts[pair.b]);
    if (terms.pairs < fewest || static_cast<double>(terms.pairs) < least_share * most) { continue; }
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

std::vector<ScanPair> overlapping_pairs(std::span<const Pose2> map_from_node, std::size_t most) {
  constexpr std::uint32_t neighbours_in_time = 3;
  constexpr std::uint32_t same_visit = 4;  // scans; of those so near in time only one becomes a partner
  const NodesNearby nearby(map_from_node);
  std::vector<ScanPair> pairs;
  std::vector<std::uint32_t> near;
  for (std::uint32_t b = 0; b < map_from_node.size(); ++b) {
    for (std::uint32_t a = b > neighbours_in_time ? b - neighbours_in_time : 0; a < b; ++a) { pairs.push_back({a, b}); }
    near.clear();
    nearby.for_each(map_from_node[b], [&](std::uint32_t a) {
      if (a + neighbours_in_time < b && apart(map_from_node[a], map_from_node[b]) < reach) { near.push_back(a); }
    });
    std::ranges::sort(near, {},
                      [&](std::uint32_t a) { return std::pair(apart(map_from_node[a], map_from_node[b]), a); });
    std::vector<std::uint32_t> taken;
    for (const std::uint32_t a : near) {
      if (taken.size() == most) { break; }
      const bool known = std::ranges::any_of(
          taken, [&](std::uint32_t other) { return (a > other ? a - other : other - a) < same_visit; });
      if (known) { continue; }
      taken.push_back(a);
      pairs.push_back({a, b});
    }
  }
  return pairs;
}

PolishSummary polish(PoseGraph& graph, std::span<const SlamScan> scans, const SlamParams& params) {
  constexpr double first_width = 0.12;
  constexpr double last_width = 0.05;
  PolishSummary summary;
  const std::vector<ScanPair> pairs = overlapping_pairs(graph.map_from_node, params.polish_pairs);
  for (std::uint32_t round = 0; round < params.polish_rounds; ++round) {
    PoseGraph joint = graph;
    for (PoseEdge& edge : joint.edges) { edge.information *= params.polish_keep; }
    summary = add_pair_edges(joint, pairs, scans, round == 0 ? first_width : last_width, params.range_sigma);
    static_cast<void>(optimize(joint, {.iterations = 3}));
    graph.map_from_node = joint.map_from_node;
  }
  return summary;
}

}  // namespace flirt
