#include "flirt/io/log_summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace flirt {
namespace {

/// The value below which this share of the values lies (the nearest one); reorders. `values` is not empty.
double quantile(std::vector<double>& values, double share) {
  const auto index = static_cast<std::ptrdiff_t>(std::lround(share * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + index, values.end());
  return values[static_cast<std::size_t>(index)];
}

RangeSummary summarize_ranges(const std::vector<Scan>& scans) {
  RangeSummary summary;
  std::vector<double> hits;
  for (const Scan& scan : scans) {
    for (const double range : scan.ranges) {
      switch (classify(range, scan.beams)) {
        case Reading::hit:
          hits.push_back(range);
          break;
        case Reading::no_return:
          ++summary.no_returns;
          break;
        case Reading::invalid:
          ++summary.invalid;
          break;
      }
    }
  }
  summary.hits = hits.size();
  if (hits.empty()) { return summary; }
  summary.shortest = quantile(hits, 0.0);
  summary.median = quantile(hits, 0.5);
  summary.percentile_95 = quantile(hits, 0.95);
  summary.longest = quantile(hits, 1.0);
  return summary;
}

StampSummary summarize_stamps(const std::vector<Scan>& scans) {
  if (scans.size() < 2) { return {}; }
  std::vector<double> intervals;
  double smallest = scans.front().stamp;
  double largest = smallest;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    intervals.push_back(scans[i].stamp - scans[i - 1].stamp);
    smallest = std::min(smallest, scans[i].stamp);
    largest = std::max(largest, scans[i].stamp);
  }
  return {scans.front().stamp, scans.back().stamp, largest - smallest, quantile(intervals, 0.5)};
}

PathSummary summarize_path(const std::vector<Pose2>& poses) {
  if (poses.empty()) { return {}; }
  PathSummary summary{poses.size(), 0, poses.front().translation(), poses.front().translation()};
  for (std::size_t i = 1; i < poses.size(); ++i) {
    summary.length += distance(poses[i - 1], poses[i]);
    summary.low = {std::min(summary.low.x, poses[i].x), std::min(summary.low.y, poses[i].y)};
    summary.high = {std::max(summary.high.x, poses[i].x), std::max(summary.high.y, poses[i].y)};
  }
  return summary;
}

}  // namespace

LogSummary summarize(const ScanLog& log) {
  LogSummary summary{.scans = log.scans.size()};
  std::vector<Pose2> odom_from_robot;
  for (const Scan& scan : log.scans) {
    summary.most_beams = std::max(summary.most_beams, scan.ranges.size());
    if (scan.odom_from_robot) { odom_from_robot.push_back(*scan.odom_from_robot); }
  }
  summary.fewest_beams = summary.most_beams;
  for (const Scan& scan : log.scans) { summary.fewest_beams = std::min(summary.fewest_beams, scan.ranges.size()); }
  summary.ranges = summarize_ranges(log.scans);
  summary.stamps = summarize_stamps(log.scans);
  summary.map = summarize_path(log.map_from_robot);
  summary.odometry = summarize_path(odom_from_robot);
  return summary;
}

}  // namespace flirt
