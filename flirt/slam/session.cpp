#include "flirt/slam/session.hpp"

#include "flirt/slam/global_places.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flirt {
namespace {

constexpr double query_travel = 1.5;  // m of travel between queries, and a turn of 1 rad
constexpr std::size_t least_agreeing = 4;

struct Answer {
  std::uint32_t node;
  double travel;  // m
  FoundPlace place;
};

/// Whether two answers differ as the run says: within what it may have drifted in between.
bool agree(const Answer& one, const Answer& other, std::span<const Pose2> run_from_node) {
  constexpr double metres = 0.3;
  const double radians = radians_from_degrees(3);
  constexpr double drift = 0.03;        // m per m
  constexpr double turn_drift = 0.005;  // rad per m
  const double between = std::abs(other.travel - one.travel);
  const Pose2 expected = one.place.map_from_robot * inverse(run_from_node[one.node]) * run_from_node[other.node];
  return distance(expected, other.place.map_from_robot) < metres + drift * between &&
         heading_difference(expected, other.place.map_from_robot) < radians + turn_drift * between;
}

std::vector<Answer> answers(const SessionView& earlier, const SessionView& run, SessionJoin& summary) {
  GlobalPlaces places;
  static_cast<void>(
      places.update(earlier.scans, earlier.graph.map_from_node, earlier.scans.size(), earlier.scans.size() + 1));
  const std::vector<Pose2>& poses = run.graph.map_from_node;
  std::vector<Answer> found;
  double travel = 0;
  double way_of_query = -query_travel;
  double way = 0;  // turning counts, too
  for (std::uint32_t node = 0; node < poses.size(); ++node) {
    if (node > 0) {
      const double step = distance(poses[node - 1], poses[node]);
      travel += step;
      way += step + query_travel * heading_difference(poses[node - 1], poses[node]);
    }
    if (way - way_of_query < query_travel) { continue; }
    way_of_query = way;
    ++summary.queries;
    const auto place = places.find(run.scans[node].scan);
    if (place) { found.push_back({node, travel, *place}); }
  }
  summary.found = found.size();
  return found;
}

/// The answers that agree with the one that most agree with.
std::vector<Answer> largest_agreement(std::span<const Answer> all, std::span<const Pose2> run_from_node) {
  std::vector<Answer> largest;
  for (const Answer& one : all) {
    std::vector<Answer> agreeing;
    for (const Answer& other : all) {
      if (agree(one, other, run_from_node)) { agreeing.push_back(other); }
    }
    if (agreeing.size() > largest.size()) { largest = std::move(agreeing); }
  }
  return largest;
}

void add_edges(std::vector<PoseEdge>& edges, const Answer& answer, std::span<const Pose2> map_from_node) {
  constexpr std::size_t count = 3;
  std::vector<std::pair<double, std::uint32_t>> near;
  near.reserve(map_from_node.size());
  for (std::uint32_t node = 0; node < map_from_node.size(); ++node) {
    near.emplace_back(distance(map_from_node[node], answer.place.map_from_robot) +
                          0.5 * heading_difference(map_from_node[node], answer.place.map_from_robot),
                      node);
  }
  const std::size_t kept = std::min(count, near.size());
  std::ranges::partial_sort(near, near.begin() + static_cast<std::ptrdiff_t>(kept));
  near.resize(kept);
  for (const auto& [apart, node] : near) {
    edges.push_back({node, answer.node, inverse(map_from_node[node]) * answer.place.map_from_robot,
                     answer.place.information / static_cast<double>(kept), EdgeKind::loop});
  }
}

}  // namespace

SessionPlace find_session(const SessionView& earlier, const SessionView& run) {
  SessionPlace joined;
  const std::vector<Answer> all = answers(earlier, run, joined.summary);
  const std::vector<Answer> agreeing = largest_agreement(all, run.graph.map_from_node);
  // Half of the answers may be wrong, not more: two places that look alike would each have their followers.
  if (agreeing.size() < least_agreeing || 2 * agreeing.size() < all.size()) { return joined; }
  joined.summary.agreeing = agreeing.size();
  const Answer& middle = agreeing[agreeing.size() / 2];
  joined.earlier_from_run = middle.place.map_from_robot * inverse(run.graph.map_from_node[middle.node]);
  for (const Answer& answer : agreeing) { add_edges(joined.edges, answer, earlier.graph.map_from_node); }
  return joined;
}

}  // namespace flirt
