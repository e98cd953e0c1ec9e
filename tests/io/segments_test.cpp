#include "flirt/io/segments.hpp"

#include "flirt/io/file.hpp"
#include "flirt/io/floor_plan.hpp"

#include "tests/support/data.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace flirt {
namespace {

using testing::HasSubstr;

class Segments : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& text) const {
    const std::filesystem::path path =
        std::filesystem::path(testing::TempDir()) /
        (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".txt");
    EXPECT_TRUE(write_file_atomically(path, text).has_value());
    return path;
  }
};

TEST_F(Segments, ReadsFourNumbersALine) {
  const auto plan = read_segments(file("# a comment\n1,2,3.5,-4\n\n  -1e1, 0 ,+2, 0.25  \r\n"));
  ASSERT_TRUE(plan) << plan.error().message;
  ASSERT_EQ(plan->segments.size(), 2U);
  EXPECT_EQ(plan->segments[0].begin, (Point2{1, 2}));
  EXPECT_EQ(plan->segments[0].end, (Point2{3.5, -4}));
  EXPECT_EQ(plan->segments[1].begin, (Point2{-10, 0}));
  EXPECT_EQ(plan->segments[1].end, (Point2{2, 0.25}));
}

TEST_F(Segments, ErrorNamesFileLineAndWhatWasFound) {
  for (const std::string bad : {"1,2,3", "1,2,3,4,5", "1,2,x,4", "1,2,3,nan", "1 2 3 4", "1,,3,4", "1,2,3,4 5"}) {
    const auto plan = read_segments(file("0,0,1,1\n" + bad + "\n"));
    ASSERT_FALSE(plan) << bad;
    EXPECT_THAT(plan.error().message, HasSubstr(".txt:2: expected a segment as x1,y1,x2,y2, found '" + bad));
  }
}

TEST_F(Segments, FileWithoutSegmentsIsAnError) {
  const auto plan = read_segments(file("# nothing\n\n"));
  ASSERT_FALSE(plan);
  EXPECT_THAT(plan.error().message, HasSubstr("found none"));
}

TEST_F(Segments, MissingFileIsAnError) {
  EXPECT_FALSE(read_segments("/nowhere/plan.txt"));
}

TEST_F(Segments, ImageNeedsAResolutionAndNothingElseDoes) {
  const auto image = read_floor_plan("/nowhere/plan.png");
  ASSERT_FALSE(image);
  EXPECT_THAT(image.error().message, HasSubstr("resolution"));
  const auto text = read_floor_plan(file("0,0,1,1\n"), 0.05);
  ASSERT_FALSE(text);
  EXPECT_THAT(text.error().message, HasSubstr("resolution"));
}

TEST_F(Segments, ReadsThePublishedVectorMaps) {
  const auto maps = data_file("maps/amrl");
  if (!maps) { GTEST_SKIP() << "maps/amrl is not there"; }
  for (const auto& [name, count] :
       {std::pair{"GDC1.vectormap.txt", 1289U}, {"GHC3.vectormap.txt", 2082U}, {"orebro.vectormap.txt", 80U}}) {
    const auto plan = read_floor_plan(*maps / name);
    ASSERT_TRUE(plan) << plan.error().message;
    EXPECT_NEAR(static_cast<double>(plan->segments.size()), count, 1) << name;
  }
}

}  // namespace
}  // namespace flirt
