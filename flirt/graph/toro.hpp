// flirt/graph/toro.hpp: TORO, gradient descent over a tree of poses, one edge after the other.
//
// Grisetti, Stachniss and Burgard, "Nonlinear constraint network optimization for efficient map learning", IEEE
// Transactions on Intelligent Transportation Systems 10(3), 2009, in the plane; the descent is Olson, Leonard and
// Teller's (2006). The parameters are each node's pose seen from its parent in a spanning tree, so that moving a node
// takes along all that hangs from it. An edge between a and b is satisfied by spreading its error over the tree's path
// from a to b: first the heading, then, with the new headings, the position. Shares go by 1 / M, where M is the
// information that all edges put on a node's parameters; the step shrinks from pass to pass, so that edges that
// contradict each other settle. Edges are taken by the level of the topmost node of their path, from the root down.
//
// It finds its way from starts where least squares does not, to a place near the minimum rather than to it.
#pragma once

#include "flirt/graph/pose_graph.hpp"
#include "flirt/graph/spanning_tree.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

class Toro {
 public:
  /// `graph` must outlive this. `fixed_node` and the roots of other parts of the graph stay.
  Toro(PoseGraph& graph, std::uint32_t fixed_node);

  /// One pass over all edges; moves the graph's poses. `weight` is one factor on the information of each edge,
  /// `rate` the factor on the part of its error that an edge's share of the information allows it to correct; no edge
  /// corrects more than all. Returns the largest correction of an edge, m or rad. O(Σ path lengths).
  double pass(std::span<const double> weight, double rate);

  /// The learning rate of the n-th of `passes` passes: 10 (1 − n / passes)³. Olson's 1 / n is far from done after 100
  /// passes: on simulated graphs of 2000 nodes it left a χ² of 10 to 200 times the minimum, this one 1.2 times.
  [[nodiscard]] static double rate(std::uint32_t n, std::uint32_t passes);

 private:
  /// An edge with its way through the tree: the nodes below the topmost down to a, then those down to b.
  struct Constraint {
    std::uint32_t edge{0};
    std::uint32_t level{0};  ///< of the topmost node
    std::size_t begin{0};    ///< in path_
    std::size_t middle{0};
    std::size_t end{0};
  };
  /// Information on the parameters of a node: M of the papers, per m² and per rad².
  struct Stiffness {
    double position{0};
    double heading{0};
  };

  void add_constraint(std::uint32_t edge);
  void read_poses();
  void write_poses();
  void gather_stiffness(std::span<const double> weight);
  [[nodiscard]] Pose2 end_of(std::size_t begin, std::size_t end) const;
  /// Each spreads a part of the edge's error over its path and returns how much, rad and m.
  double turn(const Constraint& constraint, double weight, double rate);
  double move(const Constraint& constraint, double weight, double rate);
  void shift(std::size_t begin, std::size_t end, Point2 whole);

  PoseGraph& graph_;
  SpanningTree tree_;
  std::vector<Constraint> constraints_{};
  std::vector<std::uint32_t> path_{};
  std::vector<Pose2> parent_from_node_{};
  std::vector<Stiffness> stiffness_{};
};

}  // namespace flirt
