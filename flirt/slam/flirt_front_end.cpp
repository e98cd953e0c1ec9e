#include "flirt/slam/flirt_front_end.hpp"

namespace flirt {

ScanMotion FlirtFrontEnd::add(const SlamScan& scan) {
  ScanMotion motion;
  const bool has_few = scan.features.keypoints.size() < params_.flirt.featureless_below;
  if (!last_) {
    motion.structure = has_few ? Structure::featureless : Structure::structured;
    reckoning_.remember(scan, {});
    last_ = scan;
    return motion;
  }
  matcher_.set_query(scan);
  std::optional<ConstraintMatch> found = matcher_.match(*last_);
  if (found) { found = matcher_.verified(*last_, matcher_.refined(*last_, *found)); }
  RelativeMotion relative{1, reckoning_.motion(scan), reckoning_.information(scan)};
  if (found) {
    relative.earlier_from_robot = found->earlier_from_robot;
    relative.information = found->information;
  }
  motion.source = found ? MotionSource::narrow : MotionSource::prediction;
  motion.score = found ? found->inliers : 0;
  motion.unobservable = !found;
  motion.structure = found ? Structure::structured : has_few ? Structure::featureless : Structure::cluttered;
  motion.relative.push_back(relative);
  reckoning_.remember(scan, relative.earlier_from_robot);
  last_ = scan;
  return motion;
}

}  // namespace flirt
