// Grid maps of real buildings: a robot finds itself in what its map server has.
#include "flirt/eval/revisit.hpp"
#include "flirt/io/log.hpp"
#include "flirt/io/occupancy_map.hpp"
#include "flirt/io/ros_map.hpp"
#include "flirt/map/grid_place_map.hpp"
#include "flirt/map/localize.hpp"
#include "flirt/sim/free_space.hpp"
#include "flirt/sim/lidar.hpp"

#include "tests/support/data.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace flirt {
namespace {

bool is_right(const LocalizationResult& result, const Pose2& truth) {
  return result.best() != nullptr && distance(result.best()->map_from_sensor, truth) <= 0.5 &&
         heading_difference(result.best()->map_from_sensor, truth) <= radians_from_degrees(10);
}

/// Right answers, what was called unique, and what of that was right.
struct Tally {
  std::size_t asked{0};
  std::size_t right{0};
  std::size_t unique{0};
  std::size_t unique_right{0};

  void add(const LocalizationResult& result, const Pose2& truth) {
    ++asked;
    const bool right_now = is_right(result, truth);
    right += right_now ? 1 : 0;
    unique += result.verdict == Verdict::unique ? 1 : 0;
    unique_right += result.verdict == Verdict::unique && right_now ? 1 : 0;
  }
  void add(const Tally& other) {
    asked += other.asked;
    right += other.right;
    unique += other.unique;
    unique_right += other.unique_right;
  }
  [[nodiscard]] double success() const { return static_cast<double>(right) / static_cast<double>(asked); }
  [[nodiscard]] double called_unique() const { return static_cast<double>(unique) / static_cast<double>(asked); }
  void print(const std::string& what) const {
    std::printf("%-34s %3zu of %3zu right (%.3f); unique %3zu, of these right %3zu\n", what.c_str(), right, asked,
                success(), unique, unique_right);
  }
};

std::vector<Point2> end_points(const Scan& scan) {
  std::vector<Point2> points;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range = scan.ranges[i];
    if (range > 0.05 && range < 50.0) {
      points.push_back({range * std::cos(scan.beams.angle(i)), range * std::sin(scan.beams.angle(i))});
    }
  }
  return points;
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

/// The motion between the frames of two corrections of the same scans, from answers: medians, so that a wrong answer
/// does not count.
Pose2 grid_from_log(const std::vector<LocalizationResult>& answers, const std::vector<Pose2>& truths) {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> theta;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (answers[i].verdict == Verdict::unique) {
      theta.push_back(wrap_angle(answers[i].best()->map_from_sensor.theta - truths[i].theta));
    }
  }
  if (theta.empty()) { return {}; }
  const double turn = median(theta);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (answers[i].verdict != Verdict::unique) { continue; }
    const Point2 moved = Pose2{0, 0, turn} * truths[i].translation();
    x.push_back(answers[i].best()->map_from_sensor.x - moved.x);
    y.push_back(answers[i].best()->map_from_sensor.y - moved.y);
  }
  return {median(x), median(y), turn};
}

TEST(PlaceMapFromGridOfARealBuilding, FindsTheScansOfAnotherCorrectionOfTheDrive) {
  const auto mapped = data_file("fr079/freiburg-079-corrected.log.gz");
  const auto asked = data_file("fr079/flirtlib-fr079.log.gz");
  if (!mapped || !asked) { GTEST_SKIP() << "the logs of fr079 are not there"; }
  const ScanLog log = read_log(*mapped).value().log;
  EvidenceGrid evidence;
  for (std::size_t i = 0; i < log.scans.size(); ++i) { evidence.add(log.scans[i], log.map_from_sensor(i)); }
  const GridMapImage grid = occupancy_map(evidence, "map.pgm").value();
  const PlaceMap map = place_map_from_grid(grid.image, grid.metadata).value();

  const ScanLog queries = read_log(*asked).value().log;
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < queries.scans.size(); i += 12) { chosen.push_back(i); }
  const std::vector<bool> can_answer = answerable(queries, chosen, {}, 0);
  std::vector<LocalizationResult> answers;
  std::vector<Pose2> truths;
  Localizer localizer(map);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!can_answer[i]) { continue; }
    answers.push_back(localizer.localize(queries.scans[chosen[i]]));
    truths.push_back(queries.map_from_sensor(chosen[i]));
  }
  const Pose2 between = grid_from_log(answers, truths);
  Tally tally;
  for (std::size_t i = 0; i < answers.size(); ++i) { tally.add(answers[i], between * truths[i]); }
  std::printf("%zu virtual scans; grid_from_log: %.3f m, %.3f m, %.2f deg\n", map.size(), between.x, between.y,
              degrees_from_radians(between.theta));
  tally.print("fr079, answerable queries");
  EXPECT_GE(tally.asked, 60U);
  EXPECT_GE(tally.success(), 0.97);
}

