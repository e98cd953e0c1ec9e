#include "flirt/io/tum.hpp"

#include "tests/support/temporary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numbers>

namespace flirt {
namespace {

using testing::HasSubstr;

TEST(Tum, WritesPositionAndQuaternion) {
  const std::array<StampedPose, 2> trajectory{{{1.5, {1, 2, 0}}, {1.25, {-1, 0.5, std::numbers::pi}}}};
  const std::string text = to_tum(trajectory);
  EXPECT_EQ(text.substr(0, text.find('\n')), "1.500000 1 2 0 0 0 0 1");
  EXPECT_THAT(text, HasSubstr("\n1.250000 -1 0.5 0 0 0 1 6.1"));
}

TEST(Tum, WritesStampsWithSixDecimalsOrMore) {
  const std::array<std::pair<double, std::string>, 6> stamps{{{976053559.34191, "976053559.341910"},
                                                              {7, "7.000000"},
                                                              {-0.5, "-0.500000"},
                                                              {0.12345678, "0.12345678"},
                                                              {1e-7, "1e-07"},
                                                              {1e300, "1e+300"}}};
  for (const auto& [stamp, expected] : stamps) {
    const std::array<StampedPose, 1> trajectory{{{stamp, {}}}};
    const std::string text = to_tum(trajectory);
    EXPECT_EQ(text.substr(0, text.find(' ')), expected);
  }
}

TEST(Tum, ReadsBackWhatItWrote) {
  const TemporaryFolder folder;
  std::vector<StampedPose> trajectory;
  for (int i = 0; i < 100; ++i) {
    trajectory.push_back({1134864629.895182 - 0.1 * i, {0.1 * i, 576.536523, wrap_angle(0.1 * i)}});
  }
  ASSERT_TRUE(write_tum(folder.path() / "a.tum", trajectory));
  const auto found = read_tum(folder.path() / "a.tum").value();
  ASSERT_EQ(found.size(), trajectory.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].stamp, trajectory[i].stamp);
    EXPECT_EQ(found[i].map_from_robot.translation(), trajectory[i].map_from_robot.translation());
    EXPECT_NEAR(heading_difference(found[i].map_from_robot, trajectory[i].map_from_robot), 0, 1e-14);
  }
}

TEST(Tum, ReadsPosesInSpaceAsTheirHeading) {
  const TemporaryFolder folder;
  const auto path =
      folder.file("a", "# stamp x y z qx qy qz qw\n\n7 1 2 3 0 0 0.70710678 0.70710678\n8 1 2 3 1 0 0 0\r\n");
  const auto found = read_tum(path).value();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].map_from_robot.theta, std::numbers::pi / 2, 1e-8);
  EXPECT_EQ(found[1].map_from_robot.theta, 0);  // upside down, heading along x
}

TEST(Tum, RefusesBrokenLinesWithTheirPlace) {
  const TemporaryFolder folder;
  const auto error = [&](std::string_view line) {
    const auto trajectory = read_tum(folder.file("a.tum", "0 0 0 0 0 0 0 1\n" + std::string(line)));
    return trajectory ? std::string("no error") : trajectory.error().message;
  };
  EXPECT_THAT(error("1 2 3"), HasSubstr("a.tum:2: expected 8 finite numbers, found the end of the line"));
  EXPECT_THAT(error("1 2 nan 0 0 0 0 1"), HasSubstr("found 'nan'"));
  EXPECT_THAT(error("1 2 x 0 0 0 0 1"), HasSubstr("found 'x'"));
  EXPECT_THAT(error("1 -1e300 2 0 0 0 0 1"), HasSubstr("a.tum:2: expected a place within 10 000 km"));
  EXPECT_THAT(error("1 2 3 0 0 0 0 1 9"), HasSubstr("found more: '9'"));
  EXPECT_THAT(error("1 2 3 0 0 0 0 0"), HasSubstr("quaternion of length 1"));
  EXPECT_THAT(read_tum(folder.path() / "none").error().message, HasSubstr("found nothing"));
}

}  // namespace
}  // namespace flirt
