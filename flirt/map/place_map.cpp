#include "flirt/map/place_map.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/registration/map_fields.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

namespace flirt {
namespace {

template <class Column>
std::string wrong_size(std::string_view name, const Column& column, std::size_t expected) {
  if (column.size() == expected) { return {}; }
  return "column " + std::string(name) + ": expected " + std::to_string(expected) + " values, found " +
         std::to_string(column.size());
}

/// The first complaint, or nothing.
std::string first_of(std::initializer_list<std::string> complaints) {
  for (const std::string& complaint : complaints) {
    if (!complaint.empty()) { return complaint; }
  }
  return {};
}

std::string wrong_sizes(const PlaceMapViews& columns, std::uint32_t stride) {
  const std::size_t scans = columns.map_from_sensor.size();
  const std::size_t features = columns.x.size();
  const std::size_t floats = features * stride;
  const std::size_t variances = columns.descriptor_variances.empty() ? 0 : floats;
  return first_of(
      {wrong_size("robot_from_sensor", columns.robot_from_sensor, scans),
       wrong_size("geometry", columns.geometry, scans), wrong_size("range_begin", columns.range_begin, scans + 1),
       wrong_size("feature_begin", columns.feature_begin, scans + 1), wrong_size("y", columns.y, features),
       wrong_size("theta", columns.theta, features), wrong_size("scale", columns.scale, features),
       wrong_size("support_radius", columns.support_radius, features),
       wrong_size("response", columns.response, features), wrong_size("beam", columns.beam, features),
       wrong_size("level", columns.level, features), wrong_size("descriptor_rows", columns.descriptor_rows, floats),
       wrong_size("descriptor_roots", columns.descriptor_roots, floats),
       wrong_size("descriptor_variances", columns.descriptor_variances, variances)});
}

/// Begins must ascend from 0 to the number of items.
std::string wrong_begins(std::string_view name, std::span<const std::uint64_t> begins, std::size_t items) {
  if (begins.front() == 0 && begins.back() == items && std::is_sorted(begins.begin(), begins.end())) { return {}; }
  return "column " + std::string(name) + ": expected ascending from 0 to " + std::to_string(items);
}

/// Whether a grid can hold what is seen from there: finite, and within 10 000 km of the map's origin.
bool is_place(const Pose2& pose) {
  constexpr double farthest = 1e7;
  return is_finite(pose) && norm(pose.translation()) <= farthest;
}

std::string wrong_poses(std::string_view name, std::span<const Pose2> poses) {
  const auto bad = std::ranges::find_if_not(poses, is_place);
  if (bad == poses.end()) { return {}; }
  return "column " + std::string(name) + ": expected finite poses within 10 000 km, found another at " +
         std::to_string(bad - poses.begin());
}

std::string wrong_numbers(std::string_view name, std::span<const float> numbers) {
  const auto bad = std::find_if_not(numbers.begin(), numbers.end(), [](float number) { return std::isfinite(number); });
  if (bad == numbers.end()) { return {}; }
  return "column " + std::string(name) + ": expected finite numbers, found another at " +
         std::to_string(bad - numbers.begin());
}

std::string wrong_indices(const PlaceMapViews& columns) {
  for (std::size_t scan = 0; scan < columns.geometry.size(); ++scan) {
    if (columns.geometry[scan] >= columns.beams.size()) {
      return "column geometry: expected less than " + std::to_string(columns.beams.size()) + ", found " +
             std::to_string(columns.geometry[scan]) + " for scan " + std::to_string(scan);
    }
    const std::uint64_t readings = columns.range_begin[scan + 1] - columns.range_begin[scan];
    for (std::uint64_t i = columns.feature_begin[scan]; i < columns.feature_begin[scan + 1]; ++i) {
      if (columns.beam[i] >= readings) {
        return "column beam: expected less than " + std::to_string(readings) + ", found " +
               std::to_string(columns.beam[i]) + " for scan " + std::to_string(scan);
      }
    }
  }
  return {};
}

std::string wrong_descriptors(std::size_t features, std::uint32_t dimension, std::uint32_t stride) {
  constexpr std::uint32_t longest = 65'536;
  const bool fits = stride % 16 == 0 && stride <= longest && dimension <= stride && (features == 0 || dimension > 0);
  if (fits) { return {}; }
  return "descriptors: expected 1 bin or more and a stride of a multiple of 16, at most 65536, that holds them, "
         "found " +
         std::to_string(dimension) + " bins and a stride of " + std::to_string(stride);
}

std::string wrong_beams(std::span<const Beams> beams) {
  const auto is_good = [](const Beams& b) {
    return std::isfinite(b.angle_min) && std::isfinite(b.angle_step) && !std::isnan(b.range_min) &&
           !std::isnan(b.range_max);
  };
  const auto bad = std::ranges::find_if_not(beams, is_good);
  if (bad == beams.end()) { return {}; }
  return "column beams: expected finite angles and ranges that are numbers, found another at " +
         std::to_string(bad - beams.begin());
}

/// Searches for neighbours rely on rows that sum to 1 and on their roots.
std::string wrong_rows(std::span<const float> rows, std::span<const float> roots, std::uint32_t stride) {
  for (std::size_t at = 0; at < rows.size(); at += stride) {
    const Eigen::Map<const Eigen::ArrayXf> row(rows.data() + at, stride);
    const Eigen::Map<const Eigen::ArrayXf> root(roots.data() + at, stride);
    const bool good = std::abs(row.sum() - 1.0F) < 5e-6F && (root.square() - row).abs().sum() < 1e-4F &&
                      row.minCoeff() >= 0 && root.minCoeff() >= 0;
    if (!good) {
      return "columns descriptor_rows and descriptor_roots: expected rows of 0 or more that sum to 1, and their square "
             "roots, found others at " +
             std::to_string(at / stride);
    }
  }
  return {};
}

/// Empty when the columns fit together. Sizes come first: what follows relies on them.
std::string complaint(const PlaceMapViews& columns, std::uint32_t dimension, std::uint32_t stride) {
  std::string shape = first_of({wrong_descriptors(columns.x.size(), dimension, stride), wrong_sizes(columns, stride)});
  if (!shape.empty()) { return shape; }
  std::string begins = first_of({wrong_begins("range_begin", columns.range_begin, columns.ranges.size()),
                                 wrong_begins("feature_begin", columns.feature_begin, columns.x.size())});
  if (!begins.empty()) { return begins; }
  return first_of({wrong_indices(columns), wrong_poses("map_from_sensor", columns.map_from_sensor),
                   wrong_poses("robot_from_sensor", columns.robot_from_sensor), wrong_numbers("x", columns.x),
                   wrong_numbers("y", columns.y), wrong_numbers("theta", columns.theta),
                   wrong_numbers("scale", columns.scale), wrong_numbers("support_radius", columns.support_radius),
                   wrong_numbers("response", columns.response),
                   wrong_numbers("descriptor_variances", columns.descriptor_variances), wrong_beams(columns.beams),
                   wrong_rows(columns.descriptor_rows, columns.descriptor_roots, stride)});
}

/// The nearest float that means the same: 80.1 is "no return" where range_max is 80.1, but its nearest float is not.
float rounded(double range, const Beams& beams) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const auto nearest = static_cast<float>(range);
  if (classify(nearest, beams) == classify(range, beams)) { return nearest; }
  return std::nextafter(nearest, nearest < range ? infinity : -infinity);
}

template <class T>
void append(MapVector<T>& column, const std::vector<T>& values) {
  column.insert(column.end(), values.begin(), values.end());
}

std::string too_wide(double width, double height) {
  return "expected scans near each other, in a box of up to 100 km², found one of " +
         std::to_string(std::llround(width)) + " m x " + std::to_string(std::llround(height)) + " m";
}

/// Empty when the evidence can be searched.
std::string wrong_extent(const EvidenceGrid& evidence) {
  const auto box = evidence.bounds();
  const double cell = evidence.params().cell_size;
  if (!box || is_mappable(*box)) { return {}; }
  return too_wide(static_cast<double>(box->width()) * cell, static_cast<double>(box->height()) * cell);
}

/// The same of the evidence that there will be.
std::string wrong_extent(const ScanLog& log) {
  if (log.scans.empty()) { return {}; }
  const EvidenceGrid grid;
  Point2 min = log.map_from_sensor(0).translation();
  Point2 max = min;
  for (std::size_t i = 1; i < log.scans.size(); ++i) {
    const Point2 at = log.map_from_sensor(i).translation();
    min = {std::min(min.x, at.x), std::min(min.y, at.y)};
    max = {std::max(max.x, at.x), std::max(max.y, at.y)};
  }
  const double reach = grid.params().range_max + EvidenceGrid::tile_side * grid.params().cell_size;
  min = min - Point2{reach, reach};
  max = max + Point2{reach, reach};
  if (is_mappable({grid.index(min), grid.index(max)})) { return {}; }
  return too_wide(max.x - min.x, max.y - min.y);
}

/// What keeps a log from being a map; empty when nothing does.
std::string wrong_log(const ScanLog& log) {
  if (log.map_from_robot.size() != log.scans.size()) {
    return "expected a log with poses, one for each of its " + std::to_string(log.scans.size()) + " scans, found " +
           std::to_string(log.map_from_robot.size());
  }
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    if (!is_place(log.map_from_sensor(i))) {
      return "expected a finite pose within 10 000 km of the map's origin for scan " + std::to_string(i) +
             ", found none";
    }
  }
  return wrong_extent(log);
}

}  // namespace

