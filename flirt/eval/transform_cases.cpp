#include "flirt/eval/transform_cases.hpp"

#include "flirt/core/assert.hpp"
#include "flirt/core/rng.hpp"
#include "flirt/eval/revisit.hpp"
#include "flirt/eval/scan_transforms.hpp"

#include <algorithm>
#include <cmath>

namespace flirt {
namespace {

/// Moves `count` elements drawn at random to the front; the first k do not depend on `count`.
template <class T>
void draw_to_front(std::vector<T>& items, std::size_t count, Rng& rng) {
  for (std::size_t i = 0; i < std::min(count, items.size()); ++i) {
    std::swap(items[i], items[i + rng.below(static_cast<std::uint32_t>(items.size() - i))]);
  }
  if (count < items.size()) { items.resize(count); }
}

/// A scan of the log and how much of the reference it sees.
struct Partner {
  std::size_t scan{0};
  double overlap{0};
};

std::vector<Partner> partners_in_reach(const ScanLog& log, std::size_t reference, const TransformParams& params) {
  const std::vector<Point2> points = points_of(log.scans[reference], {});
  const Pose2 map_from_reference = log.map_from_sensor(reference);
  std::vector<Partner> partners;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const Pose2 map_from_sensor = log.map_from_sensor(i);
    if (i == reference || distance(map_from_reference, map_from_sensor) > params.reach) { continue; }
    partners.push_back({i, overlap(points, map_from_reference, points_of(log.scans[i], {}), map_from_sensor,
                                   params.overlap_tolerance)});
  }
  return partners;
}

}  // namespace

std::vector<Condition> paper_conditions() {
  std::vector<Condition> conditions;
  for (const double overlap : {0.5, 0.6, 0.7, 0.8, 0.9}) { conditions.push_back({ScanTransform::viewpoint, overlap}); }
  for (const double sigma : {0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5}) {
    conditions.push_back({ScanTransform::noise, sigma});
  }
  for (const double factor : {2.0, 3.0, 4.0}) { conditions.push_back({ScanTransform::subsampling, factor}); }
  for (const double factor : {2.0, 3.0, 4.0}) { conditions.push_back({ScanTransform::oversampling, factor}); }
  return conditions;
}

std::vector<Location> draw_locations(const ScanLog& scans, std::size_t log, std::size_t count, std::uint64_t seed) {
  std::vector<Location> locations;
  for (std::size_t i = 0; i < scans.scans.size(); ++i) {
    if (hit_points(scans.scans[i]).size() >= 3) { locations.push_back({log, i}); }
  }
  Rng rng(seed, log);
  draw_to_front(locations, count, rng);
  return locations;
}

std::vector<TransformCase> cases_of(const ScanLog& log, const Location& location, std::span<const Condition> conditions,
                                    const TransformParams& params) {
  FLIRT_ASSERT(log.map_from_robot.size() == log.scans.size());
  const Scan& reference = log.scans[location.scan];
  const std::vector<Partner> partners = partners_in_reach(log, location.scan, params);
  const Pose2 reference_from_map = inverse(log.map_from_sensor(location.scan));
  std::vector<TransformCase> cases;
  for (std::size_t c = 0; c < conditions.size(); ++c) {
    const double level = conditions[c].level;
    const std::uint64_t stream = (location.log << 40U) + (location.scan << 8U) + c;
    switch (conditions[c].transform) {
      case ScanTransform::viewpoint: {
        std::vector<std::size_t> chosen;
        for (const Partner& partner : partners) {
          // Half open: no scan belongs to two levels.
          const double excess = partner.overlap - level + params.overlap_half_width;
          if (excess >= 0 && excess < 2 * params.overlap_half_width) { chosen.push_back(partner.scan); }
        }
        Rng rng(params.seed, stream);
        if (params.partners != 0) { draw_to_front(chosen, params.partners, rng); }
        for (const std::size_t i : chosen) {
          cases.push_back({c, log.scans[i], reference_from_map * log.map_from_sensor(i)});
        }
        break;
      }
      case ScanTransform::noise:
        cases.push_back({c, with_radial_noise(reference, level, params.seed, stream), {}});
        break;
      case ScanTransform::subsampling:
        cases.push_back({c, subsampled(reference, static_cast<std::uint32_t>(std::lround(level))), {}});
        break;
      case ScanTransform::oversampling:
        cases.push_back({c, oversampled(reference, static_cast<std::uint32_t>(std::lround(level))), {}});
        break;
    }
  }
  return cases;
}

std::vector<Point2> points_of(const Scan& scan, const Pose2& reference_from_sensor) {
  std::vector<Point2> points;
  for (const BeamPoint& hit : hit_points(scan)) { points.push_back(reference_from_sensor * hit.point); }
  return points;
}

}  // namespace flirt