/// A log of which the scans of every second stretch of 20 m make maps.
struct HalvedLog {
  ScanLog log;
  std::vector<std::size_t> mapped{};
  std::vector<std::size_t> asked{};  ///< of the other stretches, what sees half of what a mapped scan saw

  [[nodiscard]] EvidenceGrid evidence(const Pose2& grid_from_map) const {
    EvidenceGrid evidence;
    for (const std::size_t i : mapped) { evidence.add(log.scans[i], grid_from_map * log.map_from_sensor(i)); }
    return evidence;
  }
  [[nodiscard]] bool can_answer(std::size_t query) const {
    const std::vector<Point2> points = end_points(log.scans[query]);
    const Pose2 truth = log.map_from_sensor(query);
    return 2 * points.size() >= log.scans[query].ranges.size() && std::ranges::any_of(mapped, [&](std::size_t i) {
             return distance(truth, log.map_from_sensor(i)) < 15.0 &&
                    overlap(points, truth, end_points(log.scans[i]), log.map_from_sensor(i), 0.1) >= 0.5;
           });
  }
};

HalvedLog halve(ScanLog log) {
  const std::vector<double> lengths = path_lengths(log);
  HalvedLog half{std::move(log)};
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    (static_cast<int>(lengths[i] / 20.0) % 2 == 0 ? half.mapped : half.asked).push_back(i);
  }
  std::erase_if(half.asked, [&](std::size_t query) { return !half.can_answer(query); });
  return half;
}

Tally found_in(const MapFields& fields, const HalvedLog& half) {
  Tally tally;
  for (const std::size_t query : half.asked) {
    const ScanPoints points = scan_points(half.log.scans[query]);
    const std::vector<ScoredPose> poses = search(fields, points);
    LocalizationResult result{.verdict = judge_answer(poses, points.size()).verdict};
    if (!poses.empty()) { result.hypotheses.push_back({.map_from_sensor = poses.front().map_from_sensor}); }
    tally.add(result, half.log.map_from_sensor(query));
  }
  return tally;
}

/// Other programs know nothing of the borders of our cells.
constexpr Pose2 grid_from_map{0.017, 0.031, 0};

/// One pixel for each cell that beams have been in; `shade` gets the cell's index.
template <class Shade>
GridMapImage draw(const EvidenceGrid& evidence, Shade&& shade) {
  const CellBox box = evidence.bounds().value();
  const Pose2 grid_from_image{0.05 * box.min.x, 0.05 * box.min.y, 0};
  GridMapImage map{.image = {box.width(), box.height(), {}},
                   .metadata = {.origin = inverse(grid_from_map) * grid_from_image}};
  for (std::int32_t y = box.max.y - 1; y >= box.min.y; --y) {
    for (std::int32_t x = box.min.x; x < box.max.x; ++x) { map.image.pixels.push_back(shade(CellIndex{x, y})); }
  }
  return map;
}

/// Three shades: black where more than a share of at least so many beams ended.
GridMapImage counting_map(const HalvedLog& half, int least_beams, double share) {
  const EvidenceGrid evidence = half.evidence(grid_from_map);
  return draw(evidence, [&](CellIndex at) -> std::uint8_t {
    const EvidenceCell cell = evidence.cell(at);
    const int beams = cell.hits + cell.passes;
    return beams < least_beams ? 205 : cell.hits > share * beams ? 0 : 254;
  });
}

