#include "flirt/slam/slam.hpp"

#include "flirt/features/extract.hpp"
#include "flirt/graph/optimize.hpp"
#include "flirt/graph/tail.hpp"
#include "flirt/registration/surface_points.hpp"
#include "flirt/slam/front_ends.hpp"
#include "flirt/slam/polish.hpp"
#include "flirt/slam/repair.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <numeric>
#include <span>
#include <utility>
#include <variant>

namespace flirt {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Sets of nodes that edges hold together (union and find).
class Parts {
 public:
  explicit Parts(std::size_t nodes) : parent_(nodes), size_(nodes, 1) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root_of(a);
    b = root_of(b);
    if (a == b) { return; }
    parent_[b] = a;
    size_[a] += size_[b];
  }
  /// Sets of two nodes or more.
  [[nodiscard]] std::size_t count() {
    std::size_t n = 0;
    for (std::uint32_t i = 0; i < parent_.size(); ++i) { n += parent_[i] == i && size_[i] > 1 ? 1 : 0; }
    return n;
  }

 private:
  std::uint32_t root_of(std::uint32_t node) {
    while (parent_[node] != node) { node = parent_[node] = parent_[parent_[node]]; }
    return node;
  }

  std::vector<std::uint32_t> parent_;
  std::vector<std::uint32_t> size_;  // of a root's set
};

}  // namespace

struct Slam::State {
  explicit State(const SlamParams& slam_params)
      : params(slam_params), front_end(make_front_end(slam_params)), loops(make_loop_finder(slam_params)) {}

  [[nodiscard]] SlamScan prepared(const Scan& scan) {
    SlamScan kept{.points = surface_points(scan, params.points), .odom_from_robot = scan.odom_from_robot, .scan = scan};
    if (kept.odom_from_robot && !is_finite(*kept.odom_from_robot)) { kept.odom_from_robot.reset(); }
    if (needs_keypoints(params.front_end)) {
      kept.features = extractor.extract(scan);
      kept.keypoints = table_of(kept.features.keypoints);
    }
    return kept;
  }

  /// Of all scans, denser than for finding motions.
  [[nodiscard]] std::vector<SurfacePoints> fine_points() const {
    SurfacePointParams fine = params.points;
    fine.spacing = params.polish_spacing;
    fine.in_line = params.polish_in_line;
    std::vector<SurfacePoints> points;
    points.reserve(scans.size());
    for (const SlamScan& scan : scans) { points.push_back(surface_points(scan.scan, fine)); }
    return points;
  }

  void add_node(const ScanMotion& motion) {
    const auto node = static_cast<std::uint32_t>(graph.map_from_node.size());
    if (motion.relative.empty()) {
      graph.map_from_node.push_back({params.start_x, params.start_y, wrap_angle(params.start_theta)});
      return;
    }
    graph.map_from_node.push_back(graph.map_from_node.back() * motion.relative.front().earlier_from_robot);
    for (const RelativeMotion& relative : motion.relative) {
      graph.edges.push_back(
          {node - relative.back, node, relative.earlier_from_robot, relative.information, EdgeKind::motion});
    }
  }

  [[nodiscard]] std::vector<Closure> earlier_visits() {
    if (auto* constraints = std::get_if<FlirtConstraints>(&loops)) {
      return constraints->add(scans, graph, steps.back().source);
    }
    return std::get<LoopCloser>(loops).add(scans, graph);
  }

  /// Looks for earlier visits; the number found.
  std::uint32_t close_loops() {
    auto begin = Clock::now();
    const std::vector<Closure> closures = earlier_visits();
    summary.seconds.loops += seconds_since(begin);
    std::uint32_t found = 0;
    for (const Closure& closure : closures) {
      graph.edges.insert(graph.edges.end(), closure.edges.begin(), closure.edges.end());
      pending_translation = std::max(pending_translation, closure.translation);
      pending_rotation = std::max(pending_rotation, closure.rotation);
      summary.anywhere += closure.source == ClosureSource::anywhere ? 1 : 0;
      found += closure.edges.front().kind == EdgeKind::loop ? 1 : 0;
    }
    // Small corrections wait for each other.
    pending += closures.size();
    if (pending > 0 && is_due()) { optimize_newest(); }
    return found;
  }

