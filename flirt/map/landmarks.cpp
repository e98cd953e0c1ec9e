#include "flirt/map/landmarks.hpp"

#include "flirt/match/distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace flirt {
namespace {

struct Bin {
  std::int32_t x{0};
  std::int32_t y{0};
  std::int32_t heading{0};

  friend bool operator==(const Bin&, const Bin&) = default;
};
struct BinHash {
  std::size_t operator()(const Bin& bin) const {
    const auto key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(bin.x)) << 32U) ^
                     (static_cast<std::uint64_t>(static_cast<std::uint32_t>(bin.y)) << 8U) ^
                     static_cast<std::uint32_t>(bin.heading);
    return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> 20U);
  }
};

std::int32_t cell_of(double value, double side) {
  return static_cast<std::int32_t>(std::floor(value / side));
}

/// Sums of the keypoints that make a landmark.
struct Sums {
  double x{0}, y{0}, cosine{0}, sine{0};
  double count{0};
};

double hellinger(const float* roots_a, const float* roots_b, std::uint32_t stride) {
  float dot = 0;
  for (std::uint32_t i = 0; i < stride; ++i) { dot += roots_a[i] * roots_b[i]; }
  return std::sqrt(std::max(0.0F, 1.0F - dot));
}

/// Votes in one bin: similarity by keypoint, each keypoint counted once.
struct Votes {
  float total{0};
  float of_last{0};
  std::uint32_t last{std::numeric_limits<std::uint32_t>::max()};

  void add(std::uint32_t keypoint, float similarity) {
    if (keypoint != last) {
      last = keypoint;
      of_last = 0;
    }
    if (similarity <= of_last) { return; }
    total += similarity - of_last;
    of_last = similarity;
  }
};

/// Landmarks by the cell of the first keypoint of their landmark.
using Cells = std::unordered_map<Bin, std::vector<std::uint32_t>, BinHash>;

struct Headings {
  std::int32_t count;
  double step;  // rad
};

Headings headings_of(double widest) {
  const auto count = static_cast<std::int32_t>(std::ceil(2 * std::numbers::pi / widest));
  return {count, 2 * std::numbers::pi / count};
}

/// Calls visit(bin) for the 8 bins around a pose: bins overlap by half, so that a peak on a border is not split.
template <class Visit>
void for_each_bin(const Pose2& pose, double side, const Headings& headings, const Visit& visit) {
  const std::int32_t x = cell_of(pose.x + 0.5 * side, side);
  const std::int32_t y = cell_of(pose.y + 0.5 * side, side);
  const std::int32_t h = cell_of(pose.theta + std::numbers::pi + 0.5 * headings.step, headings.step);
  for (std::int32_t corner = 0; corner < 8; ++corner) {
    const std::int32_t heading = ((h - (corner >> 2)) % headings.count + headings.count) % headings.count;
    visit(Bin{x - (corner & 1), y - (corner >> 1 & 1), heading});
  }
}

using Ballot = std::unordered_map<Bin, Votes, BinHash>;

/// The bins with most votes; of equal ones in the order of rows, columns and headings.
std::vector<Bin> most_voted(const Ballot& ballot, std::size_t count) {
  std::vector<std::pair<float, Bin>> bins;
  bins.reserve(ballot.size());
  for (const auto& [bin, votes] : ballot) { bins.emplace_back(votes.total, bin); }
  const auto key = [](const std::pair<float, Bin>& entry) {
    return std::tuple(-entry.first, entry.second.y, entry.second.x, entry.second.heading);
  };
  const std::size_t kept = std::min(count, bins.size());
  std::ranges::partial_sort(bins, bins.begin() + static_cast<std::ptrdiff_t>(kept), {}, key);
  std::vector<Bin> best;
  best.reserve(kept);
  for (std::size_t i = 0; i < kept; ++i) { best.push_back(bins[i].second); }
  return best;
}

constexpr std::uint32_t no_landmark = std::numeric_limits<std::uint32_t>::max();

}  // namespace

/// Merges keypoints one by one; its place in `cells` stays that of a landmark's first keypoint, as the mean moves less
/// than a cell.
class LandmarkMerger {
 public:
  explicit LandmarkMerger(Landmarks& landmarks) : into_(landmarks) {}

  void add(const Pose2& map_from_keypoint, const float* row, const float* roots) {
    const double side = into_.params_.merge_distance;
    const Bin cell{cell_of(map_from_keypoint.x, side), cell_of(map_from_keypoint.y, side), 0};
    std::uint32_t landmark = most_alike(map_from_keypoint, cell, roots);
    if (landmark == no_landmark) {
      landmark = static_cast<std::uint32_t>(sums_.size());
      sums_.emplace_back();
      into_.map_from_landmark_.push_back(map_from_keypoint);
      into_.rows_.resize(into_.rows_.size() + into_.stride_, 0.0F);
      into_.roots_.resize(into_.roots_.size() + into_.stride_, 0.0F);
      cells_[cell].push_back(landmark);
    }
    merge(landmark, map_from_keypoint, row);
  }

