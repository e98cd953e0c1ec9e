#include "flirt/registration/evidence_score.hpp"

#include <algorithm>
#include <cmath>

namespace flirt {
namespace {

constexpr double near_distance = 0.1;  // m, as the papers' inlier distance

/// ⌊v⌋ for |v| < 2³¹, without a library call on processors that have no instruction for it.
std::int32_t floor_to_int(float v) {
  const auto truncated = static_cast<std::int32_t>(v);
  return truncated - (v < static_cast<float>(truncated) ? 1 : 0);
}

}  // namespace

EvidenceScorer::EvidenceScorer(const MapFields& fields, const EvidenceScoreParams& params)
    : fields_(&fields), params_(params) {
  const double sigma = params.sigma / fields.cell_size;
  for (std::size_t code = 0; code < likelihood_of_.size(); ++code) {
    const auto squared = static_cast<double>(code & Agreement::distance_mask);
    likelihood_of_[code] =
        squared == Agreement::distance_mask ? 0.0F : static_cast<float>(std::exp(-squared / (2 * sigma * sigma)));
  }
}

EvidenceScore EvidenceScorer::score_of_end_points(const ScanPoints& points, const Pose2& map_from_sensor) const {
  EvidenceScore score;
  if (points.size() == 0) { return score; }
  const auto scale = static_cast<float>(1.0 / fields_->cell_size);
  const float c = scale * static_cast<float>(std::cos(map_from_sensor.theta));
  const float s = scale * static_cast<float>(std::sin(map_from_sensor.theta));
  const float x0 = static_cast<float>((map_from_sensor.x - fields_->origin.x) / fields_->cell_size);
  const float y0 = static_cast<float>((map_from_sensor.y - fields_->origin.y) / fields_->cell_size);
  float likelihood = 0;
  float free = 0;
  int unknown = 0;
  int near = 0;
  int squared_distances = 0;
  const auto near_cells = static_cast<int>(std::lround(std::pow(near_distance / fields_->cell_size, 2)));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto x = floor_to_int(x0 + c * points.x[i] - s * points.y[i]);
    const auto y = floor_to_int(y0 + s * points.x[i] + c * points.y[i]);
    const MapTile* const tile = fields_->tile_at(x, y);
    if (tile == nullptr) {
      ++unknown;
      squared_distances += Agreement::distance_mask;
      continue;
    }
    const std::uint8_t code = tile->agreement[MapTile::offset(x, y)];
    const int squared_distance = code & Agreement::distance_mask;
    near += squared_distance <= near_cells ? 1 : 0;
    squared_distances += squared_distance;
    likelihood += likelihood_of_[code];
    free += (code & Agreement::free) != 0 ? 1.0F - likelihood_of_[code] : 0.0F;
    unknown += (code & Agreement::unknown) != 0 ? 1 : 0;
  }
  const auto n = static_cast<double>(points.size());
  score.likelihood = likelihood / n;
  score.free = free / n;
  score.unknown = unknown / n;
  score.near = near / n;
  score.residual = squared_distances / n * fields_->cell_size * fields_->cell_size;
  score.total = weighted(score, params_.fit);
  score.preference = weighted(score, params_.preference);
  return score;
}

EvidenceScore EvidenceScorer::score(const ScanPoints& points, const Pose2& map_from_sensor) const {
  EvidenceScore score = score_of_end_points(points, map_from_sensor);
  score.through = through(points, map_from_sensor);
  score.total = weighted(score, params_.fit);
  score.preference = weighted(score, params_.preference);
  return score;
}

bool EvidenceScorer::crosses_solid(float from_x, float from_y, float direction_x, float direction_y,
                                   float length) const {
  for (float t = 0; t < length;) {
    const auto x = floor_to_int(from_x + t * direction_x);
    const auto y = floor_to_int(from_y + t * direction_y);
    if (!fields_->contains(x, y)) {
      t += 4;
      continue;
    }
    const MapTile* const tile = fields_->tiles[fields_->tile_index(x, y)].get();
    const std::uint8_t clear = tile == nullptr ? MapTile::clear : tile->clearance[MapTile::offset(x, y)];
    if (clear == MapTile::solid) { return true; }
    t += std::max(0.7F, static_cast<float>(clear));
  }
  return false;
}

double EvidenceScorer::through(const ScanPoints& points, const Pose2& map_from_sensor, std::size_t stride,
                               double most) const {
  const auto scale = static_cast<float>(1.0 / fields_->cell_size);
  const auto c = static_cast<float>(std::cos(map_from_sensor.theta));
  const auto s = static_cast<float>(std::sin(map_from_sensor.theta));
  const auto x0 = static_cast<float>((map_from_sensor.x - fields_->origin.x) / fields_->cell_size);
  const auto y0 = static_cast<float>((map_from_sensor.y - fields_->origin.y) / fields_->cell_size);
  const auto margin = static_cast<float>(params_.through_margin);
  std::size_t beams = 0;
  for (std::size_t i = 0; i < points.size(); i += stride) { beams += points.range[i] > 0 ? 1U : 0U; }
  const double most_beams = most * static_cast<double>(beams);
  int crossing = 0;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    if (points.range[i] <= 0) { continue; }
    const float inverse_range = 1.0F / points.range[i];
    const float dx = (c * points.x[i] - s * points.y[i]) * inverse_range;
    const float dy = (s * points.x[i] + c * points.y[i]) * inverse_range;
    crossing += crosses_solid(x0, y0, dx, dy, scale * (points.range[i] - margin)) ? 1 : 0;
    if (crossing > most_beams) { return 1.0; }
  }
  return beams == 0 ? 0.0 : crossing / static_cast<double>(beams);
}

}  // namespace flirt
