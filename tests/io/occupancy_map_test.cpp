#include "flirt/io/occupancy_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace flirt {
namespace {

using testing::HasSubstr;

Scan one_beam() {
  return {.beams = {0, 0.1, 0, 50}, .ranges = {1.0}};
}

TEST(OccupancyMap, CallsACellOccupiedFromItsSecondHitOn) {
  EvidenceGrid grid;
  grid.add(one_beam(), {0.025, 0.025, 0});
  EXPECT_THAT(occupancy_map(grid, "a.pgm").value().image.pixels, testing::Each(254));
  grid.add(one_beam(), {0.025, 0.025, 0});
  const GridMapImage map = occupancy_map(grid, "a.pgm").value();
  EXPECT_EQ(map.image.height, 1U);
  EXPECT_EQ(map.image.pixels.back(), 0);
  EXPECT_EQ(map.metadata.image, "a.pgm");
}

TEST(OccupancyMap, RefusesScansTooFarApartForOneImage) {
  EvidenceGrid grid;
  grid.add(one_beam(), {});
  grid.add(one_beam(), {1e6, 1e6, 0});
  EXPECT_THAT(occupancy_map(grid, "a.pgm").error().message,
              HasSubstr("expected scans near each other, found a map of"));
}

}  // namespace
}  // namespace flirt
