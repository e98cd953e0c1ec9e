// flirt/slam/scan_front_end.hpp: each scan against the accumulated map of the last metres.
#pragma once

#include "flirt/features/extract.hpp"
#include "flirt/match/pair_matcher.hpp"
#include "flirt/registration/local_map.hpp"
#include "flirt/registration/surface_alignment.hpp"
#include "flirt/slam/dead_reckoning.hpp"
#include "flirt/slam/front_end.hpp"
#include "flirt/slam/hold.hpp"
#include "flirt/slam/odometry_error.hpp"
#include "flirt/slam/slam_params.hpp"
#include "flirt/slam/slam_scan.hpp"

#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace flirt {

/// Correlative search around the predicted pose in a local map of the last scans, each candidate drawn onto its walls
/// and judged by all its beams; wide search when that does not convince (Olson 2009; Konolige and others 2010). As
/// `automatic`, it then also matches keypoints with those of the last scans, however far the robot moved.
class ScanFrontEnd {
 public:
  explicit ScanFrontEnd(const SlamParams& params)
      : params_(params), reckoning_(params), matcher_(MatchParams{}, RansacParams{.min_inliers = 4}) {}

  [[nodiscard]] ScanMotion add(const SlamScan& scan);

 private:
  struct Judged {
    Pose2 local_from_robot{};
    AlignmentTerms terms{};
    double score{-1e9};      ///< with the penalty for leaving the prediction
    double quality{-1e9};    ///< score that it would have if all points were where something had been seen
    double plausible{-1e9};  ///< the same with that penalty
  };
  struct MapScan {
    SlamScan scan;
    Pose2 local_from_robot;
    double travel;
  };

  struct Prediction {
    Pose2 local_from_robot;
    std::optional<double> odometry;  ///< m, deviation of its translation, where it is odometry's
  };

  [[nodiscard]] Prediction predicted(const SlamScan& scan) const;
  [[nodiscard]] double surprise(const Prediction& prediction, const Pose2& local_from_robot) const;
  [[nodiscard]] Judged judge(const SurfacePoints& points, const Pose2& start, const Prediction& prediction) const;
  struct Placed {
    Judged best;
    MotionSource source;
    std::optional<Pose2> rival;
  };
  [[nodiscard]] std::optional<Pose2> rival(std::span<const Judged> tried, const Judged& best) const;
  [[nodiscard]] std::vector<Judged> search(const SurfacePoints& points, const Prediction& prediction, double extent,
                                           double turn) const;

  void extract_keypoints(SlamScan& scan);
  [[nodiscard]] std::vector<Judged> match_keypoints(const SlamScan& scan, const Prediction& prediction);
  [[nodiscard]] double wide_extent() const;
  [[nodiscard]] bool is_believable(const std::optional<Placed>& placed) const;
  [[nodiscard]] std::optional<Placed> place(const SlamScan& scan, const Prediction& prediction);
  struct Attempt {
    Prediction prediction;
    std::optional<Placed> placed;
  };
  [[nodiscard]] Attempt placed_despite_jumps(const SlamScan& scan);
  void remember(const SlamScan& scan, const Pose2& local_from_robot);
  void restart(const SlamScan& scan, const Pose2& local_from_robot);
  void add_to_map(const SlamScan& scan, const Pose2& local_from_robot);
  static void move_towards(const Pose2& other, Point2 direction_in_robot, double share, Judged& found);
  static void give_up_direction(Judged& found, const Pose2& prediction, const Hold& hold);
  void weigh_direction(Judged& found, const Prediction& prediction, const Hold& hold) const;
  static Eigen::Vector3d give_up_towards(const Pose2& rival, Judged& found);
  [[nodiscard]] Eigen::Vector3d unmeasured(const ScanMotion& motion, const Prediction& prediction) const;
  void add_relative(ScanMotion& motion, const Judged& found, const Eigen::Vector3d& floor) const;

  SlamParams params_;
  DeadReckoning reckoning_;
  OdometryError odometry_error_{};
  LocalMap map_{};
  std::deque<MapScan> map_scans_{};
  FeatureExtractor extractor_{};
  PairMatcher matcher_;
  std::vector<Pose2> recent_{};  ///< local_from_robot of the last four scans
  double travel_{0};
  std::uint32_t blind_{0};          ///< scans in a row that were not believed
  std::uint32_t seen_in_a_row_{0};  ///< motions up to the last that could be seen
};

}  // namespace flirt
