// Agreement of the detectors with what the authors' own program computed on 40 scans of fr079.
//
// The program is set to that one's choices wherever those are a matter of choice: kernels cut off at ±⌈t⌉ samples,
// spanning trees for the geodesics, peaks that exceed both neighbours, moves to the foreground however small the jump,
// direction and support region from where the signal peaks, detections of one scale in order of their angle. Its faults
// are not copied into the library; where one would spoil the comparison, the test emulates it:
// - signals go on by mirroring about the outermost sample on the left, but about the edge beside it on the right: each
//   half of a scan is compared with the result for the border on its side;
// - duplicates are dropped within a box along the axes of the world: the test asks for all detections, drops by the
// box;
// - the ends of a scan are its first and last beam even when these have no return, where the library takes the first
//   and last point;
// - ties between equal distances (ranges are whole centimetres) make its spanning trees depend on the rounding of world
//   coordinates: the curvature signal is compared on trees that the test builds of just those coordinates, with exact
//   ties in the order (one of two) that agrees better. Peaks and keypoints are compared over the whole library, whose
//   trees decide ties by index: that moves the smoothed curve by a fraction of a millimetre, a few responses over a
//   threshold, and a few directions by more than 0.01 rad;
// - its first derivative has the opposite sign (the mask of P2 eq. 6 mirrored by the convolution): negated here.
#include "flirt/features/curve_smoothing.hpp"
#include "flirt/features/detect.hpp"
#include "flirt/features/geodesic.hpp"

#include "tests/features/gz_lines.hpp"
#include "tests/support/data.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace flirt {
namespace {

using Json = nlohmann::json;

std::vector<Json> records(const std::string& name) {
  std::vector<Json> records;
  for (const std::string& line : gz_lines(*data_file("reference/" + name))) { records.push_back(Json::parse(line)); }
  return records;
}

std::vector<Scan> fr079_scans() {
  std::vector<Scan> scans;
  for (const std::string& line : gz_lines(*data_file("fr079/flirtlib-fr079.log.gz"))) {
    std::istringstream words(line);
    std::string word;
    if (!(words >> word) || word != "ROBOTLASER1") { continue; }
    Scan scan;
    double ignored = 0.0;
    std::size_t count = 0;
    words >> ignored >> scan.beams.angle_min >> ignored >> scan.beams.angle_step >> scan.beams.range_max >> ignored >>
        ignored >> count;
    scan.ranges.resize(count);
    for (double& range : scan.ranges) { words >> range; }
    scans.push_back(scan);
  }
  return scans;
}

Pose2 pose_of(const Json& record) {
  return {record["laser_pose"][0], record["laser_pose"][1], record["laser_pose"][2]};
}

/// Where the reference program puts a beam's end: the angle is added up before the cosine is taken.
Point2 world_point(const Scan& scan, const Pose2& world_from_sensor, std::size_t beam) {
  const double angle = scan.beams.angle(beam) + world_from_sensor.theta;
  return {world_from_sensor.x + scan.ranges[beam] * std::cos(angle),
          world_from_sensor.y + scan.ranges[beam] * std::sin(angle)};
}

/// Share of things found equal.
struct Tally {
  std::size_t equal{0};
  std::size_t all{0};

