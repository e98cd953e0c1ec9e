#include "flirt/features/geodesic.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

namespace flirt {
namespace {

/// Order of edges: by squared length as float, then by the indices.
using EdgeRank = std::tuple<float, std::uint32_t, std::uint32_t>;

struct Points {
  std::span<const double> x;
  std::span<const double> y;

  [[nodiscard]] double squared_distance(std::uint32_t i, std::uint32_t j) const {
    return (x[i] - x[j]) * (x[i] - x[j]) + (y[i] - y[j]) * (y[i] - y[j]);
  }
  [[nodiscard]] EdgeRank rank(std::uint32_t i, std::uint32_t j) const {
    return {static_cast<float>(squared_distance(i, j)), std::min(i, j), std::max(i, j)};
  }
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(x.size()); }
};

using Adjacency = std::vector<std::vector<std::uint32_t>>;

/// Grows one minimum spanning forest (Prim) over all edges that `used` does not hold, and adds its edges to `used`.
class TreeGrower {
 public:
  TreeGrower(const Points& points, Adjacency& used, std::vector<CurveEdge>& edges)
      : points_(points), used_(used), edges_(edges), best_(points.size()), outside_(points.size(), true) {}

  void grow() {
    for (std::uint32_t root = 0; root < points_.size(); ++root) {
      if (!outside_[root]) { continue; }
      add(root);
      for (std::optional<EdgeRank> edge = cheapest(); edge; edge = cheapest()) { take(*edge); }
    }
    for (const CurveEdge& edge : taken_) {
      used_[edge.low].push_back(edge.high);
      used_[edge.high].push_back(edge.low);
      edges_.push_back(edge);
    }
  }

 private:
  void add(std::uint32_t point) {
    outside_[point] = false;
    for (std::uint32_t other = 0; other < points_.size(); ++other) {
      if (!outside_[other]) { continue; }
      const EdgeRank rank = points_.rank(point, other);
      if (best_[other] && *best_[other] < rank) { continue; }
      if (std::ranges::find(used_[point], other) == used_[point].end()) { best_[other] = rank; }
    }
  }
  [[nodiscard]] std::optional<EdgeRank> cheapest() const {
    std::optional<EdgeRank> cheapest;
    for (std::uint32_t point = 0; point < points_.size(); ++point) {
      if (outside_[point] && best_[point] && (!cheapest || *best_[point] < *cheapest)) { cheapest = best_[point]; }
    }
    return cheapest;
  }
  void take(const EdgeRank& rank) {
    const auto [key, low, high] = rank;
    taken_.push_back({low, high, std::sqrt(points_.squared_distance(low, high))});
    add(outside_[low] ? low : high);
  }

  const Points& points_;
  Adjacency& used_;
  std::vector<CurveEdge>& edges_;
  std::vector<CurveEdge> taken_;
  std::vector<std::optional<EdgeRank>> best_;
  std::vector<bool> outside_;
};

/// Edges as rows, for walking over the graph.
struct Graph {
  std::vector<std::size_t> first;
  std::vector<std::pair<std::uint32_t, double>> steps;
};

Graph graph_of(std::span<const CurveEdge> edges, std::size_t count) {
  Graph graph{std::vector<std::size_t>(count + 1, 0), {}};
  for (const CurveEdge& edge : edges) {
    ++graph.first[edge.low + 1];
    ++graph.first[edge.high + 1];
  }
  for (std::size_t i = 0; i < count; ++i) { graph.first[i + 1] += graph.first[i]; }
  graph.steps.resize(2 * edges.size());
  std::vector<std::size_t> next(graph.first.begin(), graph.first.end() - 1);
  for (const CurveEdge& edge : edges) {
    graph.steps[next[edge.low]++] = {edge.high, edge.length};
    graph.steps[next[edge.high]++] = {edge.low, edge.length};
  }
  return graph;
}

/// Dijkstra's algorithm from one source after the other, never beyond `reach`.
class Explorer {
 public:
  Explorer(const Graph& graph, double reach)
      : graph_(graph), reach_(reach), distance_(graph.first.size() - 1, infinity) {}

  void explore(std::uint32_t source, GeodesicNeighbours& neighbours) {
    visit(source, 0.0);
    while (!open_.empty()) {
      std::ranges::pop_heap(open_, std::greater<>{});
      const auto [length, point] = open_.back();
      open_.pop_back();
      if (length > distance_[point]) { continue; }
      for (std::size_t k = graph_.first[point]; k < graph_.first[point + 1]; ++k) {
        const auto [other, step] = graph_.steps[k];
        visit(other, length + step);
      }
    }
    std::ranges::sort(seen_);
    for (const std::uint32_t point : seen_) {
      neighbours.point.push_back(point);
      neighbours.distance.push_back(std::exchange(distance_[point], infinity));
    }
    seen_.clear();
    neighbours.first.push_back(neighbours.point.size());
  }

 private:
  static constexpr double infinity{std::numeric_limits<double>::infinity()};

  void visit(std::uint32_t point, double length) {
    if (!(length <= reach_) || !(length < distance_[point])) { return; }
    if (distance_[point] == infinity) { seen_.push_back(point); }
    distance_[point] = length;
    open_.emplace_back(length, point);
    std::ranges::push_heap(open_, std::greater<>{});
  }

  const Graph& graph_;
  double reach_;
  std::vector<double> distance_;
  std::vector<std::uint32_t> seen_;
  std::vector<std::pair<double, std::uint32_t>> open_;
};

}  // namespace

double arc_lengths(std::span<const double> x, std::span<const double> y, bool closed, AlignedVector<double>& arc) {
  const std::size_t n = x.size();
  arc.resize(n);
  if (n == 0) { return 0.0; }
  arc[0] = 0.0;
  for (std::size_t i = 1; i < n; ++i) {
    const double dx = x[i] - x[i - 1];
    const double dy = y[i] - y[i - 1];
    arc[i] = arc[i - 1] + std::sqrt(dx * dx + dy * dy);
  }
  return closed ? arc[n - 1] + std::hypot(x[0] - x[n - 1], y[0] - y[n - 1]) : arc[n - 1];
}

std::vector<CurveEdge> spanning_tree_edges(std::span<const double> x, std::span<const double> y, int trees) {
  const Points points{x, y};
  Adjacency used(points.size());
  std::vector<CurveEdge> edges;
  for (int tree = 0; tree < trees; ++tree) { TreeGrower(points, used, edges).grow(); }
  return edges;
}

GeodesicNeighbours shortest_paths(std::span<const CurveEdge> edges, std::size_t count, double reach) {
  const Graph graph = graph_of(edges, count);
  Explorer explorer(graph, reach);
  GeodesicNeighbours neighbours{{0}, {}, {}};
  for (std::uint32_t source = 0; source < count; ++source) { explorer.explore(source, neighbours); }
  return neighbours;
}

}  // namespace flirt
