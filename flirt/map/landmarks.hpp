// flirt/map/landmarks.hpp: the keypoints of all map scans merged to landmarks, and where a scan's keypoints say it was
// taken.
#pragma once

#include "flirt/core/fields.hpp"
#include "flirt/core/scan_interval.hpp"
#include "flirt/features/features.hpp"
#include "flirt/map/place_map.hpp"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace flirt {

struct LandmarkParams {
  double merge_distance{0.2};                      ///< m, keypoints farther apart are different landmarks
  double merge_heading{radians_from_degrees(20)};  ///< rad, so are keypoints turned more
  double merge_descriptor{0.35};                   ///< so are keypoints with a larger Hellinger distance
  std::uint32_t neighbours{1000};                  ///< most similar landmarks that each keypoint votes with
  double vote_distance{0.5};                       ///< m, side of a bin of votes
  double vote_heading{radians_from_degrees(12)};   ///< rad, of a bin
  std::uint32_t places{1000};                      ///< bins with most votes that are searched
};

template <class Params, class Visitor>
  requires std::same_as<std::remove_const_t<Params>, LandmarkParams>
void visit_fields(Params& params, Visitor&& visit) {
  visit(params.merge_distance, Field{"merge_distance", "m", "keypoints farther apart are two landmarks", 0.01, 5});
  visit(params.merge_heading, Field{"merge_heading", "rad", "keypoints turned more are two landmarks", 0, 3.2});
  visit(params.merge_descriptor, Field{"merge_descriptor", "1", "so are keypoints with a larger distance", 0, 1});
  visit(params.neighbours, Field{"neighbours", "", "similar landmarks that a keypoint votes with", 1, 100000});
  visit(params.vote_distance, Field{"vote_distance", "m", "side of a bin of votes", 0.05, 10});
  visit(params.vote_heading, Field{"vote_heading", "rad", "heading covered by a bin of votes", 0.01, 1});
  visit(params.places, Field{"places", "", "bins with most votes that are searched", 1, 100000});
}

/// Landmarks of a map: oriented points with the mean descriptor of all keypoints that were seen there. A place seen by
/// fifty scans has one landmark where it had fifty keypoints, so that a few hundred neighbours reach over the whole
/// map.
class Landmarks {
 public:
  /// Of all map scans but those in `excluded`, in the order of the scans. O(keypoints · landmarks near each).
  Landmarks(const PlaceMap& map, const LandmarkParams& params, ScanInterval excluded = {});

  [[nodiscard]] std::size_t size() const { return map_from_landmark_.size(); }
  [[nodiscard]] std::size_t bytes() const {
    return map_from_landmark_.size() * sizeof(Pose2) + (rows_.size() + roots_.size()) * sizeof(float);
  }

  /// Places (bin centres) that the keypoints of a scan vote for, most votes first: one correspondence of oriented
  /// points fixes a pose, and each keypoint counts once in a bin, with its best similarity. `features` as the map's.
  /// O(keypoints · landmarks · stride).
  [[nodiscard]] std::vector<Pose2> vote(const Features& features) const;

 private:
  friend class LandmarkMerger;
  LandmarkParams params_;
  std::vector<Pose2> map_from_landmark_;
  std::vector<float> rows_;   ///< as Descriptors::rows, means
  std::vector<float> roots_;  ///< as Descriptors::roots
  std::uint32_t dimension_{0};
  std::uint32_t stride_{0};
};

}  // namespace flirt
