#include "apps/flirt/map_picture.hpp"

#include "flirt/grid/evidence_grid.hpp"
#include "flirt/io/occupancy_map.hpp"

#include "apps/flirt/command.hpp"

namespace flirt::app {
namespace {

svg::Polylines line_of(const std::vector<Pose2>& poses, const svg::SeriesStyle& style, std::string legend) {
  svg::Polylines line{
      .lines = {{}}, .colour = style.colour, .width = 0.8, .dash = style.dash, .legend = std::move(legend)};
  for (const Pose2& pose : poses) { line.lines.front().push_back(pose.translation()); }
  return line;
}

}  // namespace

GridMapImage map_of(const ScanLog& log, std::span<const Pose2> map_from_robot, const std::string& name) {
  EvidenceGrid grid;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    grid.add(log.scans[i], map_from_robot[i] * log.scans[i].robot_from_sensor);
  }
  Result<GridMapImage> map = occupancy_map(grid, "map.pgm");
  if (!map) { throw BadInput(name + ": " + map.error().message); }
  return *std::move(map);
}

std::string map_picture(const GridMapImage& map, const MapOverlay& overlay) {
  svg::Plan plan;
  plan.layers.emplace_back(svg::Raster{
      .image = map.image, .map_from_image = map.metadata.origin, .resolution = map.metadata.resolution, .opacity = 1});
  if (!overlay.true_way.empty()) {
    plan.layers.emplace_back(line_of(overlay.true_way, {svg::black, svg::Dash::dashed}, "true way"));
  }
  plan.layers.emplace_back(line_of(overlay.way, {svg::blue, svg::Dash::solid}, "way of the robot"));
  svg::Polylines loops{.colour = svg::vermilion, .width = 0.6, .legend = "closures"};
  for (const auto& [from, to] : overlay.closures) { loops.lines.push_back({from, to}); }
  if (!loops.lines.empty()) { plan.layers.emplace_back(std::move(loops)); }
  if (!overlay.unseen.empty()) {
    plan.layers.emplace_back(
        svg::Points{.at = overlay.unseen, .colour = svg::orange, .radius = 2.5, .legend = "motion not observable"});
  }
  plan.bounds = overlay.bounds;
  return svg::to_svg({.panels = {plan}, .panel_width = 1000});
}

}  // namespace flirt::app
