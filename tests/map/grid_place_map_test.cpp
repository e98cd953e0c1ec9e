#include "flirt/map/grid_place_map.hpp"

#include "flirt/map/localize.hpp"

#include "tests/support/map_examples.hpp"
#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace flirt {
namespace {

constexpr double side = 14;  // m, of the image around the room

/// What a pixel value means in each mode.
struct Palette {
  std::uint8_t free;
  std::uint8_t occupied;
  std::uint8_t unknown;
};

/// The room of tests/support/scenes.hpp: its walls occupied, free as far as beams from the origin's surroundings go.
GreyImage room_image(const GridMapMetadata& metadata, const Palette& palette) {
  const auto pixels = static_cast<std::size_t>(std::lround(side / metadata.resolution));
  GreyImage image{pixels, pixels, std::vector<std::uint8_t>(pixels * pixels, palette.unknown)};
  const Pose2 image_from_map = inverse(metadata.origin);
  const auto draw = [&](Point2 begin, Point2 end, std::uint8_t value) {
    const int steps = static_cast<int>(norm(end - begin) / (0.2 * metadata.resolution)) + 1;
    for (int i = 0; i <= steps; ++i) {
      const Point2 at = image_from_map * (begin + (static_cast<double>(i) / steps) * (end - begin));
      const auto column = static_cast<std::size_t>(at.x / metadata.resolution);
      const auto row = pixels - 1 - static_cast<std::size_t>(at.y / metadata.resolution);
      image.pixels[row * pixels + column] = value;
    }
  };
  for (const Pose2& pose : poses_around(1.5, 6)) {
    const Scan scan = scan_of(furnished_room(), pose, turn_beams(), turn_beam_count);
    for (const BeamPoint& hit : hit_points(scan)) { draw(pose.translation(), pose * hit.point, palette.free); }
  }
  for (const Wall& wall : furnished_room()) { draw(wall.begin, wall.end, palette.occupied); }
  return image;
}

constexpr Palette usual{.free = 254, .occupied = 0, .unknown = 205};

/// An image of the given resolution, turned by `turn` around the room's origin.
GridMapMetadata metadata_of(double resolution, double turn = 0) {
  return {.resolution = resolution, .origin = Pose2{0, 0, turn} * Pose2{-side / 2, -side / 2, 0}};
}

void expect_found_to(double accuracy, const PlaceMap& map, LocalizeMethod method = LocalizeMethod::automatic) {
  Localizer localizer(map, {.method = method});
  for (const Pose2& truth : {Pose2{0.3, 0.2, 1.0}, Pose2{-0.6, 0.9, -2.8}, Pose2{1.0, -1.2, 0.1}}) {
    const LocalizationResult found =
        localizer.localize(scan_of(furnished_room(), truth, turn_beams(), turn_beam_count));
    EXPECT_EQ(found.verdict, Verdict::unique);
    ASSERT_NE(found.best(), nullptr);
    EXPECT_LT(distance(found.best()->map_from_sensor, truth), accuracy);
    EXPECT_LT(heading_difference(found.best()->map_from_sensor, truth), 0.02);
  }
}

struct ImageCase {
  double resolution;
  double turn;
};

class PlaceMapFromGrid : public testing::TestWithParam<ImageCase> {};

TEST_P(PlaceMapFromGrid, ScansOfTheRoomAreFoundToHalfAPixelAndTwoCentimetres) {
  const GridMapMetadata metadata = metadata_of(GetParam().resolution, GetParam().turn);
  const PlaceMap map = place_map_from_grid(room_image(metadata, usual), metadata).value();
  EXPECT_GE(map.size(), 40U);
  expect_found_to(0.02 + 0.5 * GetParam().resolution, map);  // where in its pixel a wall stands is not known
}

INSTANTIATE_TEST_SUITE_P(Images, PlaceMapFromGrid,
                         testing::Values(ImageCase{0.05, 0}, ImageCase{0.05, 0.5}, ImageCase{0.05, -2.3},
                                         ImageCase{0.1, 0}, ImageCase{0.1, 0.3}, ImageCase{0.025, 0},
                                         ImageCase{0.025, 1.0}, ImageCase{0.03, 0}),
                         [](const auto& image) {
                           return std::to_string(std::lround(1000 * image.param.resolution)) + "mm" +
                                  std::to_string(std::lround(100 * (image.param.turn + 4)));
                         });

TEST(PlaceMapFromGrid, KeypointsOfVirtualScansFindScans) {
  const GridMapMetadata metadata = metadata_of(0.05);
  const PlaceMap map = place_map_from_grid(room_image(metadata, usual), metadata).value();
  EXPECT_GT(map.feature_count(), map.size());
  expect_found_to(0.05, map, LocalizeMethod::features);
}

TEST(PlaceMapFromGrid, TheSamePictureInEachModeIsTheSameMap) {
  const GridMapMetadata trinary = metadata_of(0.05);
  const PlaceMap expected = place_map_from_grid(room_image(trinary, usual), trinary).value();
  GridMapMetadata scale = trinary;
  scale.mode = GridMapMode::scale;
  GridMapMetadata raw = trinary;
  raw.mode = GridMapMode::raw;
  GridMapMetadata negative = trinary;
  negative.negate = true;
  const std::vector<PlaceMap> maps{
      place_map_from_grid(room_image(scale, {.free = 250, .occupied = 20, .unknown = 128}), scale).value(),
      place_map_from_grid(room_image(raw, {.free = 0, .occupied = 100, .unknown = 255}), raw).value(),
      place_map_from_grid(room_image(negative, {.free = 1, .occupied = 255, .unknown = 50}), negative).value()};
  for (const PlaceMap& map : maps) {
    EXPECT_TRUE(equal_columns(map, expected));
    EXPECT_EQ(map.evidence(), expected.evidence());
  }
}

TEST(PlaceMapFromGrid, IsTheSameOnAnyNumberOfThreads) {
  const GridMapMetadata metadata = metadata_of(0.1);
  const GreyImage image = room_image(metadata, usual);
  EXPECT_TRUE(equal_columns(place_map_from_grid(image, metadata, {}, {}, 1).value(),
                            place_map_from_grid(image, metadata, {}, {}, 5).value()));
}

TEST(PlaceMapFromGrid, VirtualScansStandClearInFreeSpaceAndSeeTheWalls) {
  const GridMapMetadata metadata = metadata_of(0.05);
  const PlaceMap map =
      place_map_from_grid(room_image(metadata, usual), metadata, {.clearance = 0.4, .beams = 90}).value();
  ASSERT_GT(map.size(), 0U);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Point2 at = map.map_from_sensor(i).translation();
    EXPECT_TRUE(map.evidence().cell(map.evidence().index(at)).free());
    const Scan scan = map.scan(i);
    ASSERT_EQ(scan.ranges.size(), 90U);
    EXPECT_TRUE(is_full_turn(scan));
    for (const BeamPoint& hit : hit_points(scan)) {
      EXPECT_GE(norm(hit.point), 0.37);  // clearance is between centres of cells
      const Point2 beyond = map.map_from_sensor(i) * ((1 + 5e-5 / norm(hit.point)) * hit.point);
      EXPECT_TRUE(map.evidence().cell(map.evidence().index(beyond)).occupied());
    }
  }
}

