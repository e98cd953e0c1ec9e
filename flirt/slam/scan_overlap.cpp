#include "flirt/slam/scan_overlap.hpp"

#include "flirt/core/assert.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace flirt {
namespace {

constexpr double piece_size = 0.3;               // m
constexpr double least_share = 0.3;              // of the pieces of the scan that has fewer
constexpr std::uint32_t neighbours_in_time = 3;  // scans
constexpr std::uint32_t same_visit = 4;          // scans; of those so near in time only one becomes a partner
constexpr std::size_t seen_enough = 100;         // scans that share enough with a later one, which then is no partner

/// A square of the map, and which of four ways its surface faces.
std::uint64_t piece_at(Point2 in_map, Point2 normal) {
  const auto square = [](double v) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(v / piece_size)));
  };
  const bool along_x = std::abs(normal.x) > std::abs(normal.y);
  const std::uint32_t facing = (along_x ? 2U : 0U) + ((along_x ? normal.x : normal.y) > 0 ? 1U : 0U);
  constexpr std::uint64_t bits = (1U << 30U) - 1;
  return ((square(in_map.x) & bits) << 32U) | ((square(in_map.y) & bits) << 2U) | facing;
}

/// Each once.
std::vector<std::uint64_t> pieces_of(const SurfacePoints& points, const Pose2& map_from_robot) {
  const Pose2 turn{0, 0, map_from_robot.theta};
  std::vector<std::uint64_t> pieces;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points.normal_x[i] == 0 && points.normal_y[i] == 0) { continue; }
    const Point2 normal = turn * Point2{points.normal_x[i], points.normal_y[i]};
    pieces.push_back(piece_at(map_from_robot * Point2{points.x[i], points.y[i]}, normal));
  }
  std::ranges::sort(pieces);
  const auto repeated = std::ranges::unique(pieces);
  pieces.erase(repeated.begin(), repeated.end());
  return pieces;
}

/// Scans by the pieces that they see.
class ScansByPiece {
 public:
  explicit ScansByPiece(std::size_t scans) : shared_(scans, 0), count_(scans, 0) {}

  struct Overlap {
    std::uint32_t scan;
    double share;
  };
  /// Earlier scans that see enough of the same, those that share most first; then the scan takes part itself, unless
  /// there are many.
  std::vector<Overlap> add(std::uint32_t scan, const SurfacePoints& points, const Pose2& map_from_robot) {
    const std::vector<std::uint64_t> pieces = pieces_of(points, map_from_robot);
    count_[scan] = pieces.size();
    std::vector<std::uint32_t> touched;
    for (const std::uint64_t piece : pieces) {
      for (const std::uint32_t other : scans_[piece]) {
        if (shared_[other]++ == 0) { touched.push_back(other); }
      }
    }
    std::vector<Overlap> overlaps;
    for (const std::uint32_t other : touched) {
      const double share =
          static_cast<double>(shared_[other]) / static_cast<double>(std::min(count_[scan], count_[other]));
      shared_[other] = 0;
      if (share > least_share) { overlaps.push_back({other, share}); }
    }
    if (overlaps.size() < seen_enough) {
      for (const std::uint64_t piece : pieces) { scans_[piece].push_back(scan); }
    }
    std::ranges::sort(overlaps, {}, [](const Overlap& overlap) { return std::pair(-overlap.share, overlap.scan); });
    return overlaps;
  }

 private:
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> scans_{};
  std::vector<std::uint32_t> shared_;  // pieces with the scan in question; all 0 in between
  std::vector<std::size_t> count_;     // pieces of each scan
};

bool same_time(std::uint32_t one, std::uint32_t other) {
  return (one > other ? one - other : other - one) < same_visit;
}

bool stands_still(const Pose2& pose, const Pose2& before) {
  constexpr double distance_moved = 0.03;  // m
  constexpr double heading_moved = 0.03;   // rad
  return distance(pose, before) < distance_moved && heading_difference(pose, before) < heading_moved;
}

}  // namespace

std::vector<ScanPair> overlapping_pairs(std::span<const Pose2> map_from_node, std::span<const SurfacePoints> scans,
                                        std::size_t most) {
  FLIRT_ASSERT(map_from_node.size() == scans.size());
  ScansByPiece by_piece(scans.size());
  std::vector<std::uint32_t> moved;  // since the one before
  std::vector<ScanPair> pairs;
  for (std::uint32_t node = 0; node < scans.size(); ++node) {
    if (!moved.empty() && stands_still(map_from_node[node], map_from_node[moved.back()])) {
      pairs.push_back({moved.back(), node});
      continue;
    }
    const auto b = static_cast<std::uint32_t>(moved.size());
    moved.push_back(node);
    for (std::uint32_t a = b > neighbours_in_time ? b - neighbours_in_time : 0; a < b; ++a) {
      pairs.push_back({moved[a], node});
    }
    std::vector<std::uint32_t> taken;
    for (const auto& [a, share] : by_piece.add(b, scans[node], map_from_node[node])) {
      if (taken.size() == most) { break; }
      if (b - a <= neighbours_in_time) { continue; }
      if (std::ranges::any_of(taken, [scan = a](std::uint32_t other) { return same_time(scan, other); })) { continue; }
      taken.push_back(a);
      pairs.push_back({moved[a], node});
    }
  }
  return pairs;
}

}  // namespace flirt
