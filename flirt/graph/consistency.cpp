#include "flirt/graph/consistency.hpp"

#include "flirt/graph/clique.hpp"
#include "flirt/graph/edge_error.hpp"
#include "flirt/graph/spanning_tree.hpp"

#include <algorithm>

namespace flirt {
namespace {

/// The robot's way: each node hangs from its predecessor, with its pose and covariance as seen from the start. Errors
/// stated in the start's frame add up along the way, so that those between any two nodes are a difference.
class MotionChain {
 public:
  explicit MotionChain(const PoseGraph& graph) : nodes_(graph.map_from_node.size()) {
    std::vector<const PoseEdge*> to_predecessor(nodes_.size(), nullptr);
    for (const PoseEdge& edge : graph.edges) {
      if (edge.kind != EdgeKind::motion || edge.a == edge.b || !relative_pose(edge)) { continue; }
      const std::uint32_t child = std::max(edge.a, edge.b);
      const PoseEdge* const other = to_predecessor[child];
      if (other == nullptr || std::min(edge.a, edge.b) > std::min(other->a, other->b)) {
        to_predecessor[child] = &edge;
      }
    }
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) { hang(node, to_predecessor[node]); }
  }

  /// b as seen from a; nothing when no motion connects them.
  [[nodiscard]] std::optional<RelativePose> between(std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t top = common_ancestor(a, b);
    if (top == no_node) { return std::nullopt; }
    const Node& node_a = nodes_[a];
    const Node& node_b = nodes_[b];
    const Eigen::Matrix3d b_from_start = adjoint(inverse(node_b.start_from_node));
    const Eigen::Matrix3d in_start = node_a.covariance + node_b.covariance - 2 * nodes_[top].covariance;
    return RelativePose{inverse(node_a.start_from_node) * node_b.start_from_node,
                        b_from_start * in_start * b_from_start.transpose()};
  }

 private:
  struct Node {
    std::uint32_t parent{no_node};
    std::uint32_t branch{0};  ///< first node of the unbranched run that this node is in
    std::uint32_t last_child{no_node};
    Pose2 start_from_node{};
    Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};  ///< stated in the start's frame
  };

  void hang(std::uint32_t i, const PoseEdge* edge) {
    Node& node = nodes_[i];
    node.branch = i;
    if (edge == nullptr) { return; }
    node.parent = std::min(edge->a, edge->b);
    Node& parent = nodes_[node.parent];
    if (parent.last_child == no_node) { node.branch = parent.branch; }
    parent.last_child = i;
    const RelativePose measured = *relative_pose(*edge);
    const RelativePose parent_from_node = edge->b == i ? measured : inverse(measured);
    node.start_from_node = parent.start_from_node * parent_from_node.a_from_b;
    const Eigen::Matrix3d start_from_node = adjoint(node.start_from_node);
    node.covariance = parent.covariance + start_from_node * parent_from_node.covariance * start_from_node.transpose();
  }

  /// Parents have lower indices than their children, within a run as between runs.
  [[nodiscard]] std::uint32_t common_ancestor(std::uint32_t a, std::uint32_t b) const {
    while (nodes_[a].branch != nodes_[b].branch) {
      std::uint32_t& later = nodes_[a].branch > nodes_[b].branch ? a : b;
      later = nodes_[nodes_[later].branch].parent;
      if (later == no_node) { return no_node; }
    }
    return std::min(a, b);
  }

  std::vector<Node> nodes_;
};

struct Loop {
  std::uint32_t edge;
  std::uint32_t a;
  std::uint32_t b;
  RelativePose a_from_b;
  RelativePose b_from_a;
};

std::vector<Loop> usable_loops(const PoseGraph& graph, const MotionChain& chain) {
  std::vector<Loop> loops;
  for (std::uint32_t k = 0; k < graph.edges.size(); ++k) {
    const PoseEdge& edge = graph.edges[k];
    if (edge.kind != EdgeKind::loop || edge.a == edge.b) { continue; }
    const auto measured = relative_pose(edge);
    if (measured && chain.between(edge.a, edge.b)) {
      loops.push_back({k, edge.a, edge.b, *measured, inverse(*measured)});
    }
  }
  return loops;
}

std::uint32_t gap(std::uint32_t i, std::uint32_t j) {
  return i > j ? i - j : j - i;
}

/// The cycle one.a → other's near end → other's far end → one.b, against what `one` measured.
bool agree(const Loop& one, const Loop& other, const MotionChain& chain, double limit) {
  const bool same_way = gap(one.a, other.a) + gap(one.b, other.b) <= gap(one.a, other.b) + gap(one.b, other.a);
  const std::uint32_t near = same_way ? other.a : other.b;
  const std::uint32_t far = same_way ? other.b : other.a;
  const auto before = chain.between(one.a, near);
  const auto after = chain.between(far, one.b);
  if (!before || !after) { return false; }
  const RelativePose around = *before * (same_way ? other.a_from_b : other.b_from_a) * *after;
  return squared_mahalanobis(one.a_from_b, around) <= limit;
}

}  // namespace

std::vector<std::uint32_t> consistent_loops(const PoseGraph& graph, const ConsistencyParams& params) {
  const MotionChain chain(graph);
  const std::vector<Loop> loops = usable_loops(graph, chain);
  AgreementMatrix agreement(loops.size());
  for (std::size_t i = 0; i < loops.size(); ++i) {
    for (std::size_t j = i + 1; j < loops.size(); ++j) {
      if (agree(loops[i], loops[j], chain, params.limit)) { agreement.set(i, j); }
    }
  }
  std::vector<std::uint32_t> edges;
  const std::uint64_t branches = loops.size() <= params.exact_limit ? params.most_branches : 0;
  for (const std::uint32_t i : largest_clique(agreement, branches).members) { edges.push_back(loops[i].edge); }
  return edges;
}

}  // namespace flirt
