#include "apps/flirt/bench_locations.hpp"

#include "flirt/io/log.hpp"

#include <filesystem>

namespace flirt::app {

void LocationFlags::add(CLI::App& command, std::uint32_t& partners) {
  command.add_option("LOG", logs, "logs with corrected poses")->required();
  command
      .add_option("--locations", count,
                  "reference locations in all, shared evenly by the logs (default 20 a log: 60 from the papers' three)")
      ->check(CLI::Range(1, 100000));
  command.add_option("--partners", partners,
                     "scans a location and level of overlap, at most, drawn at random; 0 for all (default " +
                         std::to_string(partners) + ")");
}

ReferenceLocations read_locations(const LocationFlags& flags, const Session& session) {
  ReferenceLocations result;
  for (const std::string& file : flags.logs) {
    LoadedLog loaded = value_or_quit(read_log(file, {}, progress_bar(session, "reading")));
    if (loaded.log.map_from_robot.empty()) {
      throw BadInput(file + ": expected a log with poses (they are the truth), found none");
    }
    result.names.push_back(std::filesystem::path(file).filename().string());
    result.logs.push_back(std::move(loaded.log));
  }
  const std::size_t n = result.logs.size();
  const std::size_t count = flags.count != 0 ? flags.count : 20 * n;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t share = count / n + (i < count % n ? 1 : 0);
    const auto drawn = draw_locations(result.logs[i], i, share, session.seed);
    result.locations.insert(result.locations.end(), drawn.begin(), drawn.end());
  }
  if (result.locations.empty()) { throw BadInput(flags.logs.front() + ": expected scans with returns, found none"); }
  return result;
}

Table locations_table(const ReferenceLocations& reference) {
  Table table{.name = "locations", .title = "Reference locations", .header = {"log", "scan", "x", "y", "theta"}};
  for (const Location& location : reference.locations) {
    const Pose2 pose = reference.logs[location.log].map_from_sensor(location.scan);
    table.rows.push_back({reference.names[location.log], location.scan, pose.x, pose.y, pose.theta});
  }
  return table;
}

std::string level_label(ScanTransform transform) {
  switch (transform) {
    case ScanTransform::viewpoint:
      return "overlap with the reference (share of its points)";
    case ScanTransform::noise:
      return "radial noise σ (m)";
    case ScanTransform::subsampling:
      return "subsampling (one reading in …)";
    case ScanTransform::oversampling:
      return "oversampling (times)";
  }
  return "";
}

}  // namespace flirt::app
