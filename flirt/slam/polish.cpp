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
  constexpr double least_share = 0.3;  // of the points must find a partner
  PolishSummary summary;
  PoseGraph joint;
  joint.map_from_node = graph.map_from_node;
  const std::vector<ScanPair> pairs = overlapping_pairs(joint.map_from_node, params.polish_pairs);
  for (std::uint32_t round = 0; round < params.polish_rounds; ++round) {
    const double width = round == 0 ? first_width : last_width;
    joint.edges.clear();
    double squared = 0;
    double weight = 0;
    for (PoseEdge edge : graph.edges) {
      edge.information *= params.polish_keep;
      joint.edges.push_back(edge);
    }
    for (const ScanPair& pair : pairs) {
      const Pose2 a_from_b = inverse(joint.map_from_node[pair.a]) * joint.map_from_node[pair.b];
      const AlignmentTerms terms = alignment_terms(scans[pair.a].points, scans[pair.b].points, a_from_b, width);
      const double most = static_cast<double>(std::min(scans[pair.a].points.size(), scans[pair.b].points.size()));
      if (static_cast<double>(terms.pairs) < least_share * most || terms.pairs < 10) { continue; }
      joint.edges.push_back(pair_edge(pair, a_from_b, terms, params.range_sigma));
      squared += terms.squared_residuals;
      weight += terms.weight;
    }
    summary = {joint.edges.size(), weight > 0 ? std::sqrt(squared / weight) : 0};
    static_cast<void>(optimize(joint, {.iterations = 3}));
  }
  graph.map_from_node = joint.map_from_node;
  return summary;
}

}  // namespace flirt