PlaceMapViews views_of(const PlaceMapVectors& vectors) {
  return {.map_from_sensor = vectors.map_from_sensor,
          .robot_from_sensor = vectors.robot_from_sensor,
          .geometry = vectors.geometry,
          .beams = vectors.beams,
          .range_begin = vectors.range_begin,
          .ranges = vectors.ranges,
          .feature_begin = vectors.feature_begin,
          .x = vectors.x,
          .y = vectors.y,
          .theta = vectors.theta,
          .scale = vectors.scale,
          .support_radius = vectors.support_radius,
          .response = vectors.response,
          .beam = vectors.beam,
          .level = vectors.level,
          .descriptor_rows = vectors.descriptor_rows,
          .descriptor_roots = vectors.descriptor_roots,
          .descriptor_variances = vectors.descriptor_variances};
}

Result<PlaceMap> PlaceMap::from_columns(const PlaceMapViews& columns, std::uint32_t descriptor_dimension,
                                        std::uint32_t descriptor_stride, const FeatureParams& params,
                                        EvidenceGrid evidence, std::shared_ptr<const void> owner) {
  const std::string wrong =
      first_of({complaint(columns, descriptor_dimension, descriptor_stride), wrong_extent(evidence)});
  if (!wrong.empty()) { return fail(wrong); }
  PlaceMap map;
  map.columns_ = columns;
  map.descriptor_dimension_ = descriptor_dimension;
  map.descriptor_stride_ = descriptor_stride;
  map.params_ = params;
  map.evidence_ = std::make_shared<const EvidenceGrid>(std::move(evidence));
  map.owner_ = std::move(owner);
  return map;
}

