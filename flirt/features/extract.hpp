// flirt/features/extract.hpp: keypoints and their descriptors in one call.
//
//   const Features features = extract(scan);
#pragma once

#include "flirt/features/describe.hpp"
#include "flirt/features/detect.hpp"

namespace flirt {

/// By default the papers' choice: curvature keypoints with β-grids (P2 §IV-C).
struct FeatureParams {
  DetectorParams detector{};
  DescriptorParams descriptor{};
};

/// What the detector and the descriptor saw on the way.
struct FeatureTrace {
  DetectorTrace detector{};
  DescriptorTrace descriptor{};
};

/// `extract` for many scans, with the memory kept from one to the next. One per thread.
class FeatureExtractor {
 public:
  explicit FeatureExtractor(FeatureParams params = {});
  /// Cost: see Detector::detect and describe().
  [[nodiscard]] Features extract(const Scan& scan, FeatureTrace* trace = nullptr);
  [[nodiscard]] const FeatureParams& params() const { return params_; }

 private:
  FeatureParams params_;
  Detector detector_;
  Describer describer_;
};

/// Keypoints of one scan, in the detector's order, with one descriptor row each.
[[nodiscard]] Features extract(const Scan& scan, const FeatureParams& params = {}, FeatureTrace* trace = nullptr);

}  // namespace flirt
