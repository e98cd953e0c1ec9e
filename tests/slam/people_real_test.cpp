// Scanners that stand among real people who walk: what moves is not the scanner.
#include "flirt/io/log.hpp"
#include "flirt/slam/slam.hpp"

#include "tests/support/data.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <string_view>

namespace flirt {
namespace {

void expect_stands(std::string_view recording, std::size_t scans, double most_motion, double most_turn) {
  const auto path = data_file(recording);
  if (!path) { GTEST_SKIP() << "the recordings are not at hand"; }
  const LoadedLog loaded = read_log(*path).value();
  ASSERT_EQ(loaded.log.scans.size(), scans);
  Slam slam{SlamParams{}};
  for (const Scan& scan : loaded.log.scans) { slam.add(scan); }
  slam.finish();
  for (const Pose2& pose : slam.graph().map_from_node) {
    EXPECT_LT(distance(pose, slam.graph().map_from_node.front()), most_motion);
    EXPECT_LT(heading_difference(pose, slam.graph().map_from_node.front()), most_turn);
  }
}

TEST(SlamRealPeople, AScannerThatStandsInARoomStays) {
  expect_stands("leg_tracker/positive_1.bag", 400, 0.005, 0.1 * std::numbers::pi / 180);
}

TEST(SlamRealPeople, AScannerOfWhichTwoThirdsOfTheBeamsSeeNothingStays) {
  expect_stands("leg_tracker/demo_stationary_simple_environment.bag", 1265, 0.03, 1.0 * std::numbers::pi / 180);
}

}  // namespace
}  // namespace flirt
