#include "flirt/slam/loop_closer.hpp"

#include "flirt/registration/window_search.hpp"
#include "flirt/slam/hold.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flirt {
namespace {

constexpr double sight = 6;          // m from the robot within which earlier scans are gathered
constexpr double most_surprise = 4;  // parts of the likely drift that no evidence makes up for
constexpr double distinct_distance = 0.5;
const double distinct_heading = radians_from_degrees(10);

bool same_place(const Pose2& a, const Pose2& b, double metres, double radians) {
  return distance(a, b) < metres && heading_difference(a, b) < radians;
}

/// Whether two queries found the same displacement of the graph.
template <class Found>
bool agree(const Found& one, const Found& other, std::span<const Pose2> map_from_node) {
  constexpr double metres = 0.3;
  const double radians = radians_from_degrees(3);
  const Pose2 expected = one.map_from_robot * inverse(map_from_node[one.node]) * map_from_node[other.node];
  return same_place(expected, other.map_from_robot, metres, radians);
}

bool reaches_before(std::span<const Closure> closures, std::size_t node) {
  return std::ranges::any_of(closures, [&](const Closure& closure) {
    return std::ranges::any_of(closure.edges, [&](const PoseEdge& edge) { return edge.a < node && node <= edge.b; });
  });
}

}  // namespace

std::vector<SurfacePoints> LoopCloser::query_scans(std::span<const SlamScan> scans,
                                                   std::span<const Pose2> map_from_node) const {
  constexpr std::size_t stride = 2;
  const std::size_t newest = scans.size() - 1;
  std::size_t oldest = newest;
  while (oldest > last_unseen_ && travel_[newest] - travel_[oldest - 1] <= params_.loop_query_travel) { --oldest; }
  const std::size_t count = std::min<std::size_t>(params_.loop_query_scans, newest - oldest + 1);
  std::vector<SurfacePoints> query;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t node = newest - k * (newest - oldest) / std::max<std::size_t>(1, count - 1);
    query.push_back(seen_from(scans[node].points, inverse(map_from_node[newest]) * map_from_node[node], stride));
  }
  return query;
}

/// Whether a place was left long ago: some way, and many scans or a long way.
bool LoopCloser::is_earlier(std::size_t node) const {
  const double way = travel_.back() - travel_[node];
  const bool many_scans = node + params_.loop_min_scans < travel_.size();
  return way >= params_.loop_min_travel && (many_scans || way >= params_.global_min_travel);
}

/// Brings the map of earlier scans up to date: those near the robot, where they are now. False when there are none.
bool LoopCloser::gather(std::span<const SlamScan> scans, std::span<const Pose2> map_from_node, const Pose2& around,
                        double radius) {
  constexpr double moved = 0.03;    // m, a scan that the graph moved more is placed anew
  constexpr double turned = 0.005;  // rad
  constexpr double spacing = 0.35;  // m, between scans that look the same way
  const double same_way = radians_from_degrees(30);
  constexpr double slack = 3;  // m, before a scan is dropped again
  std::erase_if(placed_, [&](const Placed& placed) {
    const bool stays = distance(placed.map_from_node, around) < radius + slack &&
                       same_place(placed.map_from_node, map_from_node[placed.node], moved, turned);
    if (!stays) { map_.remove(scans[placed.node].points, placed.map_from_node); }
    return !stays;
  });
  for (std::size_t node = 0; node < map_from_node.size() && is_earlier(node); ++node) {
    if (distance(map_from_node[node], around) >= radius || scans[node].points.size() == 0) { continue; }
    const bool known = std::ranges::any_of(placed_, [&](const Placed& placed) {
      return placed.node == node || same_place(placed.map_from_node, map_from_node[node], spacing, same_way);
    });
    if (known) { continue; }
    placed_.push_back({node, map_from_node[node]});
    map_.add(scans[node].points, map_from_node[node]);
  }
  return !placed_.empty();
}

