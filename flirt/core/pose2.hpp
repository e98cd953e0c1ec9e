// flirt/core/pose2.hpp: points and rigid motions of the plane.
#pragma once

#include <cmath>
#include <numbers>

namespace flirt {

struct Point2 {
  double x{0};  ///< m
  double y{0};  ///< m

  friend Point2 operator+(Point2 a, Point2 b) { return {a.x + b.x, a.y + b.y}; }
  friend Point2 operator-(Point2 a, Point2 b) { return {a.x - b.x, a.y - b.y}; }
  friend Point2 operator*(double s, Point2 a) { return {s * a.x, s * a.y}; }
  friend bool operator==(const Point2&, const Point2&) = default;
};

[[nodiscard]] inline double dot(Point2 a, Point2 b) {
  return a.x * b.x + a.y * b.y;
}
/// z component of the cross product: positive when b lies to the left of a.
[[nodiscard]] inline double cross(Point2 a, Point2 b) {
  return a.x * b.y - a.y * b.x;
}
[[nodiscard]] inline double squared_norm(Point2 a) {
  return dot(a, a);
}
[[nodiscard]] inline double norm(Point2 a) {
  return std::sqrt(squared_norm(a));
}

/// The same angle in (−π, π]; not finite stays not finite.
[[nodiscard]] inline double wrap_angle(double angle) {
  constexpr double pi = std::numbers::pi;
  if (angle > -pi && angle <= pi) { return angle; }
  const double wrapped = std::remainder(angle, 2.0 * pi);
  return wrapped <= -pi ? pi : wrapped;
}

/// A frame b seen from a frame a; `a_from_b` maps b coordinates into a, and `a_from_b * b_from_c` is `a_from_c`.
struct Pose2 {
  double x{0};      ///< m
  double y{0};      ///< m
  double theta{0};  ///< rad, (−π, π]

  [[nodiscard]] Point2 translation() const { return {x, y}; }

  friend Point2 operator*(const Pose2& a_from_b, Point2 in_b) {
    const double c = std::cos(a_from_b.theta);
    const double s = std::sin(a_from_b.theta);
    return {a_from_b.x + c * in_b.x - s * in_b.y, a_from_b.y + s * in_b.x + c * in_b.y};
  }
  friend Pose2 operator*(const Pose2& a_from_b, const Pose2& b_from_c) {
    const Point2 t = a_from_b * b_from_c.translation();
    return {t.x, t.y, wrap_angle(a_from_b.theta + b_from_c.theta)};
  }
  friend bool operator==(const Pose2&, const Pose2&) = default;
};

/// inverse(a_from_b) is b_from_a.
[[nodiscard]] inline Pose2 inverse(const Pose2& pose) {
  const double c = std::cos(pose.theta);
  const double s = std::sin(pose.theta);
  return {-c * pose.x - s * pose.y, s * pose.x - c * pose.y, wrap_angle(-pose.theta)};
}

/// Distance between the origins of two frames, m.
[[nodiscard]] inline double distance(const Pose2& a, const Pose2& b) {
  return norm(a.translation() - b.translation());
}
/// Smallest angle between two headings, rad, [0, π].
[[nodiscard]] inline double heading_difference(const Pose2& a, const Pose2& b) {
  return std::abs(wrap_angle(a.theta - b.theta));
}
[[nodiscard]] inline bool is_finite(const Pose2& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.theta);
}

[[nodiscard]] constexpr double radians_from_degrees(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}
[[nodiscard]] constexpr double degrees_from_radians(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

}  // namespace flirt
