// flirt/features/features.hpp: what a scan is reduced to: keypoints with one descriptor row each.
#pragma once

#include "flirt/core/pose2.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace flirt {

/// An interest point of one scan.
struct Keypoint {
  Pose2 sensor_from_keypoint{};  ///< position on the scan's curve; theta: the keypoint's own direction (item 27)
  float scale{0};                ///< t of its level: m for the curvature detector, beams (variance) for the others
  float support_radius{0};       ///< m, of the support region (item 26)
  float response{0};             ///< value of the detector's signal at the peak
  std::uint32_t beam{0};         ///< index into Scan::ranges
  std::uint8_t level{0};         ///< index of the scale, 0 = finest

  friend bool operator==(const Keypoint&, const Keypoint&) = default;
};

/// One contiguous row of non-negative floats per keypoint, each row normalised to sum 1 and padded with zeros to
/// `stride`.
struct Descriptors {
  std::uint32_t dimension{0};  ///< bins that carry data
  std::uint32_t stride{0};     ///< floats from row to row: dimension rounded up to a multiple of 16
  std::vector<float> rows{};   ///< count × stride
  std::vector<float> roots{};  ///< count × stride, square roots of `rows` (for bounds and the Hellinger distance)
  std::vector<float>
      variances;  ///< count × stride, variance of each entry of `rows`; empty when the descriptor has none

  [[nodiscard]] std::size_t size() const { return stride == 0 ? 0 : rows.size() / stride; }
  [[nodiscard]] std::span<const float> row(std::size_t i) const { return {rows.data() + i * stride, dimension}; }
};

struct Features {
  std::vector<Keypoint> keypoints{};
  Descriptors descriptors{};  ///< row i belongs to keypoint i
};

}  // namespace flirt