GridMapImage karto_map(const HalvedLog& half) {
  return counting_map(half, 2, 0.1);
}

GridMapImage gmapping_map(const HalvedLog& half) {
  return counting_map(half, 1, 0.25);
}

/// Every wall a pixel thicker, to the left and upwards.
GridMapImage thicker(const GridMapImage& map) {
  GridMapImage thick = map;
  for (std::size_t row = 0; row + 1 < map.image.height; ++row) {
    for (std::size_t column = 0; column + 1 < map.image.width; ++column) {
      const bool is_beside_wall = map.image.at(column + 1, row) == 0 || map.image.at(column, row + 1) == 0 ||
                                  map.image.at(column + 1, row + 1) == 0;
      if (is_beside_wall) { thick.image.pixels[row * map.image.width + column] = 0; }
    }
  }
  return thick;
}

GridMapImage thick_karto_map(const HalvedLog& half) {
  return thicker(karto_map(half));
}

/// Probabilities: each scan multiplies the odds of a cell once, by .55 / .45 where a beam ended and .49 / .51 where
/// some passed; unseen space is even odds.
GridMapImage cartographer_map(const HalvedLog& half) {
  const EvidenceGrid seen = half.evidence(grid_from_map);
  const CellBox box = seen.bounds().value();
  const auto offset = [&](CellIndex at) {
    return static_cast<std::size_t>(at.y - box.min.y) * box.width() + static_cast<std::size_t>(at.x - box.min.x);
  };
  std::vector<double> log_odds(box.width() * box.height());
  for (const std::size_t i : half.mapped) {
    EvidenceGrid scan;
    scan.add(half.log.scans[i], grid_from_map * half.log.map_from_sensor(i));
    scan.for_each_row([&](CellIndex first, std::span<const EvidenceCell> row) {
      for (std::size_t k = 0; k < row.size(); ++k) {
        if (!row[k].seen()) { continue; }
        double& odds = log_odds[offset({first.x + static_cast<std::int32_t>(k), first.y})];
        odds += row[k].hits > 0 ? std::log(0.55 / 0.45) : std::log(0.49 / 0.51);
        odds = std::clamp(odds, std::log(0.12 / 0.88), std::log(0.98 / 0.02));
      }
    });
  }
  return draw(seen, [&](CellIndex at) -> std::uint8_t {
    if (!seen.cell(at).seen()) { return 128; }
    return static_cast<std::uint8_t>(std::lround(255 / (1 + std::exp(log_odds[offset(at)]))));
  });
}

GridMapImage own_map(const HalvedLog& half) {
  return occupancy_map(half.evidence({}), "map.pgm").value();
}

struct GridMaker {
  const char* name;
  GridMapImage (*map)(const HalvedLog&);
  double unique;  ///< by how much less of the scans may be called unique than by the scans themselves
};

TEST(PlaceMapFromGridOfARealBuilding, FindsScansAboutAsWellAsTheScansThatMadeIt) {
  for (const std::string file : {"aces/aces-corrected.log.gz", "fr101/freiburg-101-corrected.log.gz"}) {
    const auto path = data_file(file);
    if (!path) { GTEST_SKIP() << "not there: " << file; }
    const HalvedLog half = halve(read_log(*path).value().log);
    EXPECT_GT(half.asked.size(), 50U);
    const Tally by_scans = found_in(map_fields(half.evidence({})), half);
    by_scans.print(file + ", scans");
    for (const GridMaker& maker :
         {GridMaker{"flirt slam", own_map, 0.1}, GridMaker{"Karto", karto_map, 0.15},
          GridMaker{"Karto, thick", thick_karto_map, 0.4}, GridMaker{"GMapping", gmapping_map, 0.1},
          GridMaker{"Cartographer", cartographer_map, 0.2}}) {
      const GridMapImage grid = maker.map(half);
      const PlaceMap map = place_map_from_grid(grid.image, grid.metadata).value();
      const Tally by_grid = found_in(map_fields(map.evidence()), half);
      by_grid.print(std::string("  grid by ") + maker.name);
      EXPECT_GE(by_grid.success(), by_scans.success() - 0.05) << maker.name;
      EXPECT_GE(by_grid.called_unique(), by_scans.called_unique() - maker.unique) << maker.name;
      EXPECT_EQ(by_grid.unique_right, by_grid.unique) << maker.name;
    }
  }
}

