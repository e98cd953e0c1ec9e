#include "flirt/slam/scan_front_end.hpp"

#include "flirt/registration/window_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace flirt {
namespace {

constexpr std::size_t fewest_points = 15;  // of a scan that can be placed at all
constexpr double fewest_known = 8;         // of its points, by their weights, must lie on known surfaces
constexpr std::uint32_t most_blind = 3;    // scans in a row without a believable pose
constexpr double well_held = 5;            // score by which a pose leads where odometry is compared with it
constexpr double other_way = 0.3;          // rad, between poses that look in different directions

/// Metres plus half a metre a radian: turning shows new things, too.
double way(const Pose2& motion) {
  return norm(motion.translation()) + 0.5 * std::abs(motion.theta);
}

}  // namespace

/// Score lost by leaving the prediction. Odometry's own deviation counts as in Student's distribution with three
/// degrees of freedom: wheels may slip.
double ScanFrontEnd::surprise(const Prediction& prediction, const Pose2& local_from_robot) const {
  constexpr double odometry_weight = 0.3;
  const Pose2 off = inverse(prediction.local_from_robot) * local_from_robot;
  const double way = norm(off.translation());
  const double deviations = prediction.odometry ? way / *prediction.odometry : 0;
  return params_.surprise_translation * way + params_.surprise_rotation * std::abs(off.theta) +
         odometry_weight * std::log1p(deviations * deviations / 3);
}

ScanFrontEnd::Judged ScanFrontEnd::judge(const SurfacePoints& points, const Pose2& start,
                                         const Prediction& prediction) const {
  // Holds directions in which nothing is known: as much as two points would.
  const AlignmentPrior stay{start, Eigen::Vector3d(2, 2, 2).asDiagonal()};
  const std::span<const SurfacePoints> scan(&points, 1);
  const AlignedPose aligned = align_to_map(map_, scan, start, stay);
  const Agreed agreed = map_.agreement(scan, aligned.map_from_robot);
  const double known = std::max(0.05, 1 - agreed.unknown);
  const double score = score_of(agreed);
  const double lost = surprise(prediction, aligned.map_from_robot);
  const double quality = (score - agreed.unknown) / known;
  return {aligned.map_from_robot, aligned.terms, score - lost, quality, quality - lost};
}

std::vector<ScanFrontEnd::Judged> ScanFrontEnd::search(const SurfacePoints& points, const Prediction& prediction,
                                                       double extent, double turn) const {
  constexpr double keep = 0.85;  // of the best value, else a candidate is not refined
  const SearchWindow window{.map_from_robot = prediction.local_from_robot,
                            .half_extent = extent,
                            .half_turn = turn,
                            .candidates = 4,
                            .keep = keep};
  const std::vector<WindowPose> candidates = search_window(map_, std::span(&points, 1), window);
  std::vector<Judged> judged;
  for (const WindowPose& candidate : candidates) {
    if (candidate.value < keep * candidates.front().value) { break; }
    judged.push_back(judge(points, candidate.map_from_robot, prediction));
  }
  return judged;
}

void ScanFrontEnd::extract_keypoints(SlamScan& scan) {
  if (!scan.keypoints.x.empty() || scan.scan.ranges.empty()) { return; }
  scan.features = extractor_.extract(scan.scan);
  scan.keypoints = table_of(scan.features.keypoints);
}

/// The poses that the keypoints of the last scans give.
std::vector<ScanFrontEnd::Judged> ScanFrontEnd::match_keypoints(const SlamScan& scan, const Prediction& prediction) {
  constexpr std::size_t most = 6;  // scans
  std::vector<Judged> judged;
  if (params_.front_end != FrontEndKind::automatic) { return judged; }
  SlamScan query{.scan = scan.scan};
  extract_keypoints(query);
  if (query.keypoints.x.empty()) { return judged; }
  matcher_.set_query(query.columns());
  const std::size_t count = std::min(most, map_scans_.size());
  for (std::size_t k = 0; k < count; ++k) {
    MapScan& earlier = map_scans_[map_scans_.size() - 1 - k];
    extract_keypoints(earlier.scan);
    if (earlier.scan.keypoints.x.empty()) { continue; }
    const auto found = matcher_.align(earlier.scan.columns());
    if (!found) { continue; }
    const Pose2 local_from_sensor =
        earlier.local_from_robot * earlier.scan.scan.robot_from_sensor * found->reference_from_query;
    const Pose2 local_from_robot = local_from_sensor * inverse(scan.scan.robot_from_sensor);
    judged.push_back(judge(scan.points, local_from_robot, prediction));
  }
  return judged;
}

