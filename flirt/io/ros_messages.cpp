#include "flirt/io/ros_messages.hpp"

#include "flirt/io/log_oddities.hpp"
#include "flirt/io/text.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

namespace flirt::ros {
namespace {

/// Fields of a message one after the other. What is missing reads as 0 and spoils the whole: ask `is_whole` at the end.
class Fields {
 public:
  explicit Fields(const bag::Message& message)
      : bytes_(message.bytes), is_cdr_(message.serialization == bag::Serialization::cdr) {
    if (!is_cdr_) { return; }
    constexpr std::size_t header = 4;  // 0, then 0 for big-endian or 1 for little-endian, then two bytes of options
    is_whole_ = bytes_.size() >= header && bytes_[0] == std::byte{0} && bytes_[1] <= std::byte{1};
    is_swapped_ = is_whole_ && (bytes_[1] == std::byte{1}) != (std::endian::native == std::endian::little);
    bytes_ = bytes_.subspan(is_whole_ ? header : bytes_.size());
  }

  [[nodiscard]] bool is_whole() const { return is_whole_; }

  template <class Number>
  Number number() {
    if (is_cdr_) { at_ = (at_ + sizeof(Number) - 1) / sizeof(Number) * sizeof(Number); }
    std::array<std::byte, sizeof(Number)> raw{};
    if (take(raw) && is_swapped_) { std::ranges::reverse(raw); }
    return std::bit_cast<Number>(raw);
  }

  /// Of a list; one of more elements of `bytes_each` than there are bytes left is not whole, and read as empty.
  std::size_t count(std::size_t bytes_each) {
    const std::size_t elements = number<std::uint32_t>();
    is_whole_ = is_whole_ && elements <= (bytes_.size() - at_) / bytes_each;
    return is_whole_ ? elements : 0;
  }

  std::string text() {
    std::string result(count(1), '\0');
    take(std::as_writable_bytes(std::span(result)));
    if (is_cdr_ && result.ends_with('\0')) { result.pop_back(); }
    return result;
  }

  std::string frame() {
    std::string name = text();
    return name.starts_with('/') ? name.substr(1) : name;
  }

  /// s
  double time() {
    const auto seconds =
        is_cdr_ ? static_cast<double>(number<std::int32_t>()) : static_cast<double>(number<std::uint32_t>());
    return seconds + 1e-9 * number<std::uint32_t>();
  }

 private:
  bool take(std::span<std::byte> out) {
    is_whole_ = is_whole_ && at_ <= bytes_.size() && out.size() <= bytes_.size() - at_;
    if (!is_whole_) { return false; }
    std::ranges::copy(bytes_.subspan(at_, out.size()), out.begin());
    at_ += out.size();
    return true;
  }

  std::span<const std::byte> bytes_;
  bool is_cdr_;
  bool is_swapped_{false};
  bool is_whole_{true};
  std::size_t at_{0};
};

struct Header {
  double stamp;
  std::string frame;
};

Header header_of(Fields& fields, bag::Serialization serialization) {
  if (serialization == bag::Serialization::ros1) { fields.number<std::uint32_t>(); }  // a running number
  const double stamp = fields.time();
  return {stamp, fields.frame()};
}

/// A position and a quaternion; the error is that they are no pose. What is not whole may give either.
Result<Eigen::Isometry3d> pose_of(Fields& fields) {
  std::array<double, 7> numbers{};
  for (double& number : numbers) { number = fields.number<double>(); }
  const auto& [x, y, z, qx, qy, qz, qw] = numbers;
  const Eigen::Quaterniond rotation(qw, qx, qy, qz);
  const bool is_finite = std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
  if (!is_finite || std::abs(rotation.norm() - 1.0) > 0.1) {
    return fail("expected a position and a unit quaternion, found other numbers");
  }
  if (std::hypot(x, y, z) > farthest_pose) { return fail("expected a place within 10 000 km, found one farther away"); }
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z) * rotation.normalized());
}

tl::unexpected<Error> no_such(std::string_view type) {
  return fail("expected a message of type " + std::string(type) + ", found one that is cut short or another");
}

}  // namespace

bool is_transform_type(std::string_view type) {
  return type == "tf2_msgs/TFMessage" || type == "tf/tfMessage";
}

Result<LaserScan> laser_scan_of(const bag::Message& message) {
  Fields fields(message);
  LaserScan scan;
  const Header header = header_of(fields, message.serialization);
  scan.stamp = header.stamp;
  scan.frame = header.frame;
  scan.beams.angle_min = fields.number<float>();
  fields.number<float>();  // angle of the last beam: follows from the others, which drivers keep more exactly
  scan.beams.angle_step = fields.number<float>();
  fields.number<float>();  // s, from beam to beam
  fields.number<float>();  // s, from scan to scan
  scan.beams.range_min = fields.number<float>();
  scan.beams.range_max = fields.number<float>();
  scan.ranges.resize(fields.count(sizeof(float)));
  for (double& range : scan.ranges) { range = fields.number<float>(); }
  if (!fields.is_whole()) { return no_such(laser_scan_type); }
  if (std::string wrong = wrong_angles(scan.beams, scan.ranges.size()); !wrong.empty()) {
    return fail(std::move(wrong));
  }
  if (!(scan.beams.range_min >= 0.0 && scan.beams.range_min < 1e6)) { scan.beams.range_min = 0.0; }
  if (!(scan.beams.range_max > 0.0 && scan.beams.range_max < 1e6)) { scan.beams.range_max = 0.0; }  // not said
  return scan;
}

Result<Transform> odometry_of(const bag::Message& message) {
  Fields fields(message);
  const Header header = header_of(fields, message.serialization);
  const std::string child = fields.frame();
  const Result<Eigen::Isometry3d> pose = pose_of(fields);
  if (!fields.is_whole()) { return no_such(odometry_type); }
  if (!pose) { return tl::unexpected(pose.error()); }
  return Transform{header.stamp, header.frame, child, *pose};
}

Result<std::vector<Transform>> transforms_of(const bag::Message& message) {
  Fields fields(message);
  std::vector<Transform> transforms;
  constexpr std::size_t least_bytes = 64;  // of one transform
  const std::size_t count = fields.count(least_bytes);
  for (std::size_t i = 0; i < count; ++i) {
    const Header header = header_of(fields, message.serialization);
    const std::string child = fields.frame();
    const Result<Eigen::Isometry3d> pose = pose_of(fields);
    if (!fields.is_whole()) { break; }
    if (!pose) { return tl::unexpected(pose.error()); }
    transforms.push_back({header.stamp, header.frame, child, *pose});
  }
  if (!fields.is_whole()) { return no_such(message.type); }
  return transforms;
}

}  // namespace flirt::ros