  /// What was mapped before the last closures stands; only the way since then has drifted.
  void optimize_newest() {
    const std::uint32_t margin = std::max(100U, params.window);  // scans
    constexpr std::uint32_t most = 1500;  // scans; a longer way waits for `finish` to be bent as a whole
    const auto newest = static_cast<std::uint32_t>(graph.map_from_node.size() - 1);
    const bool whole = params.front_end == FrontEndKind::flirt && params.window == 0;  // constraints anywhere
    const std::uint32_t first_free = std::max(tied > margin ? tied - margin : 0, newest > most ? newest - most : 0);
    tied = newest;
    optimize_poses(4, whole ? 0 : first_free);
  }

  [[nodiscard]] bool is_due() {
    if (pending_translation > 0.15 || pending_rotation > 0.02) { return true; }
    if (params.front_end != FrontEndKind::flirt) { return pending >= 8; }
    return ++steps_waited >= params.flirt.optimize_every;
  }

  /// Scans that may be in a wrong place: they fit their partners badly, or their motion was not sure when it was found,
  /// or that of the scan after them, which would tell.
  [[nodiscard]] std::vector<std::uint32_t> suspects(std::span<const double> fit) const {
    const auto unsure = [&](std::size_t node) {
      if (node < joined) { return false; }
      const std::size_t i = node - joined;
      return i < steps.size() && steps[i].source != MotionSource::first &&
             (steps[i].source != MotionSource::narrow || steps[i].score < params.suspect_score);
    };
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t i = 0; i < fit.size(); ++i) {
      if (fit[i] < params.repair_fit || unsure(i) || unsure(i + 1)) { nodes.push_back(i); }
    }
    return nodes;
  }

  [[nodiscard]] std::size_t pieces() const {
    Parts parts(graph.map_from_node.size());
    for (const PoseEdge& edge : graph.edges) {
      const bool is_unseen = edge.kind == EdgeKind::motion && edge.b >= joined && steps[edge.b - joined].unobservable &&
                             !std::ranges::binary_search(repaired, edge.b);  // its edges are to where it was found
      if (!is_unseen) { parts.join(edge.a, edge.b); }
    }
    return parts.count();
  }

  /// Nodes before `first_free` keep their poses.
  void optimize_poses(std::uint32_t iterations, std::uint32_t first_free = 0) {
    const auto begin = Clock::now();
    if (graph.map_from_node.empty()) { return; }
    // Least squares alone may end elsewhere when a large part of the map has to swing round.
    if (pending_translation > 1 || pending_rotation > 0.3) {
      static_cast<void>(optimize_tail(graph, first_free, {.backend = Backend::toro, .iterations = 30}));
      iterations = std::max(iterations, 20U);
    }
    static_cast<void>(optimize_tail(graph, first_free,
                                    {.backend = params.backend, .iterations = iterations, .trust_radius = undamped}));
    pending = 0;
    steps_waited = 0;
    pending_translation = 0;
    pending_rotation = 0;
    ++summary.optimizations;
    summary.seconds.optimize += seconds_since(begin);
  }

  SlamParams params;
  FrontEnd front_end;
  LoopFinder loops;
  FeatureExtractor extractor{};
  std::uint32_t steps_waited{0};  ///< since the last optimization, with closures pending
  std::size_t pending{0};         ///< closures that the poses do not know of yet
  double pending_translation{0};  ///< m, the largest correction of them
  double pending_rotation{0};     ///< rad
  std::vector<SlamScan> scans{};
  PoseGraph graph{};
  std::vector<SlamStep> steps{};
  std::vector<std::uint32_t> repaired{};  ///< nodes, in order
  std::uint32_t tied{0};                  ///< newest node when closures last moved the poses
  std::uint32_t joined{0};                ///< nodes of an earlier map, before those of `steps`
  SlamSummary summary{};
};

