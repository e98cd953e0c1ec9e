// Messages of both serializations, each field at its place, and what is no such message.
#include "flirt/io/ros_messages.hpp"

#include "tests/io/ros_bytes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>

namespace flirt {
namespace {

using testing::HasSubstr;

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

ros::LaserScan small_scan() {
  return {.stamp = 1700000000.25,
          .frame = "laser",
          .beams = {.angle_min = -0.5, .angle_step = 0.25, .range_min = 0.125, .range_max = 30.0},
          .ranges = {1.5, infinite, 0.0, 2.25, 30.0}};
}

bag::Message message_of(std::string_view type, const std::string& bytes, bag::Serialization serialization) {
  return {"/topic", type, serialization, std::as_bytes(std::span(bytes))};
}

Result<ros::LaserScan> read_scan(const std::string& bytes, bag::Serialization serialization) {
  return ros::laser_scan_of(message_of(ros::laser_scan_type, bytes, serialization));
}

void expect_equal(const ros::LaserScan& found, const ros::LaserScan& expected) {
  EXPECT_DOUBLE_EQ(found.stamp, expected.stamp);
  EXPECT_EQ(found.frame, expected.frame);
  EXPECT_EQ(found.beams, expected.beams);
  EXPECT_EQ(found.ranges, expected.ranges);
}

TEST(RosMessages, LaserScanOfEitherSerialization) {
  for (const bag::Serialization serialization : both_serializations) {
    expect_equal(read_scan(scan_bytes(small_scan(), serialization), serialization).value(), small_scan());
  }
}

TEST(RosMessages, FieldsAreAlignedWhateverTheLengthOfTheFrame) {
  for (const char* frame : {"", "a", "ab", "abc", "abcd", "abcde"}) {
    ros::LaserScan scan = small_scan();
    scan.frame = frame;
    expect_equal(read_scan(scan_bytes(scan, bag::Serialization::cdr), bag::Serialization::cdr).value(), scan);
  }
}

TEST(RosMessages, BigEndianIsRead) {
  const std::string bytes = scan_bytes(small_scan(), bag::Serialization::cdr, ByteOrder::big);
  expect_equal(read_scan(bytes, bag::Serialization::cdr).value(), small_scan());
}

TEST(RosMessages, FramesHaveNoSlashInFront) {
  ros::LaserScan scan = small_scan();
  scan.frame = "/base/laser";
  EXPECT_EQ(read_scan(scan_bytes(scan, bag::Serialization::ros1), bag::Serialization::ros1)->frame, "base/laser");
}

TEST(RosMessages, NotANumberStays) {
  ros::LaserScan scan = small_scan();
  scan.ranges = {no_number, 1.0};
  const auto found = read_scan(scan_bytes(scan, bag::Serialization::cdr), bag::Serialization::cdr);
  ASSERT_EQ(found->ranges.size(), 2U);
  EXPECT_TRUE(std::isnan(found->ranges[0]));
}

TEST(RosMessages, AScanWithoutBeamsIsAScan) {
  ros::LaserScan scan = small_scan();
  scan.ranges.clear();
  EXPECT_TRUE(read_scan(scan_bytes(scan, bag::Serialization::cdr), bag::Serialization::cdr)->ranges.empty());
}

TEST(RosMessages, LimitsThatAreNoneAreNotDeclared) {
  for (const double limit : {no_number, infinite, -1.0}) {
    ros::LaserScan scan = small_scan();
    scan.beams.range_min = scan.beams.range_max = limit;
    const auto found = read_scan(scan_bytes(scan, bag::Serialization::ros1), bag::Serialization::ros1);
    EXPECT_EQ(found->beams.range_min, 0.0);
    EXPECT_EQ(found->beams.range_max, 0.0);
  }
}

TEST(RosMessages, AnglesMustBeThoseOfOneTurn) {
  for (const double step : {0.0, no_number, infinite, 2.0}) {
    ros::LaserScan scan = small_scan();
    scan.beams.angle_step = step;
    const auto found = read_scan(scan_bytes(scan, bag::Serialization::ros1), bag::Serialization::ros1);
    ASSERT_FALSE(found) << step;
    EXPECT_THAT(found.error().message, HasSubstr("expected angles within one turn, found 5 beams"));
  }
  for (const double start : {no_number, infinite, -90.0}) {
    ros::LaserScan scan = small_scan();
    scan.beams.angle_min = start;
    EXPECT_FALSE(read_scan(scan_bytes(scan, bag::Serialization::ros1), bag::Serialization::ros1)) << start;
  }
}

TEST(RosMessages, OdometryOfEitherSerialization) {
  for (const bag::Serialization serialization : both_serializations) {
    const ros::Transform odometry{12.5, "odom", "base_link", in_space({1, -2, 0.5})};
    const std::string bytes = odometry_bytes(odometry, serialization);
    const auto found = ros::odometry_of(message_of(ros::odometry_type, bytes, serialization));
    ASSERT_TRUE(found);
    EXPECT_DOUBLE_EQ(found->stamp, 12.5);
    EXPECT_EQ(found->parent, "odom");
    EXPECT_EQ(found->child, "base_link");
    EXPECT_TRUE(found->parent_from_child.isApprox(odometry.parent_from_child));
  }
}

TEST(RosMessages, TransformsOfEitherSerialization) {
  for (const bag::Serialization serialization : both_serializations) {
    const std::vector<ros::Transform> transforms{{1.0, "odom", "base", in_space({1, 2, 3})},
                                                 {2.0, "base", "laser", in_space({-1, 0, -3})}};
    const std::string bytes = transform_bytes(transforms, serialization);
    const auto found = ros::transforms_of(message_of("tf2_msgs/TFMessage", bytes, serialization));
    ASSERT_TRUE(found);
    ASSERT_EQ(found->size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ((*found)[i].parent, transforms[i].parent);
      EXPECT_EQ((*found)[i].child, transforms[i].child);
      EXPECT_DOUBLE_EQ((*found)[i].stamp, transforms[i].stamp);
      EXPECT_TRUE((*found)[i].parent_from_child.isApprox(transforms[i].parent_from_child));
    }
  }
}

TEST(RosMessages, APoseNeedsAUnitQuaternion) {
  for (const double w : {0.0, 2.0, no_number}) {
    FieldWriter writer(bag::Serialization::ros1);
    writer.header(1.0, "odom");
    writer.text("base");
    for (const double value : {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, w}) { writer.number(value); }
    const std::string bytes = writer.bytes();
    const auto found = ros::odometry_of(message_of(ros::odometry_type, bytes, bag::Serialization::ros1));
    ASSERT_FALSE(found) << w;
    EXPECT_THAT(found.error().message, HasSubstr("unit quaternion"));
  }
}

TEST(RosMessages, PlacesOffTheEarthAreRefused) {
  for (const bag::Serialization serialization : both_serializations) {
    for (const Pose2& pose : {Pose2{1e300, 1e300, 0}, Pose2{0, -1.1e7, 0}, Pose2{1e12, 0, 0}}) {
      const ros::Transform far{1.0, "odom", "base", in_space(pose)};
      const std::string odometry = odometry_bytes(far, serialization);
      const auto found = ros::odometry_of(message_of(ros::odometry_type, odometry, serialization));
      ASSERT_FALSE(found);
      EXPECT_THAT(found.error().message, HasSubstr("expected a place within 10 000 km"));
      const std::string transforms = transform_bytes({far}, serialization);
      EXPECT_FALSE(ros::transforms_of(message_of("tf2_msgs/TFMessage", transforms, serialization)));
    }
    const std::string near = odometry_bytes({1.0, "odom", "base", in_space({9e6, 0, 0})}, serialization);
    EXPECT_TRUE(ros::odometry_of(message_of(ros::odometry_type, near, serialization)));
  }
}

TEST(RosMessages, CutAnywhereIsAnError) {
  for (const bag::Serialization serialization : both_serializations) {
    const std::string whole = scan_bytes(small_scan(), serialization);
    const std::size_t needed = whole.size() - sizeof(std::uint32_t);  // the intensities are not looked at
    for (std::size_t size = 0; size < needed; ++size) {
      EXPECT_FALSE(read_scan(whole.substr(0, size), serialization)) << size;
    }
    const std::string transforms = transform_bytes({{1.0, "odom", "base", in_space({})}}, serialization);
    for (std::size_t size = 0; size < transforms.size(); ++size) {
      const std::string cut = transforms.substr(0, size);
      EXPECT_FALSE(ros::transforms_of(message_of("tf2_msgs/TFMessage", cut, serialization))) << size;
    }
  }
}

TEST(RosMessages, AnyFlippedByteGivesAScanOrAnError) {
  for (const bag::Serialization serialization : both_serializations) {
    const std::string whole = scan_bytes(small_scan(), serialization);
    for (std::size_t at = 0; at < whole.size(); ++at) {
      std::string flipped = whole;
      flipped[at] = static_cast<char>(flipped[at] ^ '\xff');
      if (const auto found = read_scan(flipped, serialization)) { EXPECT_LE(found->ranges.size(), 6U); }
    }
  }
}

}  // namespace
}  // namespace flirt
