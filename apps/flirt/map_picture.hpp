// apps/flirt/map_picture.hpp: a map made of scans at poses, as a picture with the ways that led to it.
#pragma once

#include "flirt/core/scan.hpp"
#include "flirt/io/ros_map.hpp"
#include "flirt/io/svg.hpp"

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace flirt::app {

/// Black: occupied. White: free. Grey: never seen. Ends the command when the scans lie too far apart for one image.
GridMapImage map_of(const ScanLog& log, std::span<const Pose2> map_from_robot, const std::string& name);

/// What is drawn over the map.
struct MapOverlay {
  std::vector<Pose2> way{};                           ///< of the robot
  std::vector<Pose2> true_way{};                      ///< in the same frame; empty: not drawn
  std::vector<std::pair<Point2, Point2>> closures{};  ///< m
  std::vector<Point2> unseen{};                       ///< m, where a motion was not observable
  std::optional<svg::Bounds> bounds{};                ///< m, the part to show; else all
};
/// One SVG document.
std::string map_picture(const GridMapImage& map, const MapOverlay& overlay);

}  // namespace flirt::app