  void count(bool is_equal) {
    equal += is_equal ? 1 : 0;
    ++all;
  }
  template <class T>
  void count_sets(const std::set<T>& ours, const std::set<T>& theirs) {
    std::vector<T> common;
    std::ranges::set_intersection(ours, theirs, std::back_inserter(common));
    equal += common.size();
    all += ours.size() + theirs.size() - common.size();
  }
  void add(const Tally& other) {
    equal += other.equal;
    all += other.all;
  }
  [[nodiscard]] double share() const { return static_cast<double>(equal) / static_cast<double>(all); }
  void report(const char* what) const {
    std::printf("  %-42s %8.4f %% of %zu\n", what, 100.0 * share(), all);
    EXPECT_GE(share(), 0.99) << what;
    EXPECT_GT(all, 0U) << what;
  }
};

bool close(double ours, double theirs) {
  return std::abs(ours - theirs) <= 1e-9 * std::max(std::abs(theirs), 1e-3);
}

void compare_signal(const std::vector<double>& left, const std::vector<double>& right, const Json& theirs, double sign,
                    Tally& tally) {
  ASSERT_EQ(left.size(), theirs.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    tally.count(close(2 * i < left.size() ? left[i] : right[i], sign * theirs[i].get<double>()));
  }
}

/// The duplicate and end rules of the reference program on keypoints that were detected without any.
std::vector<Keypoint> select_like_reference(const std::vector<Keypoint>& keypoints, const Scan& scan,
                                            const Pose2& world_from_sensor, double end_margin) {
  const Point2 first = world_point(scan, world_from_sensor, 0);
  const Point2 last = world_point(scan, world_from_sensor, scan.ranges.size() - 1);
  std::vector<Keypoint> kept;
  std::vector<Point2> points;
  for (const Keypoint& keypoint : keypoints) {
    const Point2 point = world_point(scan, world_from_sensor, keypoint.beam);
    const bool duplicate = std::ranges::any_of(
        points, [&](Point2 other) { return std::abs(other.x - point.x) < 0.2 && std::abs(other.y - point.y) < 0.2; });
    const double margin = end_margin * static_cast<double>(keypoint.scale);
    if (duplicate || norm(point - first) < margin || norm(point - last) < margin) { continue; }
    kept.push_back(keypoint);
    points.push_back(point);
  }
  return kept;
}

/// Beam and level of our keypoints and of theirs, and for those in both the difference of direction and support.
struct KeypointTallies {
  Tally places{};
  Tally directions{};
  Tally supports{};

