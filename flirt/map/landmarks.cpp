#include "flirt/map/landmarks.hpp"

#include "flirt/match/distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

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

}  // namespace

Landmarks::Landmarks(const PlaceMap& map, const LandmarkParams& params, ScanInterval excluded)
    : params_(params), dimension_(map.descriptor_dimension()), stride_(map.descriptor_stride()) {
  std::vector<Sums> sums;
  std::unordered_map<Bin, std::vector<std::uint32_t>, BinHash> near;
  const double side = params.merge_distance;
  for (std::size_t scan = 0; scan < map.size(); ++scan) {
    if (excluded.contains(scan)) { continue; }
    const FeatureColumns features = map.features(scan);
    for (std::size_t k = 0; k < features.keypoints.size(); ++k) {
      if (features.keypoints.x[k] >= out_of_sight) { continue; }
      const Pose2 pose = map.map_from_sensor(scan) *
                         Pose2{features.keypoints.x[k], features.keypoints.y[k], features.keypoints.theta[k]};
      const float* const row = features.descriptors.rows + k * stride_;
      const float* const roots = features.descriptors.roots + k * stride_;
      const Bin cell{cell_of(pose.x, side), cell_of(pose.y, side), 0};
      std::uint32_t best = std::numeric_limits<std::uint32_t>::max();
      double least = params.merge_descriptor;
      for (std::int32_t dy = -1; dy <= 1; ++dy) {
        for (std::int32_t dx = -1; dx <= 1; ++dx) {
          const auto found = near.find({cell.x + dx, cell.y + dy, 0});
          if (found == near.end()) { continue; }
          for (const std::uint32_t other : found->second) {
            const Pose2& there = map_from_landmark_[other];
            if (distance(pose, there) > side || heading_difference(pose, there) > params.merge_heading) { continue; }
            const double apart = hellinger(roots, roots_.data() + std::size_t{other} * stride_, stride_);
            if (apart < least) {
              least = apart;
              best = other;
            }
          }
        }
      }
      if (best == std::numeric_limits<std::uint32_t>::max()) {
        best = static_cast<std::uint32_t>(sums.size());
        sums.emplace_back();
        map_from_landmark_.push_back(pose);
        rows_.resize(rows_.size() + stride_, 0.0F);
        roots_.resize(roots_.size() + stride_, 0.0F);
        near[cell].push_back(best);
      }
      Sums& sum = sums[best];
      sum = {sum.x + pose.x, sum.y + pose.y, sum.cosine + std::cos(pose.theta), sum.sine + std::sin(pose.theta),
             sum.count + 1};
      // The place in `near` stays that of the first keypoint: the mean moves less than a cell.
      map_from_landmark_[best] = {sum.x / sum.count, sum.y / sum.count, std::atan2(sum.sine, sum.cosine)};
      const auto weight = static_cast<float>(1.0 / sum.count);
      for (std::uint32_t i = 0; i < stride_; ++i) {
        float& mean = rows_[std::size_t{best} * stride_ + i];
        mean += weight * (row[i] - mean);
        roots_[std::size_t{best} * stride_ + i] = std::sqrt(std::max(0.0F, mean));
      }
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
  const double side = params_.vote_distance;
  const auto headings = static_cast<std::int32_t>(std::ceil(2 * std::numbers::pi / params_.vote_heading));
  const double step = 2 * std::numbers::pi / headings;
  std::unordered_map<Bin, Votes, BinHash> bins;
  std::vector<float> distances(size());
  std::vector<std::uint32_t> order(size());
  const std::size_t kept = std::min<std::size_t>(params_.neighbours, size());
  for (std::uint32_t k = 0; k < features.keypoints.size(); ++k) {
    descriptor_distances(Distance::hellinger, query, k, reference, distances);
    for (std::uint32_t i = 0; i < order.size(); ++i) { order[i] = i; }
    const auto nearer = [&distances](std::uint32_t a, std::uint32_t b) {
      return distances[a] != distances[b] ? distances[a] < distances[b] : a < b;
    };
    std::ranges::nth_element(order, order.begin() + static_cast<std::ptrdiff_t>(kept - 1), nearer);
    const Pose2 keypoint_from_sensor = inverse(features.keypoints[k].sensor_from_keypoint);
    for (std::size_t i = 0; i < kept; ++i) {
      const std::uint32_t landmark = order[i];
      const float similarity = 1.0F - distances[landmark];
      if (!(similarity > 0)) { continue; }
      const Pose2 pose = map_from_landmark_[landmark] * keypoint_from_sensor;
      // Each vote counts in the bins around it, so that a peak on a border is not split.
      const std::int32_t x = cell_of(pose.x + 0.5 * side, side);
      const std::int32_t y = cell_of(pose.y + 0.5 * side, side);
      const std::int32_t h = cell_of(pose.theta + std::numbers::pi + 0.5 * step, step);
      for (std::int32_t corner = 0; corner < 8; ++corner) {
        const std::int32_t heading = ((h - (corner >> 2)) % headings + headings) % headings;
        bins[{x - (corner & 1), y - (corner >> 1 & 1), heading}].add(k, similarity);
      }
    }
  }
  struct Peak {
    Bin bin;
    float votes;
  };
  std::vector<Peak> peaks;
  peaks.reserve(bins.size());
  for (const auto& [bin, votes] : bins) { peaks.push_back({bin, votes.total}); }
  const auto better = [](const Peak& a, const Peak& b) {
    if (a.votes != b.votes) { return a.votes > b.votes; }
    if (a.bin.y != b.bin.y) { return a.bin.y < b.bin.y; }
    return a.bin.x != b.bin.x ? a.bin.x < b.bin.x : a.bin.heading < b.bin.heading;
  };
  const std::size_t places = std::min<std::size_t>(params_.places, peaks.size());
  std::ranges::partial_sort(peaks, peaks.begin() + static_cast<std::ptrdiff_t>(places), better);
  std::vector<Pose2> poses;
  poses.reserve(places);
  for (std::size_t i = 0; i < places; ++i) {
    const Bin& bin = peaks[i].bin;
    poses.push_back(
        {(bin.x + 0.5) * side, (bin.y + 0.5) * side, wrap_angle((bin.heading + 0.5) * step - std::numbers::pi)});
  }
  return poses;
}

}  // namespace flirt