std::optional<LoopCloser::Found> LoopCloser::search(std::span<const SurfacePoints> query, std::size_t node,
                                                    const Pose2& at, double extent, double turn) const {
  constexpr double keep = 0.6;
  const SearchWindow window{.map_from_robot = at,
                            .half_extent = extent,
                            .half_turn = turn,
                            .most_points = 150,
                            .candidates = 8,
                            .keep = keep};
  const std::vector<WindowPose> candidates = search_window(map_, query, window);
  Found best{.node = node, .score = -1e9};
  std::vector<std::pair<Pose2, double>> judged;
  Agreed agreed;
  for (const WindowPose& candidate : candidates) {
    if (candidate.value < keep * candidates.front().value) { break; }
    const AlignmentPrior stay{candidate.map_from_robot, Eigen::Vector3d(2, 2, 2).asDiagonal()};
    const AlignedPose aligned = align_to_map(map_, query, candidate.map_from_robot, stay);
    const Agreed agreement = map_.agreement(query, aligned.map_from_robot);
    const double score = score_of(agreement);
    judged.emplace_back(aligned.map_from_robot, score);
    if (score <= best.score) { continue; }
    best.score = score;
    best.map_from_robot = aligned.map_from_robot;
    best.information = aligned.terms.information;
    agreed = agreement;
  }
  double second = 0;
  for (const auto& [pose, score] : judged) {
    if (!same_place(pose, best.map_from_robot, distinct_distance, distinct_heading)) {
      second = std::max(second, score);
    }
  }
  best.margin = best.score - second;
  const bool good =
      best.score >= params_.loop_score && best.margin >= params_.loop_margin && agreed.unknown <= params_.loop_unknown;
  if (!good) { return std::nullopt; }
  // Down a corridor the next candidate may lie far away, and all between look the same.
  const Hold hold = hold_of(query, map_, best.map_from_robot);
  if (hold.doubted || hold.lead < params_.loop_lead) { return std::nullopt; }
  const double seen = params_.range_sigma * inverse_deviation(hold, params_);
  know_at_most(seen * seen, hold.direction, best.information);
  return best;
}

Closure LoopCloser::closure(const Found& found, std::span<const Pose2> map_from_node) const {
  Closure closure;
  const Pose2 off = inverse(map_from_node[found.node]) * found.map_from_robot;
  closure.translation = norm(off.translation());
  closure.rotation = std::abs(off.theta);
  closure.source = found.source;
  const double share = 1.0 / static_cast<double>(found.near.size());
  const Eigen::Matrix3d information =
      share * edge_information(found.information, params_.range_sigma, Eigen::Matrix3d::Identity());
  for (std::size_t i = 0; i < found.near.size(); ++i) {
    closure.edges.push_back({static_cast<std::uint32_t>(found.near[i]), static_cast<std::uint32_t>(found.node),
                             inverse(found.map_from_near[i]) * found.map_from_robot, information, EdgeKind::loop});
  }
  return closure;
}

/// The earlier scans that a place found is tied to.
void LoopCloser::add_nearest(Found& found) const {
  constexpr std::size_t edges = 3;
  std::vector<Placed> near = placed_;
  std::ranges::sort(near, {}, [&](const Placed& placed) {
    return distance(placed.map_from_node, found.map_from_robot) +
           0.5 * heading_difference(placed.map_from_node, found.map_from_robot);
  });
  near.resize(std::min(edges, near.size()));
  for (const Placed& placed : near) {
    found.near.push_back(placed.node);
    found.map_from_near.push_back(placed.map_from_node);
  }
}

std::vector<Closure> LoopCloser::closures(std::span<const Found> agreeing, std::span<const Pose2> map_from_node) const {
  std::vector<Closure> found;
  found.reserve(agreeing.size());
  for (const Found& place : agreeing) { found.push_back(closure(place, map_from_node)); }
  return found;
}

/// By how much the graph may well be off after the way since the last closure, m and rad.
LoopCloser::Drift LoopCloser::likely_drift() const {
  const double since = travel_.back() - last_closure_;
  constexpr double deviations = 3;
  return {params_.loop_drift + params_.loop_drift_growth * since + deviations * std::sqrt(unseen_),
          params_.loop_turn + params_.loop_turn_drift_growth * since + deviations * std::sqrt(unseen_turn_)};
}

