// tests/match/reference_pairs.hpp: scans and pairs that the authors' own library was run on.
#pragma once

#include "flirt/features/features.hpp"
#include "flirt/io/file.hpp"
#include "flirt/match/ransac.hpp"

#include "tests/match/random_features.hpp"
#include "tests/support/data.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace flirt::test {

/// Every line of a gzip file of JSON lines. Throws on broken data.
inline std::vector<nlohmann::json> read_json_lines(const std::filesystem::path& path) {
  auto reader = LineReader::open(path);
  if (!reader) { throw std::runtime_error(reader.error().message); }
  std::vector<nlohmann::json> lines;
  while (true) {
    const auto line = reader->next();
    if (!line) { throw std::runtime_error(line.error().message); }
    if (!*line) { return lines; }
    lines.push_back(nlohmann::json::parse((*line)->text));
  }
}

struct ReferenceScan {
  Pose2 world_from_laser;
  Features features;  ///< keypoints in the laser frame
};

/// One pair, matched with inlier probability 0.3 and nearest neighbours.
struct ReferencePair {
  std::size_t query, reference;                           ///< scan indices in the log
  std::string descriptor;                                 ///< "beta" or "shape"
  std::vector<std::pair<std::uint32_t, double>> nearest;  ///< per query keypoint: reference keypoint, χ²
  std::optional<Pose2> world_from_query;
  Pose2 true_world_from_query;
  double residual;
  std::vector<IndexPair> inliers;
};

/// `column` is the descriptor's field: "bg_hist" or "sc".
inline std::map<std::size_t, ReferenceScan> reference_scans(const std::filesystem::path& path,
                                                            std::string_view column) {
  std::map<std::size_t, ReferenceScan> scans;
  for (const nlohmann::json& line : read_json_lines(path)) {
    const auto& pose = line.at("laser_pose");
    ReferenceScan scan{{pose[0], pose[1], pose[2]}, {}};
    for (const auto& point : line.at("points")) {
      const Pose2 world_from_keypoint{point.at("x"), point.at("y"), point.at("theta")};
      scan.features.keypoints.push_back(
          {.sensor_from_keypoint = inverse(scan.world_from_laser) * world_from_keypoint, .scale = point.at("scale")});
      append_row(scan.features.descriptors, point.at(column).get<std::vector<float>>());
    }
    scans.emplace(line.at("scan").get<std::size_t>(), std::move(scan));
  }
  return scans;
}

inline std::vector<ReferencePair> reference_pairs(const std::filesystem::path& path) {
  std::vector<ReferencePair> pairs;
  for (const nlohmann::json& line : read_json_lines(path)) {
    const auto& truth = line.at("true_pose");
    ReferencePair pair{
        line.at("query"), line.at("ref"), line.at("descriptor"), {}, {}, {truth[0], truth[1], truth[2]}, 0.0, {}};
    for (const auto& nearest : line.at("nn")) { pair.nearest.emplace_back(nearest[0], nearest[1]); }
    for (const auto& result : line.at("results")) {
      if (result.at("inlier_prob") != 0.3 || result.at("strategy") != "nn") { continue; }
      pair.residual = result.at("residual");
      for (const auto& inlier : result.at("inliers")) { pair.inliers.push_back({inlier[0], inlier[1]}); }
      const auto& pose = result.at("transform");
      if (!pose.is_null() && pair.residual < 1.0) { pair.world_from_query = Pose2{pose[0], pose[1], pose[2]}; }
    }
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

}  // namespace flirt::test
