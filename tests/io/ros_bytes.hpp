// tests/io/ros_bytes.hpp: messages of ROS for tests, as bytes of either serialization.
#pragma once

#include "flirt/io/bag.hpp"
#include "flirt/io/ros_messages.hpp"

#include "tests/io/bag_files.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace flirt {

enum class ByteOrder : std::uint8_t { little, big };

/// Writes the fields of a message one after the other.
class FieldWriter {
 public:
  explicit FieldWriter(bag::Serialization serialization, ByteOrder order = ByteOrder::little)
      : is_cdr_(serialization == bag::Serialization::cdr), is_big_(order == ByteOrder::big) {}

  template <class Number>
  void number(Number value) {
    if (is_cdr_) { bytes_.resize((bytes_.size() + sizeof value - 1) / sizeof value * sizeof value, '\0'); }
    auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(value);
    if (is_big_ != (std::endian::native == std::endian::big)) { std::ranges::reverse(raw); }
    bytes_.append(raw.begin(), raw.end());
  }
  void text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size() + (is_cdr_ ? 1 : 0)));
    bytes_ += value;
    if (is_cdr_) { bytes_ += '\0'; }
  }
  void header(double stamp, std::string_view frame) {
    if (!is_cdr_) { number(std::uint32_t{7}); }
    number(static_cast<std::uint32_t>(stamp));
    number(static_cast<std::uint32_t>((stamp - static_cast<std::uint32_t>(stamp)) * 1e9 + 0.5));
    text(frame);
  }
  void pose(const Eigen::Isometry3d& pose) {
    const Eigen::Quaterniond q(pose.rotation());
    for (const double value :
         {pose.translation().x(), pose.translation().y(), pose.translation().z(), q.x(), q.y(), q.z(), q.w()}) {
      number(value);
    }
  }
  [[nodiscard]] std::string bytes() const {
    return is_cdr_ ? std::string{'\0', is_big_ ? '\0' : '\1', '\0', '\0'} + bytes_ : bytes_;
  }

 private:
  bool is_cdr_;
  bool is_big_;
  std::string bytes_{};
};

inline constexpr bag::Serialization both_serializations[] = {bag::Serialization::ros1, bag::Serialization::cdr};

/// A pose of the plane in space.
[[nodiscard]] inline Eigen::Isometry3d in_space(const Pose2& pose) {
  return Eigen::Isometry3d(Eigen::Translation3d(pose.x, pose.y, 0.0) *
                           Eigen::AngleAxisd(pose.theta, Eigen::Vector3d::UnitZ()));
}

[[nodiscard]] inline std::string scan_bytes(const ros::LaserScan& scan, bag::Serialization serialization,
                                            ByteOrder order = ByteOrder::little) {
  FieldWriter writer(serialization, order);
  writer.header(scan.stamp, scan.frame);
  const double angle_max = scan.beams.angle_min + scan.beams.angle_step * static_cast<double>(scan.ranges.size() - 1);
  for (const double value : {scan.beams.angle_min, angle_max, scan.beams.angle_step, 1e-4, 0.1, scan.beams.range_min,
                             scan.beams.range_max}) {
    writer.number(static_cast<float>(value));
  }
  writer.number(static_cast<std::uint32_t>(scan.ranges.size()));
  for (const double range : scan.ranges) { writer.number(static_cast<float>(range)); }
  writer.number(std::uint32_t{0});  // no intensities
  return writer.bytes();
}

[[nodiscard]] inline std::string odometry_bytes(const ros::Transform& odometry, bag::Serialization serialization) {
  FieldWriter writer(serialization);
  writer.header(odometry.stamp, odometry.parent);
  writer.text(odometry.child);
  writer.pose(odometry.parent_from_child);
  for (int i = 0; i < 36 + 6 + 36; ++i) { writer.number(0.0); }  // covariances and velocities
  return writer.bytes();
}

[[nodiscard]] inline std::string transform_bytes(const std::vector<ros::Transform>& transforms,
                                                 bag::Serialization serialization) {
  FieldWriter writer(serialization);
  writer.number(static_cast<std::uint32_t>(transforms.size()));
  for (const ros::Transform& transform : transforms) {
    writer.header(transform.stamp, transform.parent);
    writer.text(transform.child);
    writer.pose(transform.parent_from_child);
  }
  return writer.bytes();
}

}  // namespace flirt
