// tests/graph/graphs.hpp: pose graphs with known truth.
#pragma once

#include "flirt/core/rng.hpp"
#include "flirt/graph/pose_graph.hpp"
#include "flirt/graph/spanning_tree.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace flirt {

struct Noise {
  double position{0};  ///< m
  double heading{0};   ///< rad
};

/// inverse(truth a) * truth b with noise; its information is that of the noise, or of 1 cm and 0.01 rad without.
inline PoseEdge measured(const std::vector<Pose2>& truth, std::uint32_t a, std::uint32_t b, EdgeKind kind, Noise noise,
                         Rng& rng) {
  const Pose2 error{rng.normal(0, noise.position), rng.normal(0, noise.position), rng.normal(0, noise.heading)};
  const double position = noise.position > 0 ? noise.position : 0.01;
  const double heading = noise.heading > 0 ? noise.heading : 0.01;
  PoseEdge edge{.a = a, .b = b, .a_from_b = inverse(truth[a]) * truth[b] * error, .kind = kind};
  edge.information =
      Eigen::Vector3d(1 / (position * position), 1 / (position * position), 1 / (heading * heading)).asDiagonal();
  return edge;
}

struct KnownGraph {
  std::vector<Pose2> truth{};
  PoseGraph graph{};  ///< starts at the chained motion
};

/// Rounds along a rectangle of 20 m × 10 m in steps of 0.5 m, each round 0.2 m beside the last; every fifth pose closes
/// a loop with the round before.
inline KnownGraph rounds(std::uint32_t count, Noise noise, std::uint64_t seed) {
  constexpr std::uint32_t per_round = 120;
  KnownGraph known;
  for (std::uint32_t i = 0; i < count * per_round; ++i) {
    const double s = 0.5 * (i % per_round);
    const double beside = 0.2 * (i / per_round);
    const double pi = std::numbers::pi;
    if (s < 20) {
      known.truth.push_back({s, beside, 0});
    } else if (s < 30) {
      known.truth.push_back({20 - beside, s - 20, pi / 2});
    } else if (s < 50) {
      known.truth.push_back({50 - s, 10 - beside, pi});
    } else {
      known.truth.push_back({beside, 60 - s, -pi / 2});
    }
  }
  known.graph.map_from_node = known.truth;
  Rng rng(seed);
  for (std::uint32_t i = 0; i + 1 < known.truth.size(); ++i) {
    known.graph.edges.push_back(measured(known.truth, i, i + 1, EdgeKind::motion, noise, rng));
  }
  for (std::uint32_t i = per_round; i < known.truth.size(); i += 5) {
    known.graph.edges.push_back(measured(known.truth, i - per_round, i, EdgeKind::loop, noise, rng));
  }
  chain_motion(known.graph);
  return known;
}

/// A circle of `count` nodes, closed once.
inline KnownGraph circle(std::uint32_t count, double radius) {
  KnownGraph known;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    known.truth.push_back({radius * std::sin(angle), radius * (1 - std::cos(angle)), wrap_angle(angle)});
  }
  known.graph.map_from_node = known.truth;
  Rng rng(0);
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool closes = i + 1 == count;
    known.graph.edges.push_back(
        measured(known.truth, i, closes ? 0 : i + 1, closes ? EdgeKind::loop : EdgeKind::motion, {}, rng));
  }
  return known;
}

/// Adds wrong loops between random nodes: what a place recognition claims that takes one place for another.
inline void add_false_loops(PoseGraph& graph, std::size_t count, std::uint64_t seed) {
  Rng rng(seed);
  const auto n = static_cast<std::uint32_t>(graph.map_from_node.size());
  const auto first_loop = std::find_if(graph.edges.begin(), graph.edges.end(),
                                       [](const PoseEdge& edge) { return edge.kind == EdgeKind::loop; });
  const Eigen::Matrix3d information = first_loop->information;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t a = rng.below(n);
    const std::uint32_t b = (a + 10 + rng.below(n - 20)) % n;
    const Pose2 claim{rng.normal(0, 0.5), rng.normal(0, 0.5), rng.uniform(-std::numbers::pi, std::numbers::pi)};
    graph.edges.push_back({a, b, claim, information, EdgeKind::loop});
  }
}

/// Largest distance of a node from where it should be; the first node is at its place in both.
inline double worst_position(const PoseGraph& graph, const std::vector<Pose2>& truth) {
  double worst = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    worst = std::max(worst, distance(graph.map_from_node[i], truth[i]));
  }
  return worst;
}

}  // namespace flirt
