// flirt/features/describe.hpp: descriptors of keypoints: β-grid or linear local shape context (P1 §2.2, P2 §III).
//
//   const Descriptors descriptors = describe(scan, detect(scan));
//   std::span<const float> row = descriptors.row(0);                 // 48 entries, sum 1
#pragma once

#include "flirt/features/beta_grid.hpp"
#include "flirt/features/features.hpp"
#include "flirt/features/shape_context.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

namespace flirt {

using DescriptorParams = std::variant<BetaGridParams, ShapeContextParams>;

/// As on the command line, in the order of the variant.
inline constexpr std::array<std::string_view, std::variant_size_v<DescriptorParams>> descriptor_names{"beta-grid",
                                                                                                      "shape-context"};
[[nodiscard]] std::string_view descriptor_name(const DescriptorParams& params);
/// Default parameters of the descriptor of that name, or nothing when there is none.
[[nodiscard]] std::optional<DescriptorParams> descriptor_from_name(std::string_view name);

/// What the rows were made from, before normalisation; each count × dimension, without padding.
struct DescriptorTrace {
  std::uint32_t dimension{0};
  std::vector<std::uint32_t> hits{};    ///< beams (points) that end in the bin
  std::vector<std::uint32_t> misses{};  ///< beams that pass it; empty for the shape context
  std::vector<double> mean{};           ///< occupancy, as estimated; empty for the shape context
  std::vector<double> variance{};       ///< of the occupancy; empty for the shape context
};

/// One row per keypoint, in their order, from the beams of the scan they were found in; keypoints in its sensor frame.
/// Every row is finite and sums to 1: bins without any knowledge have the prior mean (β-grid), a row without any count
/// is uniform (shape context, raw ratio). The β-grid also has the variances of the entries: the Beta variance over the
/// square of the normaliser, 0 where a row of the raw ratio had nothing to normalise. O(beams + keypoints · beams near
/// each).
[[nodiscard]] Descriptors describe(const Scan& scan, std::span<const Keypoint> keypoints,
                                   const DescriptorParams& params = {}, DescriptorTrace* trace = nullptr);

/// `describe` for many scans, with its buffers and beam directions kept from one to the next. One per thread.
class Describer {
 public:
  explicit Describer(const DescriptorParams& params = {});
  [[nodiscard]] Descriptors describe(const Scan& scan, std::span<const Keypoint> keypoints,
                                     DescriptorTrace* trace = nullptr);

 private:
  BeamFan fan_;
  std::variant<BetaGrid, ShapeContext> method_;
};

}  // namespace flirt
