#include "flirt/features/extract.hpp"

#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

namespace flirt {
namespace {

Scan scan_from(double x, double theta) {
  const std::vector<Point2> corners{{-4, -3}, {3.5, -3.3}, {4.2, 1.0}, {2.0, 1.2}, {2.1, 2.9}, {-3.8, 3.1}};
  return scan_of(joined(polygon(corners), box({1.2, -1.1, 0.4}, 0.5, 0.4)), {x, 0.3, theta}, turn_beams(),
                 turn_beam_count);
}

TEST(Extract, IsDetectThenDescribe) {
  const Scan scan = scan_from(0.2, 0.1);
  for (const std::string_view detector : {"curvature", "range", "normal-edge", "normal-blob"}) {
    for (const std::string_view descriptor : descriptor_names) {
      const FeatureParams params{*detector_from_name(detector), *descriptor_from_name(descriptor)};
      const Features features = extract(scan, params);
      EXPECT_EQ(features.keypoints, detect(scan, params.detector));
      EXPECT_FALSE(features.keypoints.empty()) << detector;
      EXPECT_EQ(features.descriptors.rows, describe(scan, features.keypoints, params.descriptor).rows);
      EXPECT_EQ(features.descriptors.size(), features.keypoints.size());
    }
  }
}

TEST(Extract, TheExtractorKeepsNothingFromScanToScan) {
  FeatureExtractor extractor;
  for (int i = 0; i < 5; ++i) {
    const Scan scan = scan_from(0.2 * i, i);
    const Features kept = extractor.extract(scan);
    const Features fresh = extract(scan);
    EXPECT_EQ(kept.keypoints, fresh.keypoints);
    EXPECT_EQ(kept.descriptors.rows, fresh.descriptors.rows);
  }
}

TEST(Extract, TracesBothSteps) {
  FeatureTrace trace;
  const Features features = extract(scan_from(0.2, 0.1), {}, &trace);
  EXPECT_EQ(trace.detector.scales.size(), 5U);
  EXPECT_EQ(trace.descriptor.hits.size(), features.keypoints.size() * 48);
}

TEST(Extract, AnEmptyScanHasNoFeatures) {
  const Features features = extract(Scan{});
  EXPECT_TRUE(features.keypoints.empty());
  EXPECT_EQ(features.descriptors.size(), 0U);
}

}  // namespace
}  // namespace flirt
