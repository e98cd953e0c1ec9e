#include "flirt/features/extract.hpp"

#include <span>
#include <utility>

namespace flirt {

FeatureExtractor::FeatureExtractor(FeatureParams params)
    : params_(params), detector_(params_.detector), describer_(params_.descriptor) {}

Features FeatureExtractor::extract(const Scan& scan, FeatureTrace* trace) {
  const std::span<const Keypoint> keypoints = detector_.detect(scan, trace == nullptr ? nullptr : &trace->detector);
  Features features;
  features.keypoints.assign(keypoints.begin(), keypoints.end());
  features.descriptors = describer_.describe(scan, features.keypoints, trace == nullptr ? nullptr : &trace->descriptor);
  return features;
}

Features extract(const Scan& scan, const FeatureParams& params, FeatureTrace* trace) {
  return FeatureExtractor(params).extract(scan, trace);
}

}  // namespace flirt
