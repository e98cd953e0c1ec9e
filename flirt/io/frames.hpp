// flirt/io/frames.hpp: how the frames of a recorded robot (ROS tf) lie to each other over time. Internal to flirt/io.
#pragma once

#include "flirt/io/ros_messages.hpp"

#include <Eigen/Geometry>

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace flirt::ros {

/// When something was: by its stamp, and as clocks are set back by its place in the recording.
struct Moment {
  double stamp{0};         ///< s
  std::size_t message{0};  ///< number of the message that tells of it
};

/// Poses of one frame in its parent, over time; a pose that stays is kept with its first and last moment alone. A
/// stamp that goes back by more than a second begins a new stretch: the clock was set back. Each stretch stands alone,
/// and a moment belongs to that which was being recorded when its message came.
class PosesOverTime {
 public:
  /// In the order of the recording.
  void add(const Moment& moment, const Eigen::Isometry3d& pose);
  /// After the last call of add, before the first of at.
  void sort();
  /// Interpolated between the two poses around the stamp (the rotation by slerp); before the first and after the last
  /// of the stretch that one. Needs a pose. O(log poses).
  [[nodiscard]] Eigen::Isometry3d at(const Moment& moment) const;
  /// Whether what `at` says can be relied on: not more than a second before the first or after the last pose of the
  /// stretch nor between two that differ and lie more than 1.5 s apart, unless all are equal.
  [[nodiscard]] bool covers(const Moment& moment) const;

 private:
  struct Sample {
    Moment moment;
    Eigen::Isometry3d pose;
  };
  using Stretch = std::vector<Sample>;
  [[nodiscard]] bool is_constant() const;
  [[nodiscard]] const Stretch& stretch_of(const Moment& moment) const;
  std::vector<Stretch> stretches_;
  double latest_{0};  ///< s, stamp of the last stretch
};

/// All transforms of a recording. A frame has one parent: the first that was stated.
class Frames {
 public:
  /// In the order of the recording: `message` is the number of that which tells the transform.
  void add(const Transform& transform, std::size_t message);
  void sort();

  /// The frame, its parent, the parent of that, and so on.
  [[nodiscard]] std::vector<std::string> chain(const std::string& frame) const;

  /// Nothing where the two are not connected.
  [[nodiscard]] std::optional<Eigen::Isometry3d> target_from_source(const std::string& target,
                                                                    const std::string& source,
                                                                    const Moment& moment) const;
  /// Whether the frame has a parent and its pose there is known at that moment.
  [[nodiscard]] bool covers(const std::string& frame, const Moment& moment) const;

 private:
  struct Edge {
    std::string parent;
    PosesOverTime parent_from_child;
  };
  [[nodiscard]] std::optional<Eigen::Isometry3d> ancestor_from(const std::string& ancestor, const std::string& frame,
                                                               const Moment& moment) const;
  std::map<std::string, Edge, std::less<>> edges_;  ///< by child
};

/// The pose of the plane: x, y and the heading of the x axis.
[[nodiscard]] Pose2 planar(const Eigen::Isometry3d& pose);

}  // namespace flirt::ros
