#include "flirt/eval/revisit.hpp"

#include "flirt/core/assert.hpp"

#include <bit>
#include <cmath>

namespace flirt {
namespace {

/// Points in square cells of the search radius, hashed: all points near a place lie in 3 × 3 cells.
class PointBuckets {
 public:
  PointBuckets(std::span<const Point2> points, double radius)
      : points_(points), radius_(radius), mask_(std::bit_ceil(2 * points.size() + 1) - 1), starts_(mask_ + 2) {
    for (const Point2 point : points) { ++starts_[bucket(cell(point.x), cell(point.y)) + 1]; }
    for (std::size_t i = 1; i < starts_.size(); ++i) { starts_[i] += starts_[i - 1]; }
    std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
    order_.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      order_[next[bucket(cell(points[i].x), cell(points[i].y))]++] = static_cast<std::uint32_t>(i);
    }
  }

  /// Calls visit(index) for every point within the radius of `centre`; twice at worst when two cells share a bucket.
  template <class Visit>
  void near(Point2 centre, const Visit& visit) const {
    const std::int64_t cx = cell(centre.x);
    const std::int64_t cy = cell(centre.y);
    for (std::int64_t x = cx - 1; x <= cx + 1; ++x) {
      for (std::int64_t y = cy - 1; y <= cy + 1; ++y) {
        const std::size_t index = bucket(x, y);
        for (std::size_t k = starts_[index]; k < starts_[index + 1]; ++k) {
          if (squared_norm(points_[order_[k]] - centre) <= radius_ * radius_) { visit(order_[k]); }
        }
      }
    }
  }

 private:
  [[nodiscard]] std::int64_t cell(double coordinate) const {
    return static_cast<std::int64_t>(std::floor(coordinate / radius_));
  }
  [[nodiscard]] std::size_t bucket(std::int64_t x, std::int64_t y) const {
    const auto hash =
        static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fULL;
    return (hash >> 32U) & mask_;
  }

  std::span<const Point2> points_;
  double radius_;
  std::size_t mask_;
  std::vector<std::uint32_t> starts_;
  std::vector<std::uint32_t> order_;
};

double covered_share(const PointBuckets& query, std::size_t query_size, std::span<const Point2> reference,
                     const Pose2& query_from_reference, std::vector<char>& covered) {
  if (query_size == 0) { return 0; }
  covered.assign(query_size, 0);
  std::size_t count = 0;
  for (const Point2 point : reference) {
    query.near(query_from_reference * point, [&](std::uint32_t i) {
      count += covered[i] == 0 ? 1 : 0;
      covered[i] = 1;
    });
  }
  return static_cast<double>(count) / static_cast<double>(query_size);
}

std::vector<Point2> return_points(const Scan& scan, const RevisitParams& params) {
  std::vector<Point2> points;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range = scan.ranges[i];
    if (classify(range, scan.beams) != Reading::hit) { continue; }
    if (range > params.return_min && range < params.return_max) {
      points.push_back({range * std::cos(scan.beams.angle(i)), range * std::sin(scan.beams.angle(i))});
    }
  }
  return points;
}

}  // namespace

std::vector<double> path_lengths(const ScanLog& log) {
  std::vector<double> lengths(log.scans.size());
  for (std::size_t i = 1; i < lengths.size(); ++i) {
    lengths[i] = lengths[i - 1] + distance(log.map_from_sensor(i - 1), log.map_from_sensor(i));
  }
  return lengths;
}

std::vector<ScanInterval> travel_neighbours(const ScanLog& log, double travel) {
  const std::vector<double> lengths = path_lengths(log);
  std::vector<ScanInterval> intervals(lengths.size());
  std::size_t begin = 0;
  std::size_t end = 0;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    while (lengths[i] - lengths[begin] > travel) { ++begin; }
    while (end < lengths.size() && lengths[end] - lengths[i] <= travel) { ++end; }
    intervals[i] = {begin, end};
  }
  return intervals;
}

double overlap(std::span<const Point2> query, const Pose2& map_from_query, std::span<const Point2> reference,
               const Pose2& map_from_reference, double tolerance) {
  std::vector<char> covered;
  return covered_share(PointBuckets(query, tolerance), query.size(), reference,
                       inverse(map_from_query) * map_from_reference, covered);
}

std::vector<bool> answerable(const ScanLog& log, std::span<const std::size_t> queries, const RevisitParams& params,
                             std::size_t threads, const Progress& progress) {
  FLIRT_ASSERT(log.map_from_robot.size() == log.scans.size());
  const std::vector<ScanInterval> removed = travel_neighbours(log, params.travel);
  std::vector<std::vector<Point2>> points(log.scans.size());
  for (std::size_t i = 0; i < points.size(); ++i) { points[i] = return_points(log.scans[i], params); }

  std::vector<char> result(queries.size());
  parallel_for(
      queries.size(), threads,
      [&](std::size_t k, std::size_t) {
        const std::size_t query = queries[k];
        const auto beams = static_cast<double>(log.scans[query].ranges.size());
        if (static_cast<double>(points[query].size()) < params.returns * beams || points[query].empty()) { return; }
        const PointBuckets buckets(points[query], params.tolerance);
        const Pose2 query_from_map = inverse(log.map_from_sensor(query));
        std::vector<char> covered;
        for (std::size_t i = 0; i < points.size() && result[k] == 0; ++i) {
          if (removed[query].contains(i)) { continue; }
          if (distance(log.map_from_sensor(query), log.map_from_sensor(i)) > params.reach) { continue; }
          const Pose2 query_from_reference = query_from_map * log.map_from_sensor(i);
          const double share = covered_share(buckets, points[query].size(), points[i], query_from_reference, covered);
          result[k] = share >= params.overlap ? 1 : 0;
        }
      },
      progress, 4);
  return {result.begin(), result.end()};
}

}  // namespace flirt