 private:
  [[nodiscard]] std::uint32_t most_alike(const Pose2& pose, const Bin& cell, const float* roots) const {
    const LandmarkParams& params = into_.params_;
    std::uint32_t best = no_landmark;
    double least = params.merge_descriptor;
    for (std::int32_t k = 0; k < 9; ++k) {
      const auto found = cells_.find({cell.x + k % 3 - 1, cell.y + k / 3 - 1, 0});
      if (found == cells_.end()) { continue; }
      for (const std::uint32_t other : found->second) {
        const Pose2& there = into_.map_from_landmark_[other];
        if (distance(pose, there) > params.merge_distance) { continue; }
        if (heading_difference(pose, there) > params.merge_heading) { continue; }
        const double apart = hellinger(roots, into_.roots_.data() + std::size_t{other} * into_.stride_, into_.stride_);
        if (apart < least) {
          least = apart;
          best = other;
        }
      }
    }
    return best;
  }

  void merge(std::uint32_t landmark, const Pose2& pose, const float* row) {
    Sums& sum = sums_[landmark];
    sum = {sum.x + pose.x, sum.y + pose.y, sum.cosine + std::cos(pose.theta), sum.sine + std::sin(pose.theta),
           sum.count + 1};
    into_.map_from_landmark_[landmark] = {sum.x / sum.count, sum.y / sum.count, std::atan2(sum.sine, sum.cosine)};
    const auto weight = static_cast<float>(1.0 / sum.count);
    const std::size_t first = std::size_t{landmark} * into_.stride_;
    for (std::size_t i = 0; i < into_.stride_; ++i) {
      float& mean = into_.rows_[first + i];
      mean += weight * (row[i] - mean);
      into_.roots_[first + i] = std::sqrt(std::max(0.0F, mean));
    }
  }

  Landmarks& into_;
  std::vector<Sums> sums_;
  Cells cells_;
};

Landmarks::Landmarks(const PlaceMap& map, const LandmarkParams& params, ScanInterval excluded)
    : params_(params), dimension_(map.descriptor_dimension()), stride_(map.descriptor_stride()) {
  LandmarkMerger merger(*this);
  for (std::size_t scan = 0; scan < map.size(); ++scan) {
    if (excluded.contains(scan)) { continue; }
    const FeatureColumns features = map.features(scan);
    const KeypointColumns& at = features.keypoints;
    for (std::size_t k = 0; k < at.size(); ++k) {
      const Pose2 sensor_from_keypoint{at.x[k], at.y[k], at.theta[k]};
      if (!is_usable(sensor_from_keypoint)) { continue; }
      merger.add(map.map_from_sensor(scan) * sensor_from_keypoint, features.descriptors.rows + k * stride_,
                 features.descriptors.roots + k * stride_);
    }
  }
}

std::vector<Pose2> Landmarks::vote(const Features& features) const {
  if (size() == 0 || features.keypoints.empty()) { return {}; }
  const DescriptorRows query = rows_of(features.descriptors);
  const DescriptorRows reference{.rows = rows_.data(),
                                 .roots = roots_.data(),
                                 .count = static_cast<std::uint32_t>(size()),
                                 .dimension = dimension_,
                                 .stride = stride_};
  const Headings headings = headings_of(params_.vote_heading);
  const auto kept = static_cast<std::ptrdiff_t>(std::min<std::size_t>(params_.neighbours, size()));
  Ballot ballot;
  std::vector<float> distances(size());
  std::vector<std::uint32_t> order(size());
  for (std::uint32_t k = 0; k < features.keypoints.size(); ++k) {
    descriptor_distances(Distance::hellinger, query, k, reference, distances);
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::nth_element(order, order.begin() + kept - 1, {},
                             [&distances](std::uint32_t i) { return std::pair(distances[i], i); });
    const Pose2 keypoint_from_sensor = inverse(features.keypoints[k].sensor_from_keypoint);
    for (const std::uint32_t landmark : std::span(order).first(static_cast<std::size_t>(kept))) {
      const float similarity = 1.0F - distances[landmark];
      if (!(similarity > 0)) { continue; }
      for_each_bin(map_from_landmark_[landmark] * keypoint_from_sensor, params_.vote_distance, headings,
                   [&](const Bin& bin) { ballot[bin].add(k, similarity); });
    }
  }
  const std::vector<Bin> best = most_voted(ballot, params_.places);
  std::vector<Pose2> poses;
  poses.reserve(best.size());
  for (const Bin& bin : best) {
    poses.push_back({(bin.x + 0.5) * params_.vote_distance, (bin.y + 0.5) * params_.vote_distance,
                     wrap_angle((bin.heading + 0.5) * headings.step - std::numbers::pi)});
  }
  return poses;
}

}  // namespace flirt