Slam::Slam(const SlamParams& params) : state_(std::make_unique<State>(params)) {}
Slam::~Slam() = default;
Slam::Slam(Slam&&) noexcept = default;
Slam& Slam::operator=(Slam&&) noexcept = default;

SlamStep Slam::add(const Scan& scan) {
  State& s = *state_;
  auto begin = Clock::now();
  s.scans.push_back(s.prepared(scan));
  s.summary.seconds.points += seconds_since(begin);
  begin = Clock::now();
  const ScanMotion motion = std::visit([&](auto& front_end) { return front_end.add(s.scans.back()); }, s.front_end);
  s.summary.seconds.front_end += seconds_since(begin);
  s.add_node(motion);
  s.steps.push_back({{}, motion.source, motion.score, motion.unobservable, motion.structure, 0});
  // The papers' incremental mapping takes constraints from the window.
  if (s.params.window == 0 || s.params.front_end == FrontEndKind::flirt) { s.steps.back().closures = s.close_loops(); }
  s.steps.back().map_from_robot = s.graph.map_from_node.back();
  return s.steps.back();
}

SessionJoin Slam::join(std::span<const Scan> scans, const PoseGraph& graph) {
  State& s = *state_;
  std::vector<SlamScan> earlier;
  earlier.reserve(scans.size() + s.scans.size());
  for (const Scan& scan : scans) { earlier.push_back(s.prepared(scan)); }
  s.optimize_poses(10);
  const SessionPlace place = find_session({earlier, graph}, {s.scans, s.graph});
  if (place.summary.agreeing == 0) { return place.summary; }
  s.joined = static_cast<std::uint32_t>(earlier.size());
  PoseGraph joint = graph;
  for (const Pose2& pose : s.graph.map_from_node) { joint.map_from_node.push_back(place.earlier_from_run * pose); }
  for (PoseEdge edge : s.graph.edges) {
    edge.a += s.joined;
    edge.b += s.joined;
    joint.edges.push_back(edge);
  }
  for (PoseEdge edge : place.edges) {
    edge.b += s.joined;
    joint.edges.push_back(edge);
  }
  s.graph = std::move(joint);
  std::ranges::move(s.scans, std::back_inserter(earlier));
  s.scans = std::move(earlier);
  s.optimize_poses(30);
  return place.summary;
}

void Slam::finish() {
  State& s = *state_;
  const bool polished_at_end = s.params.window == 0 && is_polished(s.params.front_end);
  if (s.params.window == 0 || s.params.front_end == FrontEndKind::flirt) {
    s.optimize_poses(polished_at_end ? 10 : 100);
  }
  if (!polished_at_end) { return; }
  const auto begin = Clock::now();
  const std::vector<SurfacePoints> points = s.fine_points();
  PolishSummary polished = polish(s.graph, points, s.params);
  if (s.params.polish_rounds > 0) { s.repaired = repair(s.graph, s.scans, s.suspects(polished.fit), s.params); }
  s.summary.repaired = s.repaired.size();
  if (!s.repaired.empty()) {
    SlamParams again = s.params;
    again.polish_rounds = std::min(again.polish_rounds, 2U);  // only few scans have yet to settle
    polished = polish(s.graph, points, again);
  }
  s.summary.pairs = polished.pairs;
  s.summary.pair_residual = polished.residual;
  s.summary.seconds.polish += seconds_since(begin);
}

const PoseGraph& Slam::graph() const {
  return state_->graph;
}
const std::vector<SlamStep>& Slam::steps() const {
  return state_->steps;
}
SlamSummary Slam::summary() const {
  SlamSummary summary = state_->summary;
  summary.scans = state_->steps.size();
  summary.pieces = state_->pieces();
  for (const SlamStep& step : state_->steps) {
    summary.closures += step.closures;
    summary.unobservable += step.unobservable ? 1 : 0;
    summary.featureless += step.structure == Structure::featureless ? 1 : 0;
    summary.cluttered += step.structure == Structure::cluttered ? 1 : 0;
    summary.wide += step.source == MotionSource::wide ? 1 : 0;
    summary.predictions += step.source == MotionSource::prediction ? 1 : 0;
  }
  return summary;
}

}  // namespace flirt
