#include "flirt/io/format.hpp"

#include "flirt/io/relations.hpp"

#include "tests/support/data.hpp"
#include "tests/support/temporary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace flirt {
namespace {

using testing::HasSubstr;

FileFormat format_of_text(std::string_view text) {
  const TemporaryFolder folder;
  return format_of(folder.file("a", text)).value();
}

TEST(FormatOf, GoesByContent) {
  EXPECT_EQ(format_of_text("# c\n\n1.5 0 0 0 0 0 0 1\n"), FileFormat::tum);
  EXPECT_EQ(format_of_text("EDGE_SE2 0 1 ..."), FileFormat::g2o);
  EXPECT_EQ(format_of_text("VERTEX2 0 0 0 0\nEDGE2 0 1 0 0 0 1 0 1 1 0 0\n"), FileFormat::toro);
  EXPECT_EQ(format_of_text("VERTEX2 0 0 0 0\nFLASER 1 1 0 0 0 0 0 0 1 h 1\n"), FileFormat::carmen);
  EXPECT_EQ(format_of_text("PARAM a b\nFLASER 1 1 0 0 0 0 0 0 1 h 1\n"), FileFormat::carmen);
}

TEST(FormatOf, SaysWhatItFoundInstead) {
  const TemporaryFolder folder;
  EXPECT_THAT(format_of(folder.file("a", "hello\n")).error().message, HasSubstr("beginning with 'hello'"));
  EXPECT_THAT(format_of(folder.file("b", "")).error().message, HasSubstr("an empty file"));
}

TEST(FormatByName, LooksBeforeTheEndOfGzip) {
  EXPECT_EQ(format_by_name("x/a.log"), FileFormat::carmen);
  EXPECT_EQ(format_by_name("x/a.log.gz"), std::nullopt) << "files are written plain";
  EXPECT_EQ(format_by_name("a.clf"), FileFormat::carmen);
  EXPECT_EQ(format_by_name("a.mcap"), FileFormat::ros);
  EXPECT_EQ(format_by_name("a.tum"), FileFormat::tum);
  EXPECT_EQ(format_by_name("a.g2o"), FileFormat::g2o);
  EXPECT_EQ(format_by_name("a.graph"), FileFormat::toro);
  EXPECT_EQ(format_by_name("a.png"), std::nullopt);
}

TEST(ReadTrajectory, ReadsPosesOfTumFilesAndLogsButNotOfGraphs) {
  const TemporaryFolder folder;
  const auto from_tum = read_trajectory(folder.file("a", "7 1 2 0 0 0 0 1\n")).value();
  const auto from_log = read_trajectory(folder.file("b", "FLASER 1 1 1 2 0 1 2 0 7 h 1\n")).value();
  EXPECT_EQ(from_tum, from_log);
  EXPECT_THAT(read_trajectory(folder.file("c", "VERTEX2 0 0 0 0\n")).error().message, HasSubstr("found a graph"));
}

TEST(Relations, AreReadInTheirOrder) {
  const TemporaryFolder folder;
  const auto relations = read_relations(folder.file("a", "# c\n1.5 2.5 1 2 9 9 9 -0.5\n3 1 0 0 0 0 0 7\n")).value();
  ASSERT_EQ(relations.size(), 2U);
  EXPECT_EQ(relations[0].first_stamp, 1.5);
  EXPECT_EQ(relations[0].second_stamp, 2.5);
  EXPECT_EQ(relations[0].first_from_second, (Pose2{1, 2, -0.5}));
  EXPECT_NEAR(relations[1].first_from_second.theta, 0.716814692820414, 1e-12);
}

TEST(Relations, AreRefusedWithTheirPlace) {
  const TemporaryFolder folder;
  EXPECT_THAT(read_relations(folder.file("a", "1 2 3 4 5 6 7 8\n1 2 3\n")).error().message,
              HasSubstr("a:2: expected 8 finite numbers, found the end of the line"));
  EXPECT_THAT(read_relations(folder.file("c", "1 2 1e300 4 5 6 7 8\n")).error().message,
              HasSubstr("expected a motion of less than 10 000 km"));
  EXPECT_THAT(read_relations(folder.file("b", "1 2 3 4 5 6 7 8 9\n")).error().message, HasSubstr("found more: '9'"));
}

TEST(Relations, OfCorrectedLogsGiveTheKnownErrors) {
  const auto log = data_file("intel/intel-910-merged.log.gz");
  const auto file = data_file("intel/intel.relations");
  if (!log || !file) { GTEST_SKIP() << "no real logs"; }
  const RelationsError error = relations_error(read_trajectory(*log).value(), read_relations(*file).value());
  EXPECT_EQ(error.difference.translation.count, 90U);
  EXPECT_NEAR(error.difference.translation.mean, 0.0363, 0.00005);
  EXPECT_NEAR(error.difference.translation.deviation, 0.027, 0.0005);
  EXPECT_NEAR(error.difference.rotation_degrees.mean, 0.417, 0.0005);
}

}  // namespace
}  // namespace flirt