/// Shortens a share of the beams, in runs of 8, as people's legs do.
void hide_behind_people(Scan& scan, double share, Rng& rng) {
  constexpr std::size_t run = 8;
  for (std::size_t i = 0; i < scan.ranges.size(); i += run) {
    if (rng.uniform() >= share) { continue; }
    const double range = std::min(4.0, rng.uniform(0.2, 0.9) * scan.ranges[i]);
    for (std::size_t k = i; k < std::min(i + run, scan.ranges.size()); ++k) {
      scan.ranges[k] = std::min(scan.ranges[k], range + rng.normal(0, 0.02));
    }
  }
}

/// Scans of a simulated lidar at up to `places` places all over the map.
Tally found_in(const GridMapImage& grid, Localizer& localizer, double field_of_view, double people,
               std::size_t places) {
  const FloorPlan plan = plan_from_image(grid.image, grid.metadata);
  const RayCaster caster(plan);
  std::vector<Point2> points = FreeSpace(plan, 0.3).spread(2.0, 1);
  points.resize(std::min(points.size(), places));
  const Lidar lidar({.field_of_view = field_of_view});
  Rng rng(7);
  Tally tally;
  for (const Point2& point : points) {
    const Pose2 truth{point.x, point.y, rng.uniform(-std::numbers::pi, std::numbers::pi)};
    Scan scan{.beams = lidar.beams(), .ranges = lidar.measure(caster, {}, truth, rng)};
    hide_behind_people(scan, people, rng);
    tally.add(localizer.localize(scan), truth);
  }
  return tally;
}

GridMapImage real_grid(const std::filesystem::path& path) {
  if (path.extension() == ".yaml") { return read_grid_map(path).value(); }
  return {read_grey_image(path).value(), {.image = path.filename().string()}};
}

struct GridFile {
  const char* name;
  double success;  ///< least share of right answers, over all lidars
};

TEST(PlaceMapFromGridOfARealBuilding, SimulatedLidarsAreFoundAmongPeople) {
  // The hospital repeats its rooms, and robocup its compartments: half a turn of view cannot always tell them apart.
  for (const GridFile& file :
       {GridFile{"maps/willow/willow-full-0.05.pgm", 0.97}, GridFile{"maps/stdr/frieburg.yaml", 0.95},
        GridFile{"maps/stdr/hospital_section.yaml", 0.8}, GridFile{"maps/stdr/robocup.yaml", 0.75}}) {
    const auto path = data_file(file.name);
    if (!path) { GTEST_SKIP() << file.name << " is not there"; }
    const GridMapImage grid = real_grid(*path);
    const PlaceMap map = place_map_from_grid(grid.image, grid.metadata).value();
    std::printf("%s: %zu virtual scans, %.1f MB\n", file.name, map.size(), static_cast<double>(map.bytes()) / 1e6);
    Localizer localizer(map);
    Tally all;
    for (const double degrees : {180.0, 270.0, 359.99}) {
      const Tally tally = found_in(grid, localizer, radians_from_degrees(degrees), 0.3, 12);
      tally.print("  " + std::to_string(std::lround(degrees)) + " deg, 30 % people");
      all.add(tally);
    }
    EXPECT_GE(all.success(), file.success) << file.name;
    EXPECT_GE(static_cast<double>(all.unique_right), 0.98 * static_cast<double>(all.unique)) << file.name;
  }
}

}  // namespace
}  // namespace flirt