/// How far around the pose in the graph earlier visits are looked for, m and rad.
LoopCloser::Drift LoopCloser::window() const {
  const double since = travel_.back() - last_closure_;
  return {std::min(params_.loop_extent + params_.loop_extent_growth * since, params_.loop_extent_most),
          std::min({params_.loop_turn + params_.loop_turn_growth * since, most_surprise * likely_drift().rotation,
                    std::numbers::pi})};
}

/// By how much the graph is off if the place found is right, in parts of what is likely.
double LoopCloser::surprise(const Found& found, std::span<const Pose2> map_from_node) const {
  const Drift likely = likely_drift();
  const Pose2 off = inverse(map_from_node[found.node]) * found.map_from_robot;
  return std::max(norm(off.translation()) / likely.translation, std::abs(off.theta) / likely.rotation);
}

/// Whether places that agree were found over so long a way that a room's twin would have been left.
bool LoopCloser::is_sure(std::span<const Found> agreeing) const {
  constexpr std::size_t fewest = 3;
  return agreeing.size() >= fewest &&
         travel_[agreeing.back().node] - travel_[agreeing.front().node] >= params_.loop_sure_travel;
}

/// Drops places that contradict a new one, and those too far back to confirm it.
void LoopCloser::forget(std::vector<Found>& waiting, const Found& newest, std::span<const Pose2> map_from_node) const {
  std::erase_if(waiting, [&](const Found& other) {
    return travel_[newest.node] - travel_[other.node] > params_.global_forget_travel ||
           !agree(other, newest, map_from_node);
  });
}

/// Earlier visits in a window around the pose in the graph, wider the longer none was found.
std::vector<Closure> LoopCloser::near(std::span<const SlamScan> scans, std::span<const Pose2> map_from_node,
                                      std::span<const SurfacePoints> query) {
  const std::size_t node = scans.size() - 1;
  const Drift reach = window();
  if (!gather(scans, map_from_node, map_from_node[node], sight + reach.translation)) { return {}; }
  std::optional<Found> found = search(query, node, map_from_node[node], reach.translation, reach.rotation);
  if (!found) { return {}; }
  const double surprising = surprise(*found, map_from_node);
  if (!lost_at_ && surprising > most_surprise) { return {}; }
  add_nearest(*found);
  found->query = queries_;
  forget(waiting_, *found, map_from_node);
  const bool is_clear = found->margin >= params_.loop_clear_margin;
  const bool follows = !waiting_.empty() && waiting_.back().query + 1 == queries_;
  waiting_.push_back(*std::move(found));
  std::span<const Found> agreeing = waiting_;
  if (surprising <= 1) {
    if (!is_clear && !follows) { return {}; }
    agreeing = agreeing.last(follows ? 2 : 1);
  } else if (!is_sure(agreeing)) {
    return {};
  }
  std::vector<Closure> found_closures = closures(agreeing, map_from_node);
  waiting_.clear();
  return found_closures;
}

