#include "flirt/eval/localization_ablation.hpp"

#include "tests/support/room_map.hpp"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace flirt {
namespace {

TEST(Ablation, VariantsHaveNamesOfTheirOwnAndFullComesFirst) {
  const std::vector<LocalizationVariant> variants = localization_variants({});
  std::set<std::string_view> names;
  for (const LocalizationVariant& variant : variants) { names.insert(variant.name); }
  EXPECT_EQ(names.size(), variants.size());
  EXPECT_EQ(variants.front().name, "full");
}

TEST(Ablation, ComparesEachVariantWithFullOnTheSameQueries) {
  // Two rounds in a room; 0.3 m of travel leave the map, so that the other round answers.
  std::vector<Pose2> poses = poses_around(1.2, 8);
  for (const Pose2& pose : poses_around(1.1, 8)) { poses.push_back(pose); }
  const ScanLog log = log_of(furnished_room(), poses);
  const PlaceMap map = build_place_map(log).value();
  LocalizationBenchParams params;
  params.every = 4;
  params.revisit.travel = 0.3;
  LocalizeParams perverse;
  perverse.search.score.preference = {.likelihood = -1, .free = 1, .unknown = 1, .through = 1};
  const std::vector<LocalizationVariant> variants{{"full", "", {}}, {"same", "", {}}, {"perverse", "", perverse}};
  const std::vector<LocalizationVariantRow> rows = ablate_localization(log, map, params, variants, 1);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].success.total, 4U);
  EXPECT_EQ(rows[0].success.hits, 4U);
  EXPECT_EQ(rows[1].from_full.only_first + rows[1].from_full.only_second, 0U);
  EXPECT_DOUBLE_EQ(rows[1].from_full.p_value(), 1);
  EXPECT_EQ(rows[2].from_full.only_first, rows[0].success.hits - rows[2].success.hits);
  EXPECT_GT(rows[2].from_full.only_first, 0U);
  EXPECT_LE(rows[2].difference.high, 0);
}

}  // namespace
}  // namespace flirt
