#include "flirt/core/pose2.hpp"

#include "flirt/core/rng.hpp"

#include <gtest/gtest.h>

namespace flirt {
namespace {

TEST(Pose2, TimesItsInverseIsIdentity) {
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const Pose2 a_from_b{rng.uniform(-600, 600), rng.uniform(-600, 600), rng.uniform(-3.14, 3.14)};
    const Pose2 identity = a_from_b * inverse(a_from_b);
    EXPECT_NEAR(identity.x, 0, 1e-12 * 600);
    EXPECT_NEAR(identity.y, 0, 1e-12 * 600);
    EXPECT_NEAR(identity.theta, 0, 1e-12);
  }
}

TEST(Pose2, CompositionIsAssociativeOnPoints) {
  const Pose2 a_from_b{1, 2, 0.5};
  const Pose2 b_from_c{-3, 0.25, 3.0};
  const Point2 in_c{0.7, -0.3};
  const Point2 once = (a_from_b * b_from_c) * in_c;
  const Point2 twice = a_from_b * (b_from_c * in_c);
  EXPECT_NEAR(once.x, twice.x, 1e-12);
  EXPECT_NEAR(once.y, twice.y, 1e-12);
}

TEST(WrapAngle, LandsInHalfOpenInterval) {
  constexpr double pi = std::numbers::pi;
  EXPECT_DOUBLE_EQ(wrap_angle(pi), pi);
  EXPECT_DOUBLE_EQ(wrap_angle(-pi), pi);
  EXPECT_NEAR(wrap_angle(3 * pi), pi, 1e-12);
  EXPECT_NEAR(wrap_angle(7.0), 7.0 - 2 * pi, 1e-12);
  for (int i = -50; i <= 50; ++i) {
    const double wrapped = wrap_angle(0.37 * i);
    EXPECT_GT(wrapped, -pi);
    EXPECT_LE(wrapped, pi);
    EXPECT_NEAR(std::sin(wrapped), std::sin(0.37 * i), 1e-12);
  }
}

}  // namespace
}  // namespace flirt
