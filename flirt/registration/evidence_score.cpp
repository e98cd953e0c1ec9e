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

/// Cells from a place to the first solid cell in a direction; `length`, when there is none before.
float to_solid(const MapFields& fields, float from_x, float from_y, float direction_x, float direction_y,
               float length) {
  for (float t = 0; t < length;) {
    const auto x = floor_to_int(from_x + t * direction_x);
    const auto y = floor_to_int(from_y + t * direction_y);
    if (!fields.contains(x, y)) {
      t += 4;
      continue;
    }
    const MapTile* const tile = fields.tiles[fields.tile_index(x, y)].get();
    const std::uint8_t clear = tile == nullptr ? MapTile::clear : tile->clearance[MapTile::offset(x, y)];
    if (clear == MapTile::solid) { return t; }
    t += std::max(0.7F, static_cast<float>(clear));
  }
  return length;
}

/// Something solid that neighbouring beams cross.
struct CrossedThing {
  double beams{0};
  float first_x{0};  ///< cells, where the first of them meets it
  float first_y{0};  ///< cells
  double width{0};   ///< cells, from there to where another meets it, at most

  void add(float x, float y) {
    if (beams == 0) {
      first_x = x;
      first_y = y;
    }
    ++beams;
    width = std::max<double>(width, std::hypot(x - first_x, y - first_y));
  }
};

std::size_t count_beams(const ScanPoints& points, std::size_t stride) {
  std::size_t beams = 0;
  for (std::size_t i = 0; i < points.size(); i += stride) { beams += points.range[i] > 0 ? 1U : 0U; }
  return beams;
}

}  // namespace

EvidenceScore if_things_moved(EvidenceScore score, const EvidenceScoreParams& params) {
  score.through = score.through_fixed;
  score.total = weighted(score, params.fit);
  score.preference = weighted(score, params.preference);
  return score;
}

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
  add_crossings(score, points, map_from_sensor);
  score.total = weighted(score, params_.fit);
  score.preference = weighted(score, params_.preference);
  return score;
}

template <class Visit>
void EvidenceScorer::for_each_beam(const ScanPoints& points, const Pose2& map_from_sensor, std::size_t stride,
                                   const Visit& visit) const {
  const auto scale = static_cast<float>(1.0 / fields_->cell_size);
  const auto c = static_cast<float>(std::cos(map_from_sensor.theta));
  const auto s = static_cast<float>(std::sin(map_from_sensor.theta));
  const auto x0 = static_cast<float>((map_from_sensor.x - fields_->origin.x) / fields_->cell_size);
  const auto y0 = static_cast<float>((map_from_sensor.y - fields_->origin.y) / fields_->cell_size);
  const auto margin = static_cast<float>(params_.through_margin);
  for (std::size_t i = 0; i < points.size(); i += stride) {
    if (points.range[i] <= 0) { continue; }
    const float inverse_range = 1.0F / points.range[i];
    const float dx = (c * points.x[i] - s * points.y[i]) * inverse_range;
    const float dy = (s * points.x[i] + c * points.y[i]) * inverse_range;
    const float length = scale * (points.range[i] - margin);
    const float t = to_solid(*fields_, x0, y0, dx, dy, length);
    if (!visit(t < length, x0 + t * dx, y0 + t * dy)) { return; }
  }
}

double EvidenceScorer::through(const ScanPoints& points, const Pose2& map_from_sensor, std::size_t stride,
                               double most) const {
  const auto beams = static_cast<double>(count_beams(points, stride));
  double crossing = 0;
  for_each_beam(points, map_from_sensor, stride, [&](bool crosses, float /*x*/, float /*y*/) {
    crossing += crosses ? 1 : 0;
    return crossing <= most * beams;
  });
  if (crossing > most * beams) { return 1; }
  return beams == 0 ? 0 : crossing / beams;
}

/// The share of the beams that cross something solid, and the same where the narrow things among it count for little.
void EvidenceScorer::add_crossings(EvidenceScore& score, const ScanPoints& points, const Pose2& map_from_sensor) const {
  const auto beams = static_cast<double>(count_beams(points, 1));
  if (beams == 0) { return; }
  const double narrow = params_.moved_width / fields_->cell_size;
  double crossing = 0;
  double crossing_fixed = 0;
  CrossedThing thing;
  const auto end_thing = [&] {
    crossing += thing.beams;
    crossing_fixed += thing.width < narrow ? std::min(thing.beams, params_.moved_share * beams) : thing.beams;
    thing = {};
  };
  for_each_beam(points, map_from_sensor, 1, [&](bool crosses, float x, float y) {
    crosses ? thing.add(x, y) : end_thing();
    return true;
  });
  end_thing();
  score.through = crossing / beams;
  score.through_fixed = crossing_fixed / beams;
}

}  // namespace flirt
