// flirt/graph/pose_graph.hpp: poses and the relative measurements between them.
#pragma once

#include "flirt/core/pose2.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

/// Where a relative measurement came from.
enum class EdgeKind : std::uint8_t {
  motion,  ///< between poses that follow each other: scan matching or odometry
  loop,    ///< between a pose and an earlier visit of the place
};
constexpr auto enum_names(EdgeKind /*tag*/) {
  return std::array{std::pair{EdgeKind::motion, std::string_view("motion")},
                    std::pair{EdgeKind::loop, std::string_view("loop")}};
}

/// Node b as measured from node a. The error of an edge is the motion inverse(a_from_b) * inverse(map_from_a) *
/// map_from_b as (x, y, theta), and `information` is the inverse of its covariance (the convention of g2o).
struct PoseEdge {
  std::uint32_t a{0};
  std::uint32_t b{0};
  Pose2 a_from_b{};
  Eigen::Matrix3d information{Eigen::Matrix3d::Identity()};  ///< m⁻², m⁻¹rad⁻¹, rad⁻²
  EdgeKind kind{EdgeKind::motion};
};

struct PoseGraph {
  std::vector<Pose2> map_from_node{};
  std::vector<PoseEdge> edges{};
};

}  // namespace flirt
