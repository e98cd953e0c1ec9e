// flirt/match/columns.hpp: the features of one scan as columns, so that a map can hold all its scans back to back and
// lend each of them for matching without a copy.
#pragma once

#include "flirt/features/features.hpp"
#include "flirt/match/distance.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace flirt {

/// Keypoints of one scan, sensor frame; equal lengths, all finite (see out_of_sight).
struct KeypointColumns {
  std::span<const float> x;      ///< m
  std::span<const float> y;      ///< m
  std::span<const float> theta;  ///< rad, the keypoint's own direction

  [[nodiscard]] std::size_t size() const { return x.size(); }
};

/// Keypoints with their descriptors, row i belonging to keypoint i.
struct FeatureColumns {
  KeypointColumns keypoints;
  DescriptorRows descriptors;
};

/// Owner of the columns of one scan.
struct KeypointTable {
  std::vector<float> x;      ///< m
  std::vector<float> y;      ///< m
  std::vector<float> theta;  ///< rad

  [[nodiscard]] KeypointColumns columns() const { return {x, y, theta}; }
};

/// True when the keypoint can take part in matching: finite and nearer than any sensor sees.
[[nodiscard]] bool is_usable(const Pose2& sensor_from_keypoint);

/// Where columns hold a keypoint that is not usable, m: nothing is near it, and its square is still a float.
inline constexpr float out_of_sight = 1e15F;

/// Copies keypoints into columns; one that is not usable is placed out of sight.
[[nodiscard]] KeypointTable table_of(std::span<const Keypoint> keypoints);

}  // namespace flirt
