// tests/match/random_features.hpp: descriptors and scenes made by chance, for property tests.
#pragma once

#include "flirt/core/rng.hpp"
#include "flirt/features/features.hpp"
#include "flirt/match/alignment.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace flirt::test {

/// Appends a row, normalised to sum 1 and padded, with its roots.
inline void append_row(Descriptors& descriptors, std::vector<float> row) {
  descriptors.dimension = static_cast<std::uint32_t>(row.size());
  descriptors.stride = (descriptors.dimension + 15) / 16 * 16;
  double sum = 0.0;
  for (const float value : row) { sum += value; }
  row.resize(descriptors.stride, 0.0F);
  for (const float value : row) {
    const auto share = static_cast<float>(value / sum);
    descriptors.rows.push_back(share);
    descriptors.roots.push_back(std::sqrt(share));
  }
}

/// Rows in which about `zeros` of the bins are empty.
inline Descriptors random_descriptors(Rng& rng, std::size_t count, std::size_t dimension, double zeros = 0.3) {
  Descriptors descriptors;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<float> row(dimension);
    for (float& value : row) { value = rng.uniform() < zeros ? 0.0F : static_cast<float>(rng.uniform()); }
    row[rng.below(static_cast<std::uint32_t>(dimension))] += 0.5F;
    append_row(descriptors, row);
  }
  return descriptors;
}

/// Keypoints of one scene in two scans. Reference keypoints come first in the order of the query's.
struct Scene {
  Features query;
  Features reference;
  Pose2 reference_from_query;
  std::vector<Match> matches;  ///< right ones first, then wrong ones
};

struct SceneParams {
  std::size_t right{12};      ///< matches that the motion explains
  std::size_t wrong{0};       ///< matches that it does not
  double noise{0.0};          ///< m, per coordinate of both scans
  double extent{10.0};        ///< m, half side of the square of keypoints
  std::size_t dimension{48};  ///< bins
};

inline Point2 random_point(Rng& rng, double extent) {
  return {rng.uniform(-extent, extent), rng.uniform(-extent, extent)};
}

inline Pose2 random_pose(Rng& rng, double extent) {
  return {rng.uniform(-extent, extent), rng.uniform(-extent, extent), rng.uniform(-3.14, 3.14)};
}

inline Scene random_scene(Rng& rng, const SceneParams& params) {
  Scene scene;
  scene.reference_from_query = random_pose(rng, 5.0);
  const std::size_t count = params.right + params.wrong;
  scene.query.descriptors = random_descriptors(rng, count, params.dimension);
  scene.reference.descriptors = scene.query.descriptors;
  for (std::size_t i = 0; i < count; ++i) {
    const Point2 seen = random_point(rng, params.extent);
    const double direction = rng.uniform(-3.14, 3.14);
    Pose2 other = scene.reference_from_query * Pose2{seen.x, seen.y, direction};
    if (i >= params.right) {
      const Point2 elsewhere = random_point(rng, params.extent);
      other = {elsewhere.x, elsewhere.y, rng.uniform(-3.14, 3.14)};
    }
    const auto noise = [&] { return rng.normal(0.0, params.noise); };
    scene.query.keypoints.push_back({.sensor_from_keypoint = {seen.x + noise(), seen.y + noise(), direction}});
    scene.reference.keypoints.push_back({.sensor_from_keypoint = {other.x + noise(), other.y + noise(), other.theta}});
    const auto index = static_cast<std::uint32_t>(i);
    scene.matches.push_back({index, index, static_cast<float>(rng.uniform(0.0, 0.4))});
  }
  return scene;
}

}  // namespace flirt::test
