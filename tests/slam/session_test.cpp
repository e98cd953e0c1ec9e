#include "flirt/slam/session.hpp"

#include "flirt/slam/slam.hpp"

#include "tests/slam/buildings.hpp"

#include <gmock/gmock.h>

namespace flirt {
namespace {

const ScanLog& earlier_log() {
  static const ScanLog log = drive_through(2, 4);
  return log;
}

PoseGraph earlier_graph() {
  return chain_of(earlier_log().map_from_robot, 0.02, 0.005);
}

Slam mapped_session(const ScanLog& log) {
  Slam slam;
  for (const Scan& scan : log.scans) { slam.add(scan); }
  return slam;
}

TEST(Session, JoinsTheMapOfItsBuildingInItsFrame) {
  const ScanLog log = drive_through(2, 9);
  Slam slam = mapped_session(log);
  const SessionJoin join = slam.join(earlier_log().scans, earlier_graph());
  EXPECT_GE(join.agreeing, 8U);
  EXPECT_LE(join.agreeing, join.found);
  EXPECT_LE(join.found, join.queries);
  slam.finish();
  const std::vector<Pose2>& poses = slam.graph().map_from_node;
  const std::size_t first = earlier_log().scans.size();
  ASSERT_EQ(poses.size(), first + log.scans.size());
  // No alignment: the truth of both drives is in one frame, that of the earlier map.
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    EXPECT_LT(distance(poses[first + i], log.map_from_robot[i]), 0.1) << i;
  }
  EXPECT_EQ(slam.summary().scans, log.scans.size());
}

TEST(Session, OfAnotherBuildingChangesNothing) {
  Slam slam = mapped_session(drive_through(7, 9));
  const std::vector<Pose2> before = slam.graph().map_from_node;
  const std::size_t edges = slam.graph().edges.size();
  EXPECT_EQ(slam.join(earlier_log().scans, earlier_graph()).agreeing, 0U);
  ASSERT_EQ(slam.graph().map_from_node.size(), before.size());
  EXPECT_EQ(slam.graph().edges.size(), edges);
  EXPECT_LT(error_of(slam.graph().map_from_node, before), 0.02);  // optimized, no more
}

TEST(Session, OfAFewScansIsNotEnough) {
  ScanLog log = drive_through(2, 9);
  log.scans.resize(5);
  Slam slam = mapped_session(log);
  EXPECT_EQ(slam.join(earlier_log().scans, earlier_graph()).agreeing, 0U);
}

TEST(Session, OfNothingIsNotFound) {
  Slam slam;
  EXPECT_EQ(slam.join(earlier_log().scans, earlier_graph()).agreeing, 0U);
  Slam other = mapped_session(drive_through(2, 9));
  EXPECT_EQ(other.join({}, {}).agreeing, 0U);
}

}  // namespace
}  // namespace flirt
