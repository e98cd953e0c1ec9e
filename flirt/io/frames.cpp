#include "flirt/io/frames.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <cmath>

namespace flirt::ros {

void PosesOverTime::add(double stamp, const Eigen::Isometry3d& pose) {
  const std::size_t count = samples_.size();
  const auto is_same = [&](const Sample& sample) { return sample.pose.matrix() == pose.matrix(); };
  if (count >= 2 && is_same(samples_[count - 1]) && is_same(samples_[count - 2]) && stamp >= samples_.back().stamp) {
    samples_.back().stamp = stamp;
  } else {
    samples_.push_back({stamp, pose});
  }
}

void PosesOverTime::sort() {
  std::ranges::stable_sort(samples_, {}, &Sample::stamp);
}

bool PosesOverTime::is_constant() const {
  return std::ranges::all_of(
      samples_, [&](const Sample& sample) { return sample.pose.matrix() == samples_.front().pose.matrix(); });
}

Eigen::Isometry3d PosesOverTime::at(double stamp) const {
  FLIRT_ASSERT(!samples_.empty());
  const auto after = std::ranges::lower_bound(samples_, stamp, {}, &Sample::stamp);
  if (after == samples_.begin()) { return samples_.front().pose; }
  if (after == samples_.end()) { return samples_.back().pose; }
  const Sample& before = *(after - 1);
  if (before.pose.matrix() == after->pose.matrix()) { return before.pose; }
  const double share = (stamp - before.stamp) / (after->stamp - before.stamp);
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(before.pose.rotation()).slerp(share, Eigen::Quaterniond(after->pose.rotation()));
  const Eigen::Vector3d translation = (1.0 - share) * before.pose.translation() + share * after->pose.translation();
  return Eigen::Isometry3d(Eigen::Translation3d(translation) * rotation);
}

bool PosesOverTime::covers(double stamp) const {
  if (samples_.empty()) { return false; }
  constexpr double reach = 1.0;  // s
  return is_constant() || (stamp >= samples_.front().stamp - reach && stamp <= samples_.back().stamp + reach);
}

void Frames::add(const Transform& transform) {
  if (transform.parent == transform.child) { return; }
  const auto [edge, is_new] = edges_.try_emplace(transform.child, Edge{transform.parent, {}});
  if (edge->second.parent != transform.parent) { return; }
  edge->second.parent_from_child.add(transform.stamp, transform.parent_from_child);
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
                                                       double stamp) const {
  Eigen::Isometry3d here_from_frame = Eigen::Isometry3d::Identity();
  for (const std::string& here : chain(frame)) {
    if (here == ancestor) { return here_from_frame; }
    const auto edge = edges_.find(here);
    if (edge == edges_.end()) { break; }
    here_from_frame = edge->second.parent_from_child.at(stamp) * here_from_frame;
  }
  return std::nullopt;
}

std::optional<Eigen::Isometry3d> Frames::target_from_source(const std::string& target, const std::string& source,
                                                            double stamp) const {
  const std::vector<std::string> of_target = chain(target);
  const std::vector<std::string> of_source = chain(source);
  const auto common = std::ranges::find_first_of(of_source, of_target);
  if (common == of_source.end()) { return std::nullopt; }
  const auto common_from_target = ancestor_from(*common, target, stamp);
  const auto common_from_source = ancestor_from(*common, source, stamp);
  if (!common_from_target || !common_from_source) { return std::nullopt; }
  return common_from_target->inverse() * *common_from_source;
}

bool Frames::covers(const std::string& frame, double stamp) const {
  const auto edge = edges_.find(frame);
  return edge != edges_.end() && edge->second.parent_from_child.covers(stamp);
}

Pose2 planar(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d rotation = pose.rotation();
  return {pose.translation().x(), pose.translation().y(), std::atan2(rotation(1, 0), rotation(0, 0))};
}

}  // namespace flirt::ros
