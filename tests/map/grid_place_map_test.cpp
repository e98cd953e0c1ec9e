#include "flirt/map/grid_place_map.hpp"

#include "flirt/eval/revisit.hpp"
#include "flirt/io/log.hpp"
#include "flirt/map/localize.hpp"

#include "tests/support/data.hpp"
#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace flirt {
namespace {

constexpr double side = 14;  // m, of the image around the room

/// The room of tests/support as pixels: walls occupied, the rest of the image free.
GreyImage picture_of(const Scene& scene, const GridMapMetadata& metadata) {
  const auto pixels = static_cast<std::size_t>(std::lround(side / metadata.resolution));
  GreyImage image{pixels, pixels, std::vector<std::uint8_t>(pixels * pixels, 254)};
  const Pose2 image_from_map = inverse(metadata.origin);
  for (const Wall& wall : scene) {
    const Point2 along = wall.end - wall.begin;
    const int steps = static_cast<int>(norm(along) / (0.2 * metadata.resolution)) + 1;
    for (int i = 0; i <= steps; ++i) {
      const Point2 at = image_from_map * (wall.begin + static_cast<double>(i) / steps * along);
      const auto column = static_cast<std::size_t>(at.x / metadata.resolution);
      const auto row = pixels - 1 - static_cast<std::size_t>(at.y / metadata.resolution);
      image.pixels[row * pixels + column] = 0;
    }
  }
  return image;
}

class GridPlaceMap : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(GridPlaceMap, ScansOfTheRoomAreFoundInItsPicture) {
  const auto [resolution, turn] = GetParam();
  const Pose2 centred{-side / 2, -side / 2, 0};
  const GridMapMetadata metadata{.resolution = resolution, .origin = Pose2{0.3, -0.2, turn} * centred};
  const PlaceMap map = place_map_from_grid(picture_of(furnished_room(), metadata), metadata).value();
  EXPECT_GT(map.size(), 10U);
  EXPECT_GT(map.feature_count(), 20U);
  Localizer localizer(map);
  for (const Pose2& truth : {Pose2{0.3, 0.2, 1.0}, Pose2{-0.6, 0.9, -2.8}, Pose2{1.0, -1.2, 0.1}}) {
    const Scan scan = scan_of(furnished_room(), truth, turn_beams(), turn_beam_count);
    const LocalizationResult found = localizer.localize(scan);
    ASSERT_NE(found.best(), nullptr);
    EXPECT_EQ(found.verdict, Verdict::unique);
    EXPECT_LT(distance(found.best()->map_from_sensor, truth), 0.5 * resolution + 0.05);
    EXPECT_LT(heading_difference(found.best()->map_from_sensor, truth), 0.03);
  }
}

INSTANTIATE_TEST_SUITE_P(ResolutionsAndTurns, GridPlaceMap,
                         testing::Values(std::pair{0.05, 0.0}, std::pair{0.025, 0.0}, std::pair{0.1, 0.0},
                                         std::pair{0.05, 0.7}));

TEST(GridPlaceMap, AGridWithoutFreeCellsIsAnError) {
  const GreyImage grey{20, 20, std::vector<std::uint8_t>(400, 205)};
  const Result<PlaceMap> map = place_map_from_grid(grey, {});
  ASSERT_FALSE(map.has_value());
  EXPECT_NE(map.error().message.find("found none"), std::string::npos);
}

TEST(GridPlaceMap, AnAbsurdResolutionIsAnErrorAndNoMemoryIsTaken) {
  const GreyImage white{2000, 2000, std::vector<std::uint8_t>(4000000, 254)};
  EXPECT_FALSE(place_map_from_grid(white, {.resolution = 50}).has_value());
}

// Issue of a robot with a map server: the grid of one log (freiburg-079-corrected), questions from another correction
// of the same drive (flirtlib-fr079), whose frame differs by a small rigid motion.
TEST(GridPlaceMapOnRealScans, FindsScansInTheGridOfAnotherLog) {
  const auto mapped = data_file("fr079/freiburg-079-corrected.log.gz");
  const auto asked = data_file("fr079/flirtlib-fr079.log.gz");
  if (!mapped || !asked) { GTEST_SKIP() << "the fr079 logs are not there"; }
  const ScanLog log = read_log(*mapped).value().log;
  EvidenceGrid evidence;
  for (std::size_t i = 0; i < log.scans.size(); i += 3) { evidence.add(log.scans[i], log.map_from_sensor(i)); }
  const CellBox box = *evidence.bounds();
  GreyImage image{box.width(), box.height(), std::vector<std::uint8_t>(box.width() * box.height(), 205)};
  for (std::size_t row = 0; row < image.height; ++row) {
    for (std::size_t column = 0; column < image.width; ++column) {
      const EvidenceCell cell = evidence.cell(
          {box.min.x + static_cast<std::int32_t>(column), box.max.y - 1 - static_cast<std::int32_t>(row)});
      if (cell.seen()) { image.pixels[row * image.width + column] = cell.occupied() ? 0 : 254; }
    }
  }
  const GridMapMetadata metadata{.origin = {box.min.x * 0.05, box.min.y * 0.05, 0}};
  const PlaceMap map = place_map_from_grid(image, metadata).value();

  const ScanLog queries = read_log(*asked).value().log;
  std::vector<std::size_t> chosen;
  for (std::size_t i = 5; i < queries.scans.size(); i += 29) { chosen.push_back(i); }
  const std::vector<bool> can_answer = answerable(queries, chosen, {}, 2);
  Localizer localizer(map);
  std::size_t asked_count = 0;
  std::size_t right = 0;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    if (!can_answer[k]) { continue; }
    ++asked_count;
    const LocalizationResult found = localizer.localize(queries.scans[chosen[k]]);
    const Pose2 truth = queries.map_from_sensor(chosen[k]);
    right += found.best() != nullptr && distance(found.best()->map_from_sensor, truth) <= 0.5 &&
                     heading_difference(found.best()->map_from_sensor, truth) <= radians_from_degrees(10)
                 ? 1
                 : 0;
  }
  RecordProperty("asked", static_cast<int>(asked_count));
  RecordProperty("right", static_cast<int>(right));
  EXPECT_GE(asked_count, 25U);
  EXPECT_GE(static_cast<double>(right), 0.97 * static_cast<double>(asked_count)) << right << " of " << asked_count;
}

}  // namespace
}  // namespace flirt
