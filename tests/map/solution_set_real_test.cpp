#include "flirt/features/extract.hpp"
#include "flirt/io/log.hpp"
#include "flirt/map/solution_set.hpp"

#include "tests/support/data.hpp"

#include <gtest/gtest.h>

namespace flirt {
namespace {

// P1 §4.1: only the query leaves the map; right within 0.5 m and 10°. The papers report 98 %.
TEST(SolutionSetOnRealScans, FindsNineteenOfTwentyUnderThePapersProtocol) {
  const auto file = data_file("fr079/flirtlib-fr079.log.gz");
  if (!file) { GTEST_SKIP() << "fr079/flirtlib-fr079.log.gz is not there"; }
  const ScanLog log = read_log(*file).value().log;
  const PlaceMap map = build_place_map(log).value();
  EXPECT_LE(map.bytes(), 20'000'000U);
  SolutionSetFinder finder(map);
  constexpr std::size_t queries = 50;
  std::size_t right = 0;
  for (std::size_t i = 0; i < queries; ++i) {
    const std::size_t query = 7 + 29 * i;
    const SolutionSet result = finder.find(extract(log.scans[query]), {query, query + 1});
    const Pose2 truth = log.map_from_sensor(query);
    right += result.best() != nullptr && distance(result.best()->map_from_sensor, truth) <= 0.5 &&
                     heading_difference(result.best()->map_from_sensor, truth) <= radians_from_degrees(10)
                 ? 1
                 : 0;
  }
  EXPECT_GE(right, 48U);  // 95 % of 50
}

}  // namespace
}  // namespace flirt
