#include "flirt/graph/robust.hpp"

#include "flirt/core/fields.hpp"
#include "flirt/graph/graduated.hpp"

#include <gtest/gtest.h>

namespace flirt {
namespace {

TEST(RobustLoss, DerivativesAreThoseOfNumericDifferences) {
  for (const auto& [loss, name] : enum_names(RobustLoss{})) {
    for (const double s : {0.1, 1.0, 3.9, 4.1, 50.0, 1e4}) {
      const double step = 1e-5 * s;
      const LossValue at = robust_loss(loss, 2.0, s);
      const LossValue before = robust_loss(loss, 2.0, s - step);
      const LossValue after = robust_loss(loss, 2.0, s + step);
      EXPECT_NEAR(at.first, (after.value - before.value) / (2 * step), 1e-5) << name << " at " << s;
      EXPECT_NEAR(at.second, (after.first - before.first) / (2 * step), 1e-5) << name << " at " << s;
    }
  }
}

TEST(RobustLoss, IsTheSquareForSmallErrorsAndLessForLargeOnes) {
  for (const auto& [loss, name] : enum_names(RobustLoss{})) {
    EXPECT_NEAR(robust_loss(loss, 2.0, 1e-6).value, 1e-6, 1e-11) << name;
    if (loss != RobustLoss::none) { EXPECT_LT(robust_loss(loss, 2.0, 100.0).value, 50.0) << name; }
  }
  EXPECT_LT(robust_loss(RobustLoss::geman_mcclure, 2.0, 1e12).value, 4.0) << "bounded by width²";
}

TEST(Graduation, StartsWithNearlyEqualWeightsAndEndsWithARefusal) {
  for (const Graduated kind : {Graduated::geman_mcclure, Graduated::truncated}) {
    const double limit = 9.0;
    const double worst = 1e6;
    Graduation graduation = Graduation::from(kind, limit, worst);
    EXPECT_GT(graduation.weight(worst), 0.0);
    int rounds = 0;
    for (; !graduation.is_last(); graduation = graduation.next()) { ASSERT_LT(++rounds, 200); }
    EXPECT_GT(graduation.weight(0.01 * limit), 0.95);
    EXPECT_LT(graduation.weight(100 * limit), 1e-3);
  }
}

TEST(Graduation, TruncatedWeightsAreContinuous) {
  const Graduation graduation{Graduated::truncated, 4.0, 0.5};
  for (const double edge : {0.5 / 1.5 * 4.0, 1.5 / 0.5 * 4.0}) {
    EXPECT_NEAR(graduation.weight(edge * (1 - 1e-9)), graduation.weight(edge * (1 + 1e-9)), 1e-6);
  }
}

}  // namespace
}  // namespace flirt