/// How far a wide search reaches: as far as the robot moved lately, and a half more.
double ScanFrontEnd::wide_extent() const {
  return std::clamp(1.5 * reckoning_.longest_step(), params_.wide_extent, params_.widest_extent);
}

/// The farthest of the poses elsewhere that are nearly as plausible as the best: doors along a corridor look alike, and
/// so do its two ends.
std::optional<Pose2> ScanFrontEnd::rival(std::span<const Judged> tried, const Judged& best) const {
  constexpr double elsewhere = 0.4;  // m
  const auto apart = [&](const Pose2& pose) { return distance(pose, best.local_from_robot); };
  std::optional<Pose2> rival;
  for (const Judged& other : tried) {
    const Pose2& pose = other.local_from_robot;
    const bool is_elsewhere = apart(pose) > elsewhere || heading_difference(pose, best.local_from_robot) > other_way;
    const bool is_equal = other.plausible > best.plausible - params_.rival_lead;
    if (is_elsewhere && is_equal && (!rival || apart(pose) > apart(*rival))) { rival = pose; }
  }
  return rival;
}

bool ScanFrontEnd::is_believable(const std::optional<Placed>& placed) const {
  return placed && placed->best.quality >= params_.usable_score && placed->best.terms.weight >= fewest_known;
}

/// The best pose that was found, if the scan says anything.
std::optional<ScanFrontEnd::Placed> ScanFrontEnd::place(const SlamScan& scan, const Prediction& prediction) {
  if (scan.points.size() < fewest_points || map_.scans() == 0) { return std::nullopt; }
  const bool odometry = prediction.odometry.has_value();
  std::vector<Judged> tried{judge(scan.points, prediction.local_from_robot, prediction)};
  std::size_t best = 0;
  MotionSource source = MotionSource::narrow;
  const auto consider = [&](const std::vector<Judged>& others, MotionSource from) {
    for (const Judged& other : others) {
      tried.push_back(other);
      if (other.score > tried[best].score) {
        best = tried.size() - 1;
        source = from;
      }
    }
  };
  const auto answer = [&] { return Placed{tried[best], source, rival(tried, tried[best])}; };
  consider(search(scan.points, prediction, odometry ? params_.odometry_extent : params_.narrow_extent,
                  odometry ? params_.odometry_turn : params_.narrow_turn),
           MotionSource::narrow);
  if (tried[best].score >= params_.convincing_score) { return answer(); }
  const double turn = odometry ? 4 * params_.odometry_turn : std::numbers::pi;
  consider(search(scan.points, prediction, params_.wide_extent, turn), MotionSource::wide);
  // Where scans are far apart, or nothing else helps, a pose that is in doubt has rivals farther away.
  const double extent = wide_extent();
  const bool far_apart = !odometry && extent > params_.wide_extent;
  const double doubtful = far_apart ? params_.suspect_score : params_.usable_score;
  if (tried[best].score >= doubtful) { return answer(); }
  consider(match_keypoints(scan, prediction), MotionSource::wide);
  if (tried[best].score >= doubtful || !far_apart) { return answer(); }
  consider(search(scan.points, prediction, extent, turn), MotionSource::wide);
  return answer();
}

/// By odometry, unless it jumps and the scan tells more near the pose before.
ScanFrontEnd::Attempt ScanFrontEnd::placed_despite_jumps(const SlamScan& scan) {
  const auto attempt = [&](const Prediction& prediction) { return Attempt{prediction, place(scan, prediction)}; };
  const OdometryJump jump = reckoning_.odometry_jump(scan);
  const Prediction by_odometry = predicted(scan);
  if (jump == OdometryJump::none) { return attempt(by_odometry); }
  const Prediction as_before{recent_.back() * reckoning_.last_motion(), std::nullopt};
  if (jump == OdometryJump::perhaps) {
    Attempt told = attempt(by_odometry);
    if (is_believable(told.placed)) { return told; }
    Attempt near = attempt(as_before);
    return is_believable(near.placed) ? near : told;
  }
  Attempt near = attempt(as_before);
  return is_believable(near.placed) || jump == OdometryJump::certain ? near : attempt(by_odometry);
}