TEST(PlaceMapFromGrid, BeamsEndExactlyOnThePixelsAndNotInUnknownSpace) {
  // 4 m × 2 m, free but for one occupied column on the right and unknown ones on the left.
  GreyImage image{80, 40, std::vector<std::uint8_t>(3200, 254)};
  for (std::size_t row = 0; row < image.height; ++row) {
    image.pixels[row * image.width + 70] = 0;
    image.pixels[row * image.width + 5] = 205;
  }
  const PlaceMap map = place_map_from_grid(image, {}, {.beams = 8}).value();
  ASSERT_GT(map.size(), 2U);
  const Scan scan = map.scan(0);
  EXPECT_NEAR(scan.ranges[4], 70 * 0.05 - map.map_from_sensor(0).x, 1e-5);
  EXPECT_EQ(classify(scan.ranges[0], scan.beams), Reading::no_return);
  EXPECT_EQ(classify(scan.ranges[2], scan.beams), Reading::no_return);
}

TEST(PlaceMapFromGrid, AGridWithoutFreeSpaceIsAnError) {
  for (const std::uint8_t value : {std::uint8_t{205}, std::uint8_t{0}}) {
    const Result<PlaceMap> map = place_map_from_grid({20, 20, std::vector<std::uint8_t>(400, value)}, {});
    ASSERT_FALSE(map.has_value());
    EXPECT_NE(map.error().message.find("free space"), std::string::npos);
  }
  EXPECT_FALSE(place_map_from_grid({}, {}).has_value());
}

TEST(PlaceMapFromGrid, FreeSpaceTooNarrowForVirtualScansStillIsAMap) {
  GreyImage image{100, 9, std::vector<std::uint8_t>(900, 0)};
  std::fill(image.pixels.begin() + 300, image.pixels.begin() + 600, std::uint8_t{254});
  const PlaceMap map = place_map_from_grid(image, {}).value();
  EXPECT_EQ(map.size(), 0U);
  EXPECT_TRUE(map.evidence().cell({50, 4}).free());
}

}  // namespace
}  // namespace flirt