/// Earlier visits anywhere in the map.
std::vector<Closure> LoopCloser::anywhere(std::span<const SlamScan> scans, std::span<const Pose2> map_from_node,
                                          std::span<const SurfacePoints> query) {
  constexpr double extent = 0.4;
  constexpr std::size_t most_placed = 40;  // scans at once, so that none has to wait long; the rest when asked next
  const double turn = radians_from_degrees(6);
  const std::size_t node = scans.size() - 1;
  const double travel = travel_.back();
  const double every = waiting_anywhere_.empty() ? params_.global_every : params_.global_agree_travel;
  // Where the window around the pose in the graph holds all that is likely, what lies outside it is a corridor's or a
  // room's twin.
  const Drift likely = likely_drift();
  const Drift reach = window();
  const bool is_in_window = likely.translation <= reach.translation && likely.rotation <= reach.rotation;
  if (!lost_at_ && (unseen_ == 0 || is_in_window)) { return {}; }
  // A closure that does not span the motion after which the robot was lost says nothing of where it is.
  const double since = travel - (lost_at_ ? std::min(last_closure_, travel_[*lost_at_]) : last_closure_);
  const bool is_due = since >= params_.global_after && travel - last_search_ >= every;
  const bool is_prepared = lost_at_ && since >= params_.global_after / 3;  // who is lost then has the map ready
  if (!is_due && !is_prepared) { return {}; }
  const bool is_ready = places_ready_ && *places_ready_ + 1 == queries_;
  if (!is_due || !is_ready) {  // to bring the map up to date and to search it would be too much for one scan
    const auto first_recent = std::ranges::upper_bound(travel_, travel - params_.global_min_travel);
    const auto earlier = static_cast<std::size_t>(first_recent - travel_.begin());
    if (places_.update(scans, map_from_node, earlier, most_placed)) { places_ready_ = queries_; }
    return {};
  }
  last_search_ = travel;
  const std::optional<FoundPlace> place = places_.find(scans[node].scan);
  if (!place || !gather(scans, map_from_node, place->map_from_robot, sight)) { return {}; }
  std::optional<Found> found = search(query, node, place->map_from_robot, extent, turn);
  if (!found || (!lost_at_ && surprise(*found, map_from_node) > most_surprise)) { return {}; }
  found->source = ClosureSource::anywhere;
  add_nearest(*found);
  forget(waiting_anywhere_, *found, map_from_node);
  waiting_anywhere_.push_back(*std::move(found));
  if (waiting_anywhere_.size() < params_.global_agreeing || !is_sure(waiting_anywhere_)) { return {}; }
  std::vector<Closure> found_closures = closures(waiting_anywhere_, map_from_node);
  waiting_anywhere_.clear();
  return found_closures;
}

/// The way to the newest node, and how much of it was not seen well.
void LoopCloser::measure_way(const PoseGraph& graph) {
  constexpr double seen_well = 0.05;  // m, deviation; the drift of such motions grows with the way
  constexpr double seen = 0.15;       // m, that of motions that a query may span
  constexpr double lost = 0.2;        // m, in all directions: the robot may have been carried anywhere
  const std::size_t node = graph.map_from_node.size() - 1;
  if (node == 0) {
    travel_.push_back(0);
    return;
  }
  travel_.push_back(travel_.back() + distance(graph.map_from_node[node - 1], graph.map_from_node[node]));
  for (auto edge = graph.edges.rbegin(); edge != graph.edges.rend() && edge->b == node; ++edge) {
    if (edge->a + 1 != node) { continue; }
    const Eigen::Matrix3d covariance = edge->information.inverse();
    const double variance = covariance.topLeftCorner<2, 2>().trace();  // of one direction, where only that was not seen
    if (variance > seen_well * seen_well) {
      unseen_ += variance;
      unseen_turn_ += covariance(2, 2);
    }
    if (variance > seen * seen) { last_unseen_ = node; }
    const double least =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance.topLeftCorner<2, 2>()).eigenvalues().x();
    if (least > lost * lost) { lost_at_ = node; }
    break;
  }
}

std::vector<Closure> LoopCloser::add(std::span<const SlamScan> scans, const PoseGraph& graph) {
  const std::span<const Pose2> map_from_node = graph.map_from_node;
  measure_way(graph);
  if (travel_.back() - last_query_ < params_.loop_every) { return {}; }
  last_query_ = travel_.back();
  ++queries_;
  const std::vector<SurfacePoints> query = query_scans(scans, map_from_node);
  std::size_t points = 0;
  for (const SurfacePoints& scan : query) { points += scan.size(); }
  if (points < params_.loop_points) { return {}; }
  std::vector<Closure> found = near(scans, map_from_node, query);
  if (found.empty() && params_.front_end == FrontEndKind::automatic) { found = anywhere(scans, map_from_node, query); }
  if (!found.empty()) {
    last_closure_ = travel_.back();
    unseen_ = 0;
    unseen_turn_ = 0;
    if (lost_at_ && reaches_before(found, *lost_at_)) { lost_at_.reset(); }
    waiting_.clear();
    waiting_anywhere_.clear();
  }
  return found;
}

}  // namespace flirt
