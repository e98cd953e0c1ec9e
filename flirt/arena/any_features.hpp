// flirt/arena/any_features.hpp: one type for our detectors and the rivals', and one for all descriptors, so that a
// bench runs them alike.
#pragma once

#include "flirt/arena/falko.hpp"
#include "flirt/arena/orthogonal_corners.hpp"
#include "flirt/arena/point_histograms.hpp"
#include "flirt/features/describe.hpp"
#include "flirt/features/detect.hpp"

#include <span>
#include <string>
#include <variant>
#include <vector>

namespace flirt {

using AnyDetectorParams = std::variant<DetectorParams, FalkoParams, OrthogonalCornerParams>;
using AnyDescriptorParams = std::variant<DescriptorParams, BscParams, CghParams>;

struct AnyFeatureParams {
  AnyDetectorParams detector{};
  AnyDescriptorParams descriptor{};
};

struct NamedDetector {
  std::string name{};
  AnyDetectorParams params{};
};
struct NamedDescriptor {
  std::string name{};
  AnyDescriptorParams params{};
};

/// falko (as its authors' benchmark sets it), falko-default (their library), falko-sparse (a beam a degree), oc.
[[nodiscard]] std::vector<NamedDetector> rival_detectors();
/// bsc, cgh.
[[nodiscard]] std::vector<NamedDescriptor> rival_descriptors();
/// Ours with their default parameters, then the rivals'.
[[nodiscard]] std::vector<NamedDetector> all_detectors();
[[nodiscard]] std::vector<NamedDescriptor> all_descriptors();

/// Ours keep their memory from scan to scan. One per thread.
class AnyDetector {
 public:
  explicit AnyDetector(const AnyDetectorParams& params);
  [[nodiscard]] std::vector<Keypoint> detect(const Scan& scan);

 private:
  std::variant<Detector, FalkoParams, OrthogonalCornerParams> method_;
};

/// One per thread.
class AnyDescriber {
 public:
  explicit AnyDescriber(const AnyDescriptorParams& params);
  [[nodiscard]] Descriptors describe(const Scan& scan, std::span<const Keypoint> keypoints);

 private:
  std::variant<Describer, BscParams, CghParams> method_;
};

/// One per thread.
class AnyExtractor {
 public:
  explicit AnyExtractor(const AnyFeatureParams& params) : detector_(params.detector), describer_(params.descriptor) {}
  [[nodiscard]] Features extract(const Scan& scan) {
    Features features{detector_.detect(scan), {}};
    features.descriptors = describer_.describe(scan, features.keypoints);
    return features;
  }

 private:
  AnyDetector detector_;
  AnyDescriber describer_;
};

}  // namespace flirt
