#include "flirt/io/frames.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <cmath>

namespace flirt::ros {

namespace {

constexpr double reach = 1.0;        // s, of a pose beyond the ends of its stretch; stamps out of order go back by less
constexpr double longest_gap = 1.5;  // s, that is interpolated when the robot moved

double stamp_of(const auto& sample) {
  return sample.moment.stamp;
}

bool are_equal(const auto& a, const auto& b) {
  return a.pose.matrix() == b.pose.matrix();
}

/// How far the stamp lies from those of the poses of a stretch that were recorded just before and after its message.
double gap_to(const auto& stretch, const Moment& moment) {
  const auto after =
      std::ranges::upper_bound(stretch, moment.message, {}, [](const auto& sample) { return sample.moment.message; });
  const double one = stamp_of(after == stretch.begin() ? *after : *(after - 1));
  const double other = stamp_of(after == stretch.end() ? *(after - 1) : *after);
  return std::max({0.0, std::min(one, other) - moment.stamp, moment.stamp - std::max(one, other)});
}

}  // namespace

void PosesOverTime::add(const Moment& moment, const Eigen::Isometry3d& pose) {
  if (stretches_.empty() || moment.stamp < latest_ - reach) {
    stretches_.emplace_back();
    latest_ = moment.stamp;
  }
  latest_ = std::max(latest_, moment.stamp);
  Stretch& stretch = stretches_.back();
  const std::size_t count = stretch.size();
  const Sample sample{moment, pose};
  const bool stays = count >= 2 && are_equal(stretch[count - 1], sample) && are_equal(stretch[count - 2], sample) &&
                     moment.stamp >= stamp_of(stretch.back());
  if (stays) { stretch.pop_back(); }
  stretch.push_back(sample);
}

void PosesOverTime::sort() {
  for (Stretch& stretch : stretches_) {
    std::ranges::stable_sort(stretch, {}, stamp_of<Sample>);
    std::size_t message = 0;
    for (Sample& sample : stretch) {  // in order by both, for searches by either
      message = std::max(message, sample.moment.message);
      sample.moment.message = message;
    }
  }
}

bool PosesOverTime::is_constant() const {
  return std::ranges::all_of(stretches_, [&](const Stretch& stretch) {
    return std::ranges::all_of(stretch,
                               [&](const Sample& sample) { return are_equal(sample, stretches_.front().front()); });
  });
}

const PosesOverTime::Stretch& PosesOverTime::stretch_of(const Moment& moment) const {
  FLIRT_ASSERT(!stretches_.empty());
  const auto next = std::ranges::upper_bound(stretches_, moment.message, {},
                                             [](const Stretch& stretch) { return stretch.front().moment.message; });
  const auto current = next == stretches_.begin() ? next : next - 1;
  auto best = current;
  double least = gap_to(*current, moment);
  // Messages overtake each other: the scan may be the last of the stretch before, or the first of the next.
  if (least <= reach) { return *current; }
  if (current != stretches_.begin() && gap_to(*(current - 1), moment) < least) {
    best = current - 1;
    least = gap_to(*best, moment);
  }
  if (current + 1 != stretches_.end() && gap_to(*(current + 1), moment) < least) { best = current + 1; }
  return *best;
}

Eigen::Isometry3d PosesOverTime::at(const Moment& moment) const {
  const Stretch& stretch = stretch_of(moment);
  const auto after = std::ranges::lower_bound(stretch, moment.stamp, {}, stamp_of<Sample>);
  if (after == stretch.begin()) { return stretch.front().pose; }
  if (after == stretch.end()) { return stretch.back().pose; }
  const Sample& before = *(after - 1);
  if (are_equal(before, *after)) { return before.pose; }
  const double share = (moment.stamp - stamp_of(before)) / (stamp_of(*after) - stamp_of(before));
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(before.pose.rotation()).slerp(share, Eigen::Quaterniond(after->pose.rotation()));
  const Eigen::Vector3d translation = (1.0 - share) * before.pose.translation() + share * after->pose.translation();
  return Eigen::Isometry3d(Eigen::Translation3d(translation) * rotation);
}

bool PosesOverTime::covers(const Moment& moment) const {
  if (stretches_.empty()) { return false; }
  if (is_constant()) { return true; }
  const Stretch& stretch = stretch_of(moment);
  const auto after = std::ranges::lower_bound(stretch, moment.stamp, {}, stamp_of<Sample>);
  if (after == stretch.end()) { return moment.stamp <= stamp_of(stretch.back()) + reach; }
  if (after == stretch.begin() || stamp_of(*after) == moment.stamp) {
    return moment.stamp >= stamp_of(stretch.front()) - reach;
  }
  const Sample& before = *(after - 1);
  return are_equal(before, *after) || stamp_of(*after) - stamp_of(before) <= longest_gap;
}

void Frames::add(const Transform& transform, std::size_t message) {
  if (transform.parent == transform.child) { return; }
  const auto [edge, is_new] = edges_.try_emplace(transform.child, Edge{transform.parent, {}});
  if (edge->second.parent != transform.parent) { return; }
  edge->second.parent_from_child.add({transform.stamp, message}, transform.parent_from_child);
}

void Frames::sort() {
  for (auto& [child, edge] : edges_) { edge.parent_from_child.sort(); }
}

std::vector<std::string> Frames::chain(const std::string& frame) const {
  std::vector<std::string> frames{frame};
  for (auto edge = edges_.find(frame); edge != edges_.end(); edge = edges_.find(frames.back())) {
    if (std::ranges::find(frames, edge->second.parent) != frames.end()) { break; }  // a ring
    frames.push_back(edge->second.parent);
  }
  return frames;
}

std::optional<Eigen::Isometry3d> Frames::ancestor_from(const std::string& ancestor, const std::string& frame,
                                                       const Moment& moment) const {
  Eigen::Isometry3d here_from_frame = Eigen::Isometry3d::Identity();
  for (const std::string& here : chain(frame)) {
    if (here == ancestor) { return here_from_frame; }
    const auto edge = edges_.find(here);
    if (edge == edges_.end()) { break; }
    here_from_frame = edge->second.parent_from_child.at(moment) * here_from_frame;
  }
  return std::nullopt;
}

std::optional<Eigen::Isometry3d> Frames::target_from_source(const std::string& target, const std::string& source,
                                                            const Moment& moment) const {
  const std::vector<std::string> of_target = chain(target);
  const std::vector<std::string> of_source = chain(source);
  const auto common = std::ranges::find_first_of(of_source, of_target);
  if (common == of_source.end()) { return std::nullopt; }
  const auto common_from_target = ancestor_from(*common, target, moment);
  const auto common_from_source = ancestor_from(*common, source, moment);
  if (!common_from_target || !common_from_source) { return std::nullopt; }
  return common_from_target->inverse() * *common_from_source;
}

bool Frames::covers(const std::string& frame, const Moment& moment) const {
  const auto edge = edges_.find(frame);
  return edge != edges_.end() && edge->second.parent_from_child.covers(moment);
}

Pose2 planar(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d rotation = pose.rotation();
  return {pose.translation().x(), pose.translation().y(), std::atan2(rotation(1, 0), rotation(0, 0))};
}

}  // namespace flirt::ros
