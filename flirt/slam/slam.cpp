#include "flirt/slam/slam.hpp"

#include "flirt/registration/surface_points.hpp"
#include "flirt/slam/scan_front_end.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <chrono>
#include <utility>
#include <variant>

namespace flirt {
namespace {

using FrontEnd = std::variant<ScanFrontEnd>;

FrontEnd make_front_end(const SlamParams& params) {
  switch (params.front_end) {
    case FrontEndKind::scan: break;
  }
  return ScanFrontEnd(params);
}

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

SlamScan prepared(const Scan& scan, const SlamParams& params) {
  SlamScan kept{surface_points(scan, params.points), scan.odom_from_robot};
  if (kept.odom_from_robot && !is_finite(*kept.odom_from_robot)) { kept.odom_from_robot.reset(); }
  return kept;
}

}  // namespace

struct Slam::State {
  explicit State(const SlamParams& slam_params) : params(slam_params), front_end(make_front_end(slam_params)) {}

  void add_node(const Motion& motion) {
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

  SlamParams params;
  FrontEnd front_end;
  std::vector<SlamScan> scans{};
  PoseGraph graph{};
  std::vector<SlamStep> steps{};
  SlamSummary summary{};
};

Slam::Slam(const SlamParams& params) : state_(std::make_unique<State>(params)) {}
Slam::~Slam() = default;
Slam::Slam(Slam&&) noexcept = default;
Slam& Slam::operator=(Slam&&) noexcept = default;

SlamStep Slam::add(const Scan& scan) {
  State& s = *state_;
  auto begin = Clock::now();
  s.scans.push_back(prepared(scan, s.params));
  s.summary.seconds.points += seconds_since(begin);
  begin = Clock::now();
  const Motion motion = std::visit([&](auto& front_end) { return front_end.add(s.scans.back()); }, s.front_end);
  s.summary.seconds.front_end += seconds_since(begin);
  s.add_node(motion);
  s.steps.push_back({s.graph.map_from_node.back(), motion.source, motion.score, motion.unobservable, 0});
  return s.steps.back();
}

void Slam::finish() {}

const PoseGraph& Slam::graph() const {
  return state_->graph;
}
const std::vector<SlamStep>& Slam::steps() const {
  return state_->steps;
}
SlamSummary Slam::summary() const {
  SlamSummary summary = state_->summary;
  summary.scans = state_->steps.size();
  for (const SlamStep& step : state_->steps) {
    summary.closures += step.closures;
    summary.unobservable += step.unobservable ? 1 : 0;
    summary.wide += step.source == MotionSource::wide ? 1 : 0;
    summary.predictions += step.source == MotionSource::prediction ? 1 : 0;
  }
  return summary;
}

}  // namespace flirt
