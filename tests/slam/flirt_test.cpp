// The papers' algorithm 1: keypoints alone.
#include "flirt/sim/simulate.hpp"
#include "flirt/sim/station.hpp"
#include "flirt/slam/slam.hpp"

#include "tests/slam/buildings.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace flirt {
namespace {

struct Counted {
  std::size_t edges{0};
  std::size_t wrong{0};  ///< more than 0.25 m or 6° off
};

Counted counted(const Slam& slam, const ScanLog& log, EdgeKind kind) {
  Counted count;
  for (const PoseEdge& edge : slam.graph().edges) {
    if (edge.kind != kind) { continue; }
    const Pose2 truth = inverse(log.map_from_robot[edge.a]) * log.map_from_robot[edge.b];
    ++count.edges;
    count.wrong +=
        distance(truth, edge.a_from_b) > 0.25 || heading_difference(truth, edge.a_from_b) > radians_from_degrees(6) ? 1
                                                                                                                    : 0;
  }
  return count;
}

Slam slam_of_short_drive(const SlamParams& params) {
  Slam slam(params);
  for (const Scan& scan : short_drive().scans) { slam.add(scan); }
  slam.finish();
  return slam;
}

TEST(Flirt, KeypointsAloneMapABuilding) {
  const ScanLog& log = short_drive();
  const Slam slam = slam_of_short_drive({.front_end = FrontEndKind::flirt});
  EXPECT_LT(error_of(slam.graph().map_from_node, log.map_from_robot), 0.1);
  const Counted loops = counted(slam, log, EdgeKind::loop);
  EXPECT_GT(loops.edges, 100U);
  EXPECT_EQ(loops.wrong, 0U);
}

TEST(Flirt, ByThePapersOwnChoicesToo) {
  const ScanLog& log = short_drive();
  SlamParams params{.front_end = FrontEndKind::flirt, .backend = Backend::toro};
  params.flirt.ransac = {.sampling = Sampling::random, .max_turn_difference = std::numbers::pi};
  const Slam slam = slam_of_short_drive(params);
  EXPECT_LT(error_of(slam.graph().map_from_node, log.map_from_robot), 0.1);
  const Counted loops = counted(slam, log, EdgeKind::loop);
  EXPECT_GT(loops.edges, 50U);
  EXPECT_EQ(loops.wrong, 0U);
}

TEST(Flirt, IcpMakesTheMapOfABuildingMoreAccurate) {
  const auto error_with = [](FlirtRefinement refinement) {
    SlamParams params{.front_end = FrontEndKind::flirt};
    params.flirt.refinement = refinement;
    return error_of(slam_of_short_drive(params).graph().map_from_node, short_drive().map_from_robot);
  };
  EXPECT_LT(error_with(FlirtRefinement::icp), 0.7 * error_with(FlirtRefinement::off));
}

TEST(Flirt, PeopleWhoWalkOnDoNotVetoAMotion) {
  SimulateParams params{.seed = 1};
  params.drive.rounds = 1;
  params.drive.round_length = 40;
  params.people.count = 160;
  const ScanLog log = simulate(make_station({}), params)->log;
  Slam slam({.front_end = FrontEndKind::flirt, .odometry = OdometryUse::ignore, .window = 20});
  std::size_t seen = 0;
  for (const Scan& scan : log.scans) { seen += slam.add(scan).unobservable ? 0 : 1; }
  EXPECT_GT(static_cast<double>(seen), 0.5 * static_cast<double>(log.scans.size()));
  const Counted motions = counted(slam, log, EdgeKind::motion);
  EXPECT_GT(motions.edges, 5 * log.scans.size());  // not only with the scan before
  EXPECT_LT(static_cast<double>(motions.wrong), 0.01 * static_cast<double>(motions.edges));
}

}  // namespace
}  // namespace flirt
