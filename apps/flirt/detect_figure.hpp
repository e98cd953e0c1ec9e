// apps/flirt/detect_figure.hpp: the figure of `flirt detect`: keypoints on the scan, the detector's signal at each
// scale, and one descriptor.
#pragma once

#include "flirt/features/extract.hpp"
#include "flirt/io/svg.hpp"

#include <cstddef>
#include <string>

namespace flirt::app {

struct DetectFigureInput {
  const Scan& scan;
  const FeatureParams& params;
  const Features& features;
  const FeatureTrace& trace;
  std::string title;
  std::size_t keypoint;  ///< whose descriptor is drawn; beyond the last: none
};

/// The keypoint whose descriptor has most to show: the one with most returns in its bins; 0 when there is none.
[[nodiscard]] std::size_t busiest_keypoint(const DescriptorTrace& trace, std::size_t keypoints);

[[nodiscard]] svg::Figure detect_figure(const DetectFigureInput& input);

}  // namespace flirt::app