std::size_t PlaceMap::bytes() const {
  std::size_t total = evidence_->bytes();
  visit_columns(columns_, [&total](std::string_view /*name*/, const auto& column) { total += column.size_bytes(); });
  return total;
}

Pose2 PlaceMap::map_from_robot(std::size_t scan) const {
  return columns_.map_from_sensor[scan] * inverse(columns_.robot_from_sensor[scan]);
}

std::span<const float> PlaceMap::ranges(std::size_t scan) const {
  const std::uint64_t begin = columns_.range_begin[scan];
  return columns_.ranges.subspan(begin, columns_.range_begin[scan + 1] - begin);
}

Scan PlaceMap::scan(std::size_t scan) const {
  const std::span<const float> readings = ranges(scan);
  return {.beams = beams(scan),
          .ranges = {readings.begin(), readings.end()},
          .robot_from_sensor = columns_.robot_from_sensor[scan]};
}

FeatureColumns PlaceMap::features(std::size_t scan) const {
  const std::uint64_t begin = columns_.feature_begin[scan];
  const std::uint64_t count = columns_.feature_begin[scan + 1] - begin;
  const std::uint64_t row = begin * descriptor_stride_;
  return {.keypoints = {.x = columns_.x.subspan(begin, count),
                        .y = columns_.y.subspan(begin, count),
                        .theta = columns_.theta.subspan(begin, count)},
          .descriptors = {.rows = columns_.descriptor_rows.data() + row,
                          .roots = columns_.descriptor_roots.data() + row,
                          .variances = has_variances() ? columns_.descriptor_variances.data() + row : nullptr,
                          .count = static_cast<std::uint32_t>(count),
                          .dimension = descriptor_dimension_,
                          .stride = descriptor_stride_}};
}

std::optional<std::size_t> nearest_scan(const PlaceMap& map, const Pose2& map_from_sensor, ScanInterval excluded) {
  constexpr double metres_a_radian = 0.5 / (std::numbers::pi / 4);
  std::optional<std::size_t> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (excluded.contains(i)) { continue; }
    const Pose2& other = map.map_from_sensor(i);
    const double away = distance(map_from_sensor, other) + metres_a_radian * heading_difference(map_from_sensor, other);
    if (away < least) {
      least = away;
      nearest = i;
    }
  }
  return nearest;
}