  void compare(const std::vector<Keypoint>& ours, const Json& record, const Scan& scan, bool world_directions) {
    const Pose2 world_from_sensor = pose_of(record);
    std::set<std::pair<std::uint32_t, int>> our_places;
    std::set<std::pair<std::uint32_t, int>> their_places;
    std::map<std::pair<std::uint32_t, int>, const Keypoint*> found;
    for (const Keypoint& keypoint : ours) {
      our_places.emplace(keypoint.beam, keypoint.level);
      found[{keypoint.beam, keypoint.level}] = &keypoint;
    }
    for (const Json& theirs : record["points"]) {
      const Point2 point{theirs["x"], theirs["y"]};
      std::uint32_t beam = 0;
      for (std::uint32_t i = 1; i < scan.ranges.size(); ++i) {
        const auto distance = [&](std::uint32_t k) { return norm(world_point(scan, world_from_sensor, k) - point); };
        if (distance(i) < distance(beam)) { beam = i; }
      }
      const std::pair<std::uint32_t, int> place{beam, theirs["level"].get<int>()};
      their_places.insert(place);
      const auto match = found.find(place);
      if (match == found.end()) { continue; }
      const double theta = theirs["theta"].get<double>() - (world_directions ? world_from_sensor.theta : 0.0);
      directions.count(std::abs(wrap_angle(match->second->sensor_from_keypoint.theta - theta)) < 0.01);
      const double support = theirs["scale"];
      supports.count(std::abs(static_cast<double>(match->second->support_radius) - support) < 1e-6 * support);
    }
    places.count_sets(our_places, their_places);
  }
};

template <class Params>
Params reference_params(Border border) {
  Params params;
  params.selection.anchor = Anchor::peak;
  params.selection.precedence = Precedence::angle;
  params.selection.foreground_jump = 0.0;
  params.peaks.rule = PeakRule::neighbours;
  params.selection.duplicate_radius = 0.0;
  params.smoothing.truncation = Truncation::half_width;
  params.smoothing.border = border;
  return params;
}

std::set<std::uint32_t> spliced(const std::vector<std::uint32_t>& left, const std::vector<std::uint32_t>& right,
                                std::size_t n) {
  std::set<std::uint32_t> peaks;
  for (const std::uint32_t peak : left) {
    if (2 * peak < n) { peaks.insert(peak); }
  }
  for (const std::uint32_t peak : right) {
    if (2 * peak >= n) { peaks.insert(peak); }
  }
  return peaks;
}

template <class Params>
void compare_signal_detector(const std::string& name) {
  if (!data_file("reference/fr079." + name + ".jsonl.gz")) { GTEST_SKIP() << "reference output is absent"; }
  const std::vector<Scan> scans = fr079_scans();
  std::map<std::size_t, Json> signals;
  for (Json& record : records("fr079." + name + ".signals.jsonl.gz")) { signals[record["scan"]] = record; }
  Tally signal;
  Tally smoothed;
  Tally response;
  Tally peaks;
  KeypointTallies keypoints;
  for (const Json& record : records("fr079." + name + ".jsonl.gz")) {
    const std::size_t index = record["scan"];
    const Scan& scan = scans[index];
    DetectorTrace left;
    DetectorTrace right;
    const auto found = detect(scan, reference_params<Params>(Border::mirror_sample), &left);
    const auto found_right = detect(scan, reference_params<Params>(Border::mirror_edge), &right);
    std::vector<Keypoint> all;
    for (const Keypoint& keypoint : found) {
      if (2 * keypoint.beam < scan.ranges.size()) { all.push_back(keypoint); }
    }
    for (const Keypoint& keypoint : found_right) {
      if (2 * keypoint.beam >= scan.ranges.size()) { all.push_back(keypoint); }
    }
    std::ranges::stable_sort(all, {}, &Keypoint::level);
    if (const auto theirs = signals.find(index); theirs != signals.end()) {
      compare_signal(left.signal, right.signal, theirs->second["signal"], 1.0, signal);
      for (std::size_t level = 0; level < 5; ++level) {
        compare_signal(left.scales[level].smoothed_signal, right.scales[level].smoothed_signal,
                       theirs->second["smooth"][level], 1.0, smoothed);
        const double sign = std::same_as<Params, NormalEdgeParams> ? -1.0 : 1.0;
        compare_signal(left.scales[level].response, right.scales[level].response, theirs->second["diff"][level], sign,
                       response);
      }
    }
    for (std::size_t level = 0; level < 5; ++level) {
      peaks.count_sets(spliced(left.scales[level].peaks, right.scales[level].peaks, left.beams.size()),
                       record["peaks"][level].get<std::set<std::uint32_t>>());
    }
    keypoints.compare(select_like_reference(all, scan, pose_of(record), 0.0), record, scan, false);
  }
  signal.report("signal");
  smoothed.report("smoothed signal");
  response.report("response");
  peaks.report("peaks");
  keypoints.places.report("keypoints (beam and scale)");
  keypoints.supports.report("support radii of common keypoints");
  // Theirs for the range detector point away from the origin of the world, which is a fault; ours along the normal.
  if (!std::same_as<Params, RangeParams>) { keypoints.directions.report("directions of common keypoints"); }
}

/// Which of equally long edges comes first.
enum class TieOrder { rising, falling };

/// Three disjoint minimum spanning trees by Kruskal's algorithm on exact lengths.
std::vector<CurveEdge> exact_spanning_trees(const std::vector<Point2>& points, TieOrder order) {
  const auto n = static_cast<std::uint32_t>(points.size());
  std::vector<CurveEdge> candidates;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = i + 1; j < n; ++j) { candidates.push_back({i, j, norm(points[i] - points[j])}); }
  }
  if (order == TieOrder::falling) { std::ranges::reverse(candidates); }
  std::ranges::stable_sort(candidates, {}, &CurveEdge::length);
  std::vector<CurveEdge> chosen;
  for (int tree = 0; tree < 3; ++tree) {
    std::vector<std::uint32_t> parent(n);
    std::iota(parent.begin(), parent.end(), 0U);
    const auto root = [&](std::uint32_t i) {
      while (parent[i] != i) { i = parent[i] = parent[parent[i]]; }
      return i;
    };
    std::erase_if(candidates, [&](const CurveEdge& edge) {
      const std::uint32_t low = root(edge.low);
      const std::uint32_t high = root(edge.high);
      if (low == high) { return false; }
      parent[low] = high;
      chosen.push_back(edge);
      return true;
    });
  }
  return chosen;
}

