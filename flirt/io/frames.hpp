// flirt/io/frames.hpp: how the frames of a recorded robot (ROS tf) lie to each other over time. Internal to flirt/io.
#pragma once

#include "flirt/io/ros_messages.hpp"

#include <Eigen/Geometry>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace flirt::ros {

/// Poses of one frame in its parent, over time; a pose that stays is kept with its first and last stamp alone.
class PosesOverTime {
 public:
  void add(double stamp, const Eigen::Isometry3d& pose);
  /// After the last call of add, before the first of at.
  void sort();
  /// Interpolated between the two poses around the stamp (the rotation by slerp); before the first and after the last
  /// that one. Needs a pose. O(log poses).
  [[nodiscard]] Eigen::Isometry3d at(double stamp) const;
  /// Whether what `at` says can be relied on: not more than a second before the first or after the last pose, unless
  /// all are equal.
  [[nodiscard]] bool covers(double stamp) const;

 private:
  struct Sample {
    double stamp;
    Eigen::Isometry3d pose;
  };
  [[nodiscard]] bool is_constant() const;
  std::vector<Sample> samples_;
};

/// All transforms of a recording. A frame has one parent: the first that was stated.
class Frames {
 public:
  void add(const Transform& transform);
  void sort();

  /// The frame, its parent, the parent of that, and so on.
  [[nodiscard]] std::vector<std::string> chain(const std::string& frame) const;

  /// Nothing where the two are not connected.
  [[nodiscard]] std::optional<Eigen::Isometry3d> target_from_source(const std::string& target,
                                                                    const std::string& source, double stamp) const;
  /// Whether the frame has a parent and its pose there is known at that moment.
  [[nodiscard]] bool covers(const std::string& frame, double stamp) const;

 private:
  struct Edge {
    std::string parent;
    PosesOverTime parent_from_child;
  };
  [[nodiscard]] std::optional<Eigen::Isometry3d> ancestor_from(const std::string& ancestor, const std::string& frame,
                                                               double stamp) const;
  std::map<std::string, Edge, std::less<>> edges_;  ///< by child
};

/// The pose of the plane: x, y and the heading of the x axis.
[[nodiscard]] Pose2 planar(const Eigen::Isometry3d& pose);

}  // namespace flirt::ros