void ScanFrontEnd::add_to_map(const SlamScan& scan, const Pose2& local_from_robot) {
  const SurfacePoints& points = scan.points;
  constexpr double closest = 0.1;  // m of way; a robot that stands still says nothing new
  constexpr double longest = 20;   // m
  if (points.size() < fewest_points) { return; }
  if (!map_scans_.empty() && travel_ - map_scans_.back().travel < closest) { return; }
  map_.add(points, local_from_robot);
  map_scans_.push_back({scan, local_from_robot, travel_});
  const auto obsolete = [&] {
    if (params_.window > 0) { return map_scans_.size() > params_.window; }
    const double after = travel_ - map_scans_[1].travel;
    return (map_scans_.size() > params_.map_scans && after >= params_.map_travel) || after > longest;
  };
  while (map_scans_.size() > 1 && obsolete()) {
    map_.remove(map_scans_.front().scan.points, map_scans_.front().local_from_robot);
    map_scans_.pop_front();
  }
}

/// Begins a new local map with the scan: the old one no longer helps.
void ScanFrontEnd::restart(const SlamScan& scan, const Pose2& local_from_robot) {
  for (const MapScan& old : map_scans_) { map_.remove(old.scan.points, old.local_from_robot); }
  map_scans_.clear();
  blind_ = 0;
  add_to_map(scan, local_from_robot);
}

void ScanFrontEnd::remember(const SlamScan& scan, const Pose2& local_from_robot) {
  constexpr std::size_t remembered = 4;
  Pose2 motion;
  if (!recent_.empty()) {
    motion = inverse(recent_.back()) * local_from_robot;
    travel_ += way(motion);
  }
  recent_.push_back(local_from_robot);
  if (recent_.size() > remembered) { recent_.erase(recent_.begin()); }
  reckoning_.remember(scan, motion);
  add_to_map(scan, local_from_robot);
}

/// Deviations of a motion where the scan does not tell, m and rad. Odometry is never off by much, unless the scan fits
/// nowhere: then the robot may have been carried. Without it the motion before is off by as far as is searched.
Eigen::Vector3d ScanFrontEnd::unmeasured(const ScanMotion& motion, const Prediction& prediction) const {
  constexpr double rotation = 1;  // rad
  const bool fits_nowhere = motion.source == MotionSource::prediction;
  if (fits_nowhere && !prediction.odometry) {
    const double translation = 0.5 * wide_extent();  // two deviations
    return {translation, translation, rotation};
  }
  const double translation =
      fits_nowhere ? params_.floor_translation : prediction.odometry.value_or(params_.floor_translation);
  return {translation, translation, params_.floor_rotation};
}

void ScanFrontEnd::add_relative(ScanMotion& motion, const Judged& found, const Eigen::Vector3d& floor) const {
  const Eigen::Matrix3d least = floor.cwiseProduct(floor).cwiseInverse().asDiagonal();
  const Eigen::Matrix3d information = edge_information(found.terms.information, params_.range_sigma, least);
  for (const std::uint32_t back : {1U, 3U}) {
    // Across a motion that was not seen a longer edge would claim to know it.
    if (recent_.size() < back || (back > 1 && seen_in_a_row_ < back)) { break; }
    const Pose2& earlier = recent_[recent_.size() - back];
    motion.relative.push_back({back, inverse(earlier) * found.local_from_robot, information});
  }
}

/// Moves what was found along a direction, frame of the robot, by a share of the way to another pose.
void ScanFrontEnd::move_towards(const Pose2& other, Point2 direction_in_robot, double share, Judged& found) {
  const Point2 direction = Pose2{0, 0, found.local_from_robot.theta} * direction_in_robot;
  const double off = share * dot(direction, other.translation() - found.local_from_robot.translation());
  found.local_from_robot.x += off * direction.x;
  found.local_from_robot.y += off * direction.y;
}