/// Smoothed curve (distance from the sensor) and response over the graph `edges`, against a record of theirs.
std::pair<Tally, Tally> compare_curves(const std::vector<Point2>& points, const std::vector<CurveEdge>& edges,
                                       Point2 sensor, const Json& record) {
  std::vector<double> x;
  std::vector<double> y;
  for (const Point2 point : points) {
    x.push_back(point.x);
    y.push_back(point.y);
  }
  constexpr double everything = std::numeric_limits<double>::infinity();
  const GeodesicNeighbours neighbours = shortest_paths(edges, points.size(), everything);
  SmoothedCurve curve;
  std::vector<double> damped;
  Tally smoothed;
  Tally response;
  const std::vector<double> scales = scale_bank(CurvatureParams{}.scales);
  for (std::size_t level = 0; level < scales.size(); ++level) {
    smooth_over(neighbours, x, y, scales[level], everything, curve);
    damped_displacement(x, y, curve, scales[level], damped);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double distance = norm(Point2{curve.x[i], curve.y[i]} - sensor);
      smoothed.count(close(distance, record["smooth"][level][i].get<double>()));
      response.count(close(damped[i], record["diff"][level][i].get<double>()));
    }
  }
  return {smoothed, response};
}

TEST(ReferenceDetect, RangeDetectorAgreesWithTheAuthorsProgram) {
  compare_signal_detector<RangeParams>("range");
}

TEST(ReferenceDetect, NormalEdgeDetectorAgreesWithTheAuthorsProgram) {
  compare_signal_detector<NormalEdgeParams>("edge");
}

TEST(ReferenceDetect, NormalBlobDetectorAgreesWithTheAuthorsProgram) {
  compare_signal_detector<NormalBlobParams>("blob");
}

TEST(ReferenceDetect, CurvatureSignalAgreesWithTheAuthorsProgram) {
  if (!data_file("reference/fr079.curvature.jsonl.gz")) { GTEST_SKIP() << "reference output is absent"; }
  const std::vector<Scan> scans = fr079_scans();
  std::map<std::size_t, Pose2> poses;
  for (const Json& record : records("fr079.curvature.jsonl.gz")) { poses[record["scan"]] = pose_of(record); }
  Tally smoothed;
  Tally response;
  for (const Json& record : records("fr079.curvature.signals.jsonl.gz")) {
    const Scan& scan = scans[record["scan"].get<std::size_t>()];
    const Pose2 world_from_sensor = poses[record["scan"]];
    std::vector<Point2> points;
    for (const BeamPoint& hit : hit_points(scan)) { points.push_back(world_point(scan, world_from_sensor, hit.beam)); }
    Tally best_smoothed;
    Tally best_response;
    for (const TieOrder order : {TieOrder::rising, TieOrder::falling}) {
      const auto [curve_tally, response_tally] =
          compare_curves(points, exact_spanning_trees(points, order), world_from_sensor.translation(), record);
      if (response_tally.equal > best_response.equal) {
        best_smoothed = curve_tally;
        best_response = response_tally;
      }
    }
    smoothed.add(best_smoothed);
    response.add(best_response);
  }
  smoothed.report("distance of the smoothed curve");
  response.report("response F");
}

TEST(ReferenceDetect, CurvatureKeypointsAgreeWithTheAuthorsProgram) {
  if (!data_file("reference/fr079.curvature.jsonl.gz")) { GTEST_SKIP() << "reference output is absent"; }
  const std::vector<Scan> scans = fr079_scans();
  CurvatureParams params;
  params.geodesic = Geodesic::spanning_trees;
  params.lost_mass = 0.0;
  params.end_margin = 0.0;
  params.selection.anchor = Anchor::peak;
  params.selection.precedence = Precedence::angle;
  params.selection.foreground_jump = 0.0;
  params.peaks.rule = PeakRule::neighbours;
  params.selection.duplicate_radius = 0.0;
  Detector detector(params);
  Tally peaks;
  KeypointTallies keypoints;
  for (const Json& record : records("fr079.curvature.jsonl.gz")) {
    const Scan& scan = scans[record["scan"].get<std::size_t>()];
    DetectorTrace trace;
    const auto found = detector.detect(scan, &trace);
    for (std::size_t level = 0; level < 5; ++level) {
      peaks.count_sets(std::set<std::uint32_t>(trace.scales[level].peaks.begin(), trace.scales[level].peaks.end()),
                       record["peaks"][level].get<std::set<std::uint32_t>>());
    }
    keypoints.compare(select_like_reference({found.begin(), found.end()}, scan, pose_of(record), 2.0), record, scan,
                      true);
  }
  peaks.report("peaks");
  keypoints.places.report("keypoints (beam and scale)");
  keypoints.directions.report("directions of common keypoints");
  keypoints.supports.report("support radii of common keypoints");
}

}  // namespace
}  // namespace flirt