void PlaceMapBuilder::add_geometry(const Beams& beams) {
  // Most logs have one or two geometries in all, but some drivers compute the step anew for each scan.
  const auto bits = std::bit_cast<std::array<std::uint64_t, 4>>(beams);
  const auto [known, is_new] = geometries_.try_emplace(bits, static_cast<std::uint32_t>(columns_.beams.size()));
  columns_.geometry.push_back(known->second);
  if (is_new) { columns_.beams.push_back(beams); }
}

void PlaceMapBuilder::add_features(const Features& features) {
  const Descriptors& descriptors = features.descriptors;
  FLIRT_ASSERT(descriptors.size() == features.keypoints.size());
  const KeypointTable table = table_of(features.keypoints);
  append(columns_.x, table.x);
  append(columns_.y, table.y);
  append(columns_.theta, table.theta);
  for (const Keypoint& keypoint : features.keypoints) {
    columns_.scale.push_back(keypoint.scale);
    columns_.support_radius.push_back(keypoint.support_radius);
    columns_.response.push_back(keypoint.response);
    columns_.beam.push_back(keypoint.beam);
    columns_.level.push_back(keypoint.level);
  }
  if (!features.keypoints.empty()) {
    FLIRT_ASSERT(descriptor_stride_ == 0 || descriptors.stride == descriptor_stride_);
    FLIRT_ASSERT(descriptor_dimension_ == 0 || descriptors.dimension == descriptor_dimension_);
    descriptor_dimension_ = descriptors.dimension;
    descriptor_stride_ = descriptors.stride;
  }
  append(columns_.descriptor_rows, descriptors.rows);
  append(columns_.descriptor_roots, descriptors.roots);
  if (variances_ == MapVariances::keep) { append(columns_.descriptor_variances, descriptors.variances); }
  columns_.feature_begin.push_back(columns_.x.size());
}

void PlaceMapBuilder::add(const Scan& scan, const Pose2& map_from_sensor, const Features& features) {
  FLIRT_ASSERT(is_finite(map_from_sensor));
  columns_.map_from_sensor.push_back(map_from_sensor);
  columns_.robot_from_sensor.push_back(scan.robot_from_sensor);
  add_geometry(scan.beams);
  for (const double range : scan.ranges) { columns_.ranges.push_back(rounded(range, scan.beams)); }
  columns_.range_begin.push_back(columns_.ranges.size());
  add_features(features);
}

PlaceMap PlaceMapBuilder::build() && {
  PlaceMap map = std::move(*this).build(EvidenceGrid());
  EvidenceGrid evidence;
  for (std::size_t i = 0; i < map.size(); ++i) { evidence.add(map.scan(i), map.map_from_sensor(i)); }
  map.evidence_ = std::make_shared<const EvidenceGrid>(std::move(evidence));
  return map;
}

PlaceMap PlaceMapBuilder::build(EvidenceGrid evidence) && {
  visit_columns(columns_, [](std::string_view /*name*/, auto& column) { column.shrink_to_fit(); });
  const auto owner = std::make_shared<const PlaceMapVectors>(std::move(columns_));
  Result<PlaceMap> map = PlaceMap::from_columns(views_of(*owner), descriptor_dimension_, descriptor_stride_, params_,
                                                std::move(evidence), owner);
  FLIRT_ASSERT(map.has_value());
  return *std::move(map);
}

Result<PlaceMap> build_place_map(const ScanLog& log, const FeatureParams& params, std::size_t threads,
                                 const Progress& progress, MapVariances variances) {
  if (const std::string wrong = wrong_log(log); !wrong.empty()) { return fail(wrong); }
  std::vector<FeatureExtractor> extractors;
  extractors.reserve(thread_count(threads));
  for (std::size_t i = 0; i < thread_count(threads); ++i) { extractors.emplace_back(params); }
  std::vector<Features> features(log.scans.size());
  parallel_for(
      log.scans.size(), extractors.size(),
      [&](std::size_t i, std::size_t thread) { features[i] = extractors[thread].extract(log.scans[i]); }, progress);
  PlaceMapBuilder builder(params, variances);
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    builder.add(log.scans[i], log.map_from_sensor(i), std::exchange(features[i], {}));
  }
  return std::move(builder).build();
}

}  // namespace flirt
