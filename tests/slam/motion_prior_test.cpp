#include "flirt/slam/motion_prior.hpp"

#include <gmock/gmock.h>

namespace flirt {
namespace {

TEST(MotionPrior, AsksNothingOfTheFirstMotionsButTheDistance) {
  const MotionPrior prior(SlamParams{.surprise_translation = 2, .surprise_rotation = 3});
  EXPECT_DOUBLE_EQ(prior.surprise({}), 0);
  EXPECT_DOUBLE_EQ(prior.surprise({0.3, 0.4, -0.1}), 2 * 0.5 + 3 * 0.1);
}

TEST(MotionPrior, HoldsWhatIsUnusualAgainstAPose) {
  const Pose2 slid{0.5, 0, 0};
  MotionPrior steady(SlamParams{});
  MotionPrior jerky(SlamParams{});
  for (int i = 0; i < 20; ++i) {
    steady.learn({0.01, 0, 0.001});
    jerky.learn({0.2, -0.2, 0.2});
  }
  EXPECT_GT(steady.surprise(slid), jerky.surprise(slid) + 0.3);
  EXPECT_LT(steady.surprise({0.02, 0, 0}), 0.05);  // no motion is too exact
  EXPECT_GT(steady.surprise({0, 0, 0.5}), jerky.surprise({0, 0, 0.5}) + 0.3);
}

TEST(MotionPrior, ForgetsHowTheRobotDroveBefore) {
  MotionPrior prior(SlamParams{});
  for (int i = 0; i < 15; ++i) { prior.learn({0.4, 0, 0.4}); }
  const double jerky = prior.surprise({0.5, 0, 0});
  for (int i = 0; i < 15; ++i) { prior.learn({0, 0, 0}); }
  EXPECT_GT(prior.surprise({0.5, 0, 0}), jerky + 0.3);
}

}  // namespace
}  // namespace flirt
