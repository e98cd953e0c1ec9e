#include "flirt/graph/toro.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <cmath>

namespace flirt {
namespace {

double position_information(const PoseEdge& edge) {
  return (edge.information(0, 0) + edge.information(1, 1)) / 2;  // the same in every frame
}

Point2 rotated(double angle, Point2 p) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {c * p.x - s * p.y, s * p.x + c * p.y};
}

/// Share of its error that an edge corrects: full where it is alone on its path, less where others hold against it.
double gain(double information, double compliance, double rate) {
  return std::min(1.0, rate * information * compliance);
}

}  // namespace

Toro::Toro(PoseGraph& graph, std::uint32_t fixed_node)
    : graph_(graph),
      tree_(spanning_tree(graph, fixed_node)),
      parent_from_node_(graph.map_from_node.size()),
      stiffness_(graph.map_from_node.size()) {
  for (std::uint32_t edge = 0; edge < graph.edges.size(); ++edge) {
    if (graph.edges[edge].a != graph.edges[edge].b) { add_constraint(edge); }
  }
  std::stable_sort(constraints_.begin(), constraints_.end(),
                   [](const Constraint& a, const Constraint& b) { return a.level < b.level; });
}

void Toro::add_constraint(std::uint32_t edge) {
  std::vector<std::uint32_t> to_a;
  std::vector<std::uint32_t> to_b;
  std::uint32_t a = graph_.edges[edge].a;
  std::uint32_t b = graph_.edges[edge].b;
  while (a != b) {
    if (tree_.level[a] >= tree_.level[b]) {
      to_a.push_back(a);
      a = tree_.parent[a];
    } else {
      to_b.push_back(b);
      b = tree_.parent[b];
    }
  }
  const std::size_t begin = path_.size();
  path_.insert(path_.end(), to_a.rbegin(), to_a.rend());
  const std::size_t middle = path_.size();
  path_.insert(path_.end(), to_b.rbegin(), to_b.rend());
  constraints_.push_back({edge, tree_.level[a], begin, middle, path_.size()});
}

double Toro::rate(std::uint32_t n, std::uint32_t passes) {
  const double left = 1.0 - static_cast<double>(n) / passes;
  return 10.0 * left * left * left;
}

double Toro::pass(std::span<const double> weight, double rate) {
  FLIRT_ASSERT(weight.size() == graph_.edges.size());
  read_poses();
  gather_stiffness(weight);
  double largest = 0;
  for (const Constraint& constraint : constraints_) {
    if (!(weight[constraint.edge] > 0)) { continue; }
    largest = std::max(largest, turn(constraint, weight[constraint.edge], rate));
    largest = std::max(largest, move(constraint, weight[constraint.edge], rate));
  }
  write_poses();
  return largest;
}

void Toro::read_poses() {
  for (const std::uint32_t node : tree_.order) {
    if (tree_.parent[node] == no_node) { continue; }
    parent_from_node_[node] = inverse(graph_.map_from_node[tree_.parent[node]]) * graph_.map_from_node[node];
  }
}

void Toro::write_poses() {
  for (const std::uint32_t node : tree_.order) {
    if (tree_.parent[node] == no_node) { continue; }
    graph_.map_from_node[node] = graph_.map_from_node[tree_.parent[node]] * parent_from_node_[node];
  }
}

void Toro::gather_stiffness(std::span<const double> weight) {
  std::fill(stiffness_.begin(), stiffness_.end(), Stiffness{});
  for (const Constraint& constraint : constraints_) {
    const PoseEdge& edge = graph_.edges[constraint.edge];
    const double w = weight[constraint.edge];
    for (std::size_t k = constraint.begin; k < constraint.end; ++k) {
      stiffness_[path_[k]].position += w * position_information(edge);
      stiffness_[path_[k]].heading += w * edge.information(2, 2);
    }
  }
}

/// The last node of a part of the path, seen from the path's topmost node.
Pose2 Toro::end_of(std::size_t begin, std::size_t end) const {
  Pose2 top_from_node;
  for (std::size_t k = begin; k < end; ++k) { top_from_node = top_from_node * parent_from_node_[path_[k]]; }
  return top_from_node;
}

double Toro::turn(const Constraint& constraint, double weight, double rate) {
  const PoseEdge& edge = graph_.edges[constraint.edge];
  double error = -edge.a_from_b.theta;
  double compliance = 0;
  for (std::size_t k = constraint.begin; k < constraint.end; ++k) {
    const double theta = parent_from_node_[path_[k]].theta;
    error += k < constraint.middle ? -theta : theta;
    compliance += 1 / stiffness_[path_[k]].heading;
  }
  if (!std::isfinite(compliance)) { return 0; }  // no edge of the path measured headings
  const double whole = -gain(weight * edge.information(2, 2), compliance, rate) * wrap_angle(error);
  for (std::size_t k = constraint.begin; k < constraint.end; ++k) {
    double& theta = parent_from_node_[path_[k]].theta;
    const double share = whole / compliance / stiffness_[path_[k]].heading;
    theta = wrap_angle(k < constraint.middle ? theta - share : theta + share);
  }
  return std::abs(whole);
}

double Toro::move(const Constraint& constraint, double weight, double rate) {
  const PoseEdge& edge = graph_.edges[constraint.edge];
  double compliance = 0;
  for (std::size_t k = constraint.begin; k < constraint.end; ++k) { compliance += 1 / stiffness_[path_[k]].position; }
  if (!std::isfinite(compliance)) { return 0; }
  const Pose2 top_from_a = end_of(constraint.begin, constraint.middle);
  const Pose2 top_from_b = end_of(constraint.middle, constraint.end);
  const Pose2 top_from_measured = top_from_a * edge.a_from_b;
  // In the measured frame of b, where the information is stated: each axis by its own.
  const Point2 error = rotated(-top_from_measured.theta, top_from_b.translation() - top_from_measured.translation());
  const Point2 corrected{-gain(weight * edge.information(0, 0), compliance, rate) * error.x,
                         -gain(weight * edge.information(1, 1), compliance, rate) * error.y};
  const Point2 whole = (1 / compliance) * rotated(top_from_measured.theta, corrected);
  shift(constraint.begin, constraint.middle, -1.0 * whole);
  shift(constraint.middle, constraint.end, whole);
  return norm(corrected);
}

/// Moves the nodes of a part of the path, in the frame of the topmost node, each by its share of `whole` and by those
/// of the nodes above it.
void Toro::shift(std::size_t begin, std::size_t end, Point2 whole) {
  double top_from_parent = 0;  // rad
  for (std::size_t k = begin; k < end; ++k) {
    Pose2& parent_from_node = parent_from_node_[path_[k]];
    const Point2 share = rotated(-top_from_parent, (1 / stiffness_[path_[k]].position) * whole);
    parent_from_node.x += share.x;
    parent_from_node.y += share.y;
    top_from_parent += parent_from_node.theta;
  }
}

}  // namespace flirt
