#include "flirt/slam/pair_front_end.hpp"

#include "flirt/registration/surface_alignment.hpp"
#include "flirt/registration/window_search.hpp"
#include "flirt/slam/hold.hpp"

#include <span>

namespace flirt {
namespace {

constexpr std::size_t fewest_points = 15;
constexpr double least_share = 0.3;  // of the points that find a line

}  // namespace

/// Where the alignment begins.
Pose2 PairFrontEnd::start(const SlamScan& scan, const Pose2& prediction) const {
  if (params_.front_end != FrontEndKind::olson) { return prediction; }
  const bool odometry = reckoning_.uses_odometry(scan);
  const SearchWindow window{.map_from_robot = prediction,
                            .half_extent = odometry ? params_.odometry_extent : params_.narrow_extent,
                            .half_turn = odometry ? params_.odometry_turn : params_.narrow_turn,
                            .candidates = 1};
  LocalMap map;
  map.add(*last_, {});
  const auto found = search_window(map, std::span(&scan.points, 1), window);
  return found.empty() ? prediction : found.front().map_from_robot;
}

ScanMotion PairFrontEnd::add(const SlamScan& scan) {
  ScanMotion motion;
  if (!last_) {
    reckoning_.remember(scan, {});
    last_ = scan.points;
    return motion;
  }
  const Pose2 prediction = reckoning_.motion(scan);
  RelativeMotion relative{1, prediction, reckoning_.information(scan)};
  motion.source = MotionSource::prediction;
  motion.unobservable = true;
  if (scan.points.size() >= fewest_points && last_->size() >= fewest_points) {
    const Pose2 from = start(scan, prediction);
    const AlignedPose aligned = align_to_scan(*last_, scan.points, from, {from, Eigen::Vector3d(2, 2, 2).asDiagonal()});
    const auto points = static_cast<double>(scan.points.size());
    if (static_cast<double>(aligned.terms.pairs) >= least_share * points) {
      const Eigen::Vector3d floor(params_.floor_translation, params_.floor_translation, params_.floor_rotation);
      const Eigen::Matrix3d least = floor.cwiseProduct(floor).cwiseInverse().asDiagonal();
      relative.earlier_from_robot = aligned.map_from_robot;
      relative.information = edge_information(aligned.terms.information, params_.range_sigma, least);
      motion.source = MotionSource::narrow;
      motion.unobservable = hold_of(scan.points).weakest < params_.unobservable_share;
      motion.score = aligned.terms.weight / points;
    }
  }
  motion.relative.push_back(relative);
  reckoning_.remember(scan, relative.earlier_from_robot);
  last_ = scan.points;
  return motion;
}

}  // namespace flirt
