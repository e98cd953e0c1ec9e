// tests/support/map_examples.hpp: a small place map made by hand, and its columns to change and compare.
#pragma once

#include "flirt/map/place_map.hpp"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

namespace flirt {

inline constexpr std::size_t small_map_size = 3;

/// Scans 0 and 2 have 5 beams of one scanner, scan 1 has 4 of another.
[[nodiscard]] inline Scan small_map_scan(std::size_t i) {
  if (i == 1) {
    return {.beams = {-0.5, 0.25, 0.1, 8}, .ranges = {1, 2, 3, 8}, .robot_from_sensor = {0.25, -0.125, 0.5}};
  }
  const double range = 1.25 + static_cast<double>(i);
  return {.beams = {-1, 0.5, 0, 50}, .ranges = {range, 2, std::nan(""), 81.83, 4}};
}

[[nodiscard]] inline Pose2 small_map_pose(std::size_t i) {
  return {576.25 + static_cast<double>(i), -3.5, 0.1 * static_cast<double>(i)};
}

/// Scan 0 has 2 features, scan 1 none, scan 2 has 3; 12 bins.
[[nodiscard]] inline Features small_map_features(std::size_t i) {
  const std::size_t count = i == 1 ? 0 : 2 + i / 2;
  Features features;
  features.descriptors.dimension = 12;
  features.descriptors.stride = 16;
  for (std::size_t k = 0; k < count; ++k) {
    const double number = static_cast<double>(10 * i + k);
    features.keypoints.push_back({.sensor_from_keypoint = {number + 0.1, -number, 0.3},
                                  .scale = 0.2F,
                                  .support_radius = 0.4F,
                                  .response = 0.35F,
                                  .beam = static_cast<std::uint32_t>(k),
                                  .level = static_cast<std::uint8_t>(k)});
    std::vector<float> row(16, 0.0F);
    row[0] = 0.25F;
    row[k + 1] = 0.75F;
    for (const float value : row) {
      features.descriptors.rows.push_back(value);
      features.descriptors.roots.push_back(std::sqrt(value));
      features.descriptors.variances.push_back(value / 12);
    }
  }
  return features;
}

[[nodiscard]] inline PlaceMap small_map(MapVariances variances = MapVariances::leave_out) {
  PlaceMapBuilder builder({}, variances);
  for (std::size_t i = 0; i < small_map_size; ++i) {
    builder.add(small_map_scan(i), small_map_pose(i), small_map_features(i));
  }
  return std::move(builder).build();
}

/// Calls visit(name, column of a, column of b) for each column.
template <class ColumnsA, class ColumnsB, class Visitor>
void visit_both(ColumnsA& a, ColumnsB& b, const Visitor& visit) {
  visit_columns(a, [&](std::string_view name, auto& column_a) {
    visit_columns(b, [&](std::string_view other_name, auto& column_b) {
      if constexpr (std::is_same_v<std::remove_cvref_t<decltype(column_a[0])>,
                                   std::remove_cvref_t<decltype(column_b[0])>>) {
        if (name == other_name) { visit(name, column_a, column_b); }
      }
    });
  });
}

/// A copy of a map's columns.
[[nodiscard]] inline PlaceMapVectors vectors_of(const PlaceMap& map) {
  PlaceMapVectors vectors;
  visit_both(map.columns(), vectors,
             [](std::string_view /*name*/, const auto& from, auto& to) { to.assign(from.begin(), from.end()); });
  return vectors;
}

/// Bit by bit, so that NaN equals itself.
[[nodiscard]] inline bool equal_columns(const PlaceMap& a, const PlaceMap& b) {
  bool equal = a.descriptor_dimension() == b.descriptor_dimension() && a.descriptor_stride() == b.descriptor_stride();
  visit_both(a.columns(), b.columns(), [&equal](std::string_view /*name*/, const auto& in_a, const auto& in_b) {
    equal = equal && in_a.size() == in_b.size() &&
            (in_a.empty() || std::memcmp(in_a.data(), in_b.data(), in_a.size_bytes()) == 0);
  });
  return equal;
}

}  // namespace flirt
