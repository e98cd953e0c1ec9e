#include "flirt/arena/any_features.hpp"

#include <type_traits>

namespace flirt {
namespace {

template <class Named>
std::vector<Named> joined(std::vector<Named> first, const std::vector<Named>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

}  // namespace

std::vector<NamedDetector> rival_detectors() {
  return {{"falko", tuned_falko()},
          {"falko-default", FalkoParams{}},
          {"falko-sparse", sparse_falko()},
          {"oc", OrthogonalCornerParams{}}};
}

std::vector<NamedDescriptor> rival_descriptors() {
  return {{"bsc", BscParams{}}, {"cgh", CghParams{}}};
}

std::vector<NamedDetector> all_detectors() {
  std::vector<NamedDetector> ours;
  for (const DetectorParams& params : {DetectorParams{CurvatureParams{}}, DetectorParams{RangeParams{}},
                                       DetectorParams{NormalEdgeParams{}}, DetectorParams{NormalBlobParams{}}}) {
    ours.push_back({std::string(detector_name(params)), params});
  }
  return joined(std::move(ours), rival_detectors());
}

std::vector<NamedDescriptor> all_descriptors() {
  std::vector<NamedDescriptor> ours;
  for (const DescriptorParams& params : {DescriptorParams{BetaGridParams{}}, DescriptorParams{ShapeContextParams{}}}) {
    ours.push_back({std::string(descriptor_name(params)), params});
  }
  return joined(std::move(ours), rival_descriptors());
}

AnyDetector::AnyDetector(const AnyDetectorParams& params)
    : method_(std::visit(
          [](const auto& own) -> decltype(method_) {
            if constexpr (std::is_same_v<std::decay_t<decltype(own)>, DetectorParams>) {
              return Detector(own);
            } else {
              return own;
            }
          },
          params)) {}

std::vector<Keypoint> AnyDetector::detect(const Scan& scan) {
  if (const auto* falko = std::get_if<FalkoParams>(&method_)) { return detect_falko(scan, *falko); }
  if (const auto* corners = std::get_if<OrthogonalCornerParams>(&method_)) {
    return detect_orthogonal_corners(scan, *corners);
  }
  const std::span<const Keypoint> found = std::get<Detector>(method_).detect(scan);
  return {found.begin(), found.end()};
}

AnyDescriber::AnyDescriber(const AnyDescriptorParams& params)
    : method_(std::visit(
          [](const auto& own) -> decltype(method_) {
            if constexpr (std::is_same_v<std::decay_t<decltype(own)>, DescriptorParams>) {
              return Describer(own);
            } else {
              return own;
            }
          },
          params)) {}

Descriptors AnyDescriber::describe(const Scan& scan, std::span<const Keypoint> keypoints) {
  if (const auto* bsc = std::get_if<BscParams>(&method_)) { return describe_bsc(scan, keypoints, *bsc); }
  if (const auto* cgh = std::get_if<CghParams>(&method_)) { return describe_cgh(scan, keypoints, *cgh); }
  return std::get<Describer>(method_).describe(scan, keypoints);
}

}  // namespace flirt