/// Along a direction of which the scan says nothing the prediction stands. Not so where what the scan says is in doubt:
/// then the prediction is no better.
void ScanFrontEnd::give_up_direction(Judged& found, const Pose2& prediction, const Hold& hold) {
  know_at_most(0, hold.direction, found.terms.information);
  if (hold.doubted) { return; }
  move_towards(prediction, hold.direction, 1, found);
}

ScanFrontEnd::Prediction ScanFrontEnd::predicted(const SlamScan& scan) const {
  constexpr double least = 0.005;  // m
  const Pose2 motion = reckoning_.motion(scan);
  if (!reckoning_.uses_odometry(scan)) { return {recent_.back() * motion, std::nullopt}; }
  return {recent_.back() * odometry_error_.corrected(motion),
          std::clamp(odometry_error_.deviation(motion), least, params_.floor_translation)};
}

/// Along the direction that holds the scan least, what odometry tells counts by its own deviation.
void ScanFrontEnd::weigh_direction(Judged& found, const Prediction& prediction, const Hold& hold) const {
  if (!prediction.odometry) { return; }
  const double seen = inverse_deviation(hold, params_);
  const double told = 1 / *prediction.odometry;
  const double sum = seen * seen + told * told;
  if (know_at_most(sum * params_.range_sigma * params_.range_sigma, hold.direction, found.terms.information)) {
    move_towards(prediction.local_from_robot, hold.direction, told * told / sum, found);
  }
}

/// Nothing counts as measured of which of two places it is. Returns by how much they differ, m and rad.
Eigen::Vector3d ScanFrontEnd::give_up_towards(const Pose2& rival, Judged& found) {
  const Pose2 off = inverse(found.local_from_robot) * rival;
  const double apart = norm(off.translation());
  const double turn = std::abs(off.theta);
  if (turn > other_way) {
    found.terms.information.setZero();
  } else {
    know_at_most(0, {off.x / apart, off.y / apart}, found.terms.information);
  }
  return {apart, apart, turn};
}

ScanMotion ScanFrontEnd::add(const SlamScan& scan) {
  ScanMotion motion;
  if (recent_.empty()) {
    // Cells of the local map lie differently for another start, as they would for another run.
    remember(scan, {params_.start_x, params_.start_y, params_.start_theta});
    return motion;
  }
  const auto [prediction, placed] = placed_despite_jumps(scan);
  Judged found{prediction.local_from_robot, {}, -1e9};
  std::optional<Pose2> rival;
  motion.source = MotionSource::prediction;
  if (placed) { motion.score = placed->best.score; }
  if (is_believable(placed)) {
    found = placed->best;
    motion.source = placed->source;
    if (!prediction.odometry) { rival = placed->rival; }  // odometry tells them apart
  }
  const Hold hold = hold_of(std::span(&scan.points, 1), map_, found.local_from_robot);
  Eigen::Vector3d floor = unmeasured(motion, prediction);
  if (rival) {
    motion.unobservable = true;
    floor = floor.cwiseMax(give_up_towards(*rival, found));
  } else if (motion.source == MotionSource::prediction || !holds(hold, params_)) {
    motion.unobservable = true;
    give_up_direction(found, prediction.local_from_robot, hold);
  } else {
    weigh_direction(found, prediction, hold);
  }
  seen_in_a_row_ = motion.unobservable ? 0 : seen_in_a_row_ + 1;
  add_relative(motion, found, floor);
  if (prediction.odometry && !motion.unobservable && hold.lead >= well_held) {
    odometry_error_.learn(reckoning_.motion(scan), inverse(recent_.back()) * found.local_from_robot);
  }
  remember(scan, found.local_from_robot);
  blind_ = motion.source == MotionSource::prediction ? blind_ + 1 : 0;
  if (blind_ > 0) { reckoning_.forget_motion(); }
  if (blind_ == most_blind) { restart(scan, found.local_from_robot); }
  return motion;
}

}  // namespace flirt
