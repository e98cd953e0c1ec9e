#include "flirt/slam/repair.hpp"

#include "flirt/registration/local_map.hpp"
#include "flirt/registration/surface_alignment.hpp"
#include "flirt/registration/window_search.hpp"
#include "flirt/slam/hold.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace flirt {
namespace {

struct Better {
  Pose2 map_from_robot{};
  Eigen::Matrix3d information{Eigen::Matrix3d::Zero()};
};

/// Other scans near a node, nearest first.
std::vector<std::uint32_t> around(std::span<const Pose2> map_from_node, std::uint32_t node) {
  constexpr double reach = 4;  // m
  constexpr std::size_t most = 20;
  std::vector<std::pair<double, std::uint32_t>> near;
  for (std::uint32_t other = 0; other < map_from_node.size(); ++other) {
    const double apart = distance(map_from_node[node], map_from_node[other]);
    if (other != node && apart < reach) { near.emplace_back(apart, other); }
  }
  std::ranges::sort(near);
  near.resize(std::min(most, near.size()));
  std::vector<std::uint32_t> nodes;
  nodes.reserve(near.size());
  for (const auto& [apart, other] : near) { nodes.push_back(other); }
  return nodes;
}

/// A local map of some scans, changed to that of others by those that differ.
class RollingMap {
 public:
  const LocalMap& of(std::span<const std::uint32_t> nodes, std::span<const SlamScan> scans,
                     std::span<const Pose2> map_from_node) {
    std::erase_if(placed_, [&](const Placed& placed) {
      const bool stays = placed.pose == map_from_node[placed.node] && std::ranges::count(nodes, placed.node) != 0;
      if (!stays) { map_.remove(scans[placed.node].points, placed.pose); }
      return !stays;
    });
    for (const std::uint32_t node : nodes) {
      if (std::ranges::count(placed_, node, &Placed::node) != 0) { continue; }
      map_.add(scans[node].points, map_from_node[node]);
      placed_.push_back({node, map_from_node[node]});
    }
    return map_;
  }

 private:
  struct Placed {
    std::uint32_t node;
    Pose2 pose;
  };
  LocalMap map_{};
  std::vector<Placed> placed_{};
};

std::optional<Better> better_pose(const LocalMap& map, const SurfacePoints& points, const Pose2& now,
                                  const SlamParams& params) {
  const std::span<const SurfacePoints> scan(&points, 1);
  const SearchWindow window{.map_from_robot = now, .half_extent = 0.6, .half_turn = radians_from_degrees(20)};
  std::optional<Better> best;
  double best_score = std::max(score_of(map.agreement(scan, now)) + params.repair_gain, params.usable_score);
  for (const WindowPose& candidate : search_window(map, scan, window)) {
    const AlignmentPrior stay{candidate.map_from_robot, Eigen::Vector3d(2, 2, 2).asDiagonal()};
    const AlignedPose aligned = align_to_map(map, scan, candidate.map_from_robot, stay);
    const double score = score_of(map.agreement(scan, aligned.map_from_robot));
    if (score < best_score) { continue; }
    best_score = score;
    best = Better{aligned.map_from_robot, aligned.terms.information};
  }
  return best;
}

void replace_edges(PoseGraph& graph, std::uint32_t node, std::span<const std::uint32_t> nearest, const Better& better,
                   const SlamParams& params) {
  std::erase_if(graph.edges, [&](const PoseEdge& edge) { return edge.a == node || edge.b == node; });
  const Eigen::Matrix3d information =
      edge_information(better.information, params.range_sigma, Eigen::Matrix3d::Identity()) /
      static_cast<double>(nearest.size());
  for (const std::uint32_t other : nearest) {
    graph.edges.push_back(
        {other, node, inverse(graph.map_from_node[other]) * better.map_from_robot, information, EdgeKind::motion});
  }
}

}  // namespace

std::vector<std::uint32_t> repair(PoseGraph& graph, std::span<const SlamScan> scans,
                                  std::span<const std::uint32_t> suspects, const SlamParams& params) {
  constexpr std::size_t edges = 3;
  std::vector<std::uint32_t> moved;
  RollingMap rolling;
  for (const std::uint32_t node : suspects) {
    if (node == 0) { continue; }  // the frame of the map
    const std::vector<std::uint32_t> near = around(graph.map_from_node, node);
    if (near.size() < edges) { continue; }
    const LocalMap& map = rolling.of(near, scans, graph.map_from_node);
    const auto better = better_pose(map, scans[node].points, graph.map_from_node[node], params);
    if (!better) { continue; }
    // In a bare corridor another place along it may look better by chance.
    const SurfacePoints& points = scans[node].points;
    if (!holds(hold_of(std::span(&points, 1), map, better->map_from_robot), params)) { continue; }
    replace_edges(graph, node, std::span(near).first(edges), *better, params);
    graph.map_from_node[node] = better->map_from_robot;
    moved.push_back(node);
  }
  return moved;
}

}  // namespace flirt
