// apps/flirt/convert.cpp: `flirt convert`, between the formats of logs, trajectories and graphs.
#include "flirt/io/carmen.hpp"
#include "flirt/io/format.hpp"
#include "flirt/io/g2o.hpp"
#include "flirt/io/log.hpp"
#include "flirt/io/toro_graph.hpp"
#include "flirt/io/tum.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/reading_flags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace flirt::app {
namespace {

struct ConvertOptions {
  std::string in;
  std::string out;
  std::string to;
  ReadingFlags reading{};
};

/// All that a file of any format may hold.
struct Content {
  FileFormat format{FileFormat::carmen};
  std::optional<ScanLog> log{};
  std::vector<StampedPose> trajectory{};
  std::optional<GraphFile> graph{};
  std::vector<std::string> lost{};  ///< what the new file does not say, one sentence each
};

void lose(Content& content, bool is_there, const std::string& what) {
  if (is_there) { content.lost.push_back(what); }
}

void lose_lines(Content& content, const LineCounts& skipped, std::string_view unit = "line") {
  std::string list;
  for (const auto& [kind, n] : skipped) { list += fmt::format("{}{} {}", list.empty() ? "" : ", ", n, kind); }
  lose(content, !list.empty(), fmt::format("{}s that were not read: {}", unit, list));
}

void read_scans(const ConvertOptions& options, const Session& session, Content& content) {
  LoadedLog loaded = value_or_quit(read_log(options.in, options.reading.options(), progress_bar(session, "reading")));
  LineCounts skipped = loaded.report.lines_skipped;
  if (skipped.contains("EDGE2") && skipped.contains("VERTEX2")) {
    content.graph = value_or_quit(read_toro_graph(options.in));
    skipped.erase("EDGE2");
  }
  skipped.erase("VERTEX2");  // repeats the poses of the scans
  content.trajectory = trajectory_of(loaded.log);
  content.log = std::move(loaded.log);
  lose_lines(content, skipped, loaded.report.unit);
  lose(content, loaded.report.broken_lines > 0,
       fmt::format("{}s that are broken: {}", loaded.report.unit, loaded.report.broken_lines));
}

Content read(const ConvertOptions& options, const Session& session) {
  Content content{.format = value_or_quit(format_of(options.in))};
  const bool is_log = content.format == FileFormat::carmen || content.format == FileFormat::ros;
  if (!is_log && options.reading.are_given()) {
    throw UsageError("--lenient, --message, --range-max: expected a log, found a " +
                     std::string(to_string(content.format)) + " file");
  }
  switch (content.format) {
    case FileFormat::carmen:
    case FileFormat::ros:
      read_scans(options, session, content);
      break;
    case FileFormat::tum:
      content.trajectory = value_or_quit(read_tum(options.in));
      break;
    case FileFormat::g2o:
      content.graph = value_or_quit(read_g2o(options.in));
      break;
    case FileFormat::toro:
      content.graph = value_or_quit(read_toro_graph(options.in));
      break;
  }
  if (!content.log && content.graph) { lose_lines(content, content.graph->lines_skipped); }
  return content;
}

FileFormat target(const ConvertOptions& options) {
  for (const auto& [format, name] : enum_names(FileFormat{})) {
    if (options.to == name) { return format; }
  }
  const auto format = format_by_name(options.out);
  if (!format) {
    throw UsageError(options.out + ": expected a name that ends in .log, .tum, .g2o or .graph, or --to FORMAT");
  }
  return *format;
}

/// A graph of the poses alone: measured from one to the next.
GraphFile graph_of(Content& content) {
  GraphFile file;
  for (const auto& [stamp, pose] : content.trajectory) {
    file.id.push_back(static_cast<std::int64_t>(file.id.size()));
    file.graph.map_from_node.push_back(pose);
  }
  const auto odometry = [&](std::size_t i) {
    return content.log ? content.log->scans[i].odom_from_robot : std::optional<Pose2>();
  };
  bool by_odometry = false;
  for (std::uint32_t i = 0; i + 1 < file.id.size(); ++i) {
    PoseEdge edge{.a = i, .b = i + 1};
    const bool has_odometry = odometry(i) && odometry(i + 1);
    by_odometry = by_odometry || has_odometry;
    edge.a_from_b = has_odometry ? inverse(*odometry(i)) * *odometry(i + 1)
                                 : inverse(file.graph.map_from_node[i]) * file.graph.map_from_node[i + 1];
    file.graph.edges.push_back(edge);
  }
  content.lost.push_back(fmt::format("the edges are made up: the {} from pose to pose, with unit information",
                                     by_odometry ? "odometry" : "motion"));
  return file;
}

bool is_numbered_from_0(const GraphFile& file) {
  return file.id.front() == 0 && file.id.back() + 1 == static_cast<std::int64_t>(file.id.size());
}

void write_graph(const ConvertOptions& options, FileFormat to, Content& content) {
  if (!content.graph && content.trajectory.empty()) {
    throw BadInput(options.in + ": expected poses, found none: a graph needs them");
  }
  lose(content, content.log.has_value(), "scans");
  lose(content, !content.trajectory.empty(), "stamps");
  if (!content.graph) { content.graph = graph_of(content); }
  const GraphFile& file = *content.graph;
  lose(content, !is_numbered_from_0(file), "the numbers of the vertices: they count from 0 now");
  if (to == FileFormat::toro) {
    lose(content, !file.fixed.empty(), "which vertices are fixed");
    value_or_quit(write_toro_graph(options.out, file.graph));
  } else {
    value_or_quit(write_g2o(options.out, file.graph, file.fixed));
  }
}

void write_trajectory(const ConvertOptions& options, Content& content) {
  if (content.graph && !content.log) {
    for (std::size_t i = 0; i < content.graph->id.size(); ++i) {
      content.trajectory.push_back({static_cast<double>(content.graph->id[i]), content.graph->graph.map_from_node[i]});
    }
    content.lost.emplace_back("edges; the stamps are the numbers of the vertices");
  }
  if (content.trajectory.empty()) { throw BadInput(options.in + ": expected a log with poses, found none"); }
  lose(content, content.log.has_value(), "scans");
  if (content.log) {
    const auto has_other_odometry = [&](std::size_t i) {
      const auto& odometry = content.log->scans[i].odom_from_robot;
      return odometry && *odometry != content.log->map_from_robot[i];
    };
    bool is_lost = false;
    for (std::size_t i = 0; i < content.log->scans.size(); ++i) { is_lost = is_lost || has_other_odometry(i); }
    lose(content, is_lost, "odometry");
    lose(content, content.graph.has_value(), "the graph's edges");
  }
  value_or_quit(write_tum(options.out, content.trajectory));
}

void write_log(const ConvertOptions& options, Content& content) {
  if (!content.log) {
    throw BadInput(
        fmt::format("{}: expected a log, found a {} file, which has no scans", options.in, to_string(content.format)));
  }
  lose(content, content.graph.has_value(), "the graph's edges");
  const auto has_range_min = [](const Scan& scan) { return scan.beams.range_min > 0; };
  lose(content, std::any_of(content.log->scans.begin(), content.log->scans.end(), has_range_min),
       "the shortest valid range");
  const auto has_odometry = [](const Scan& scan) { return scan.odom_from_robot.has_value(); };
  const auto scans = static_cast<std::ptrdiff_t>(content.log->scans.size());
  const std::ptrdiff_t with = std::ranges::count_if(content.log->scans, has_odometry);
  lose(content, with > 0 && with < scans, fmt::format("the odometry, which only {} of {} scans have", with, scans));
  if (auto written = write_carmen(options.out, *content.log); !written) { throw BadInput(written.error().message); }
}

int run(const ConvertOptions& options, const Session& session) {
  ParamFlags().resolve(session);  // no key of a file is known here
  const FileFormat to = target(options);
  Content content = read(options, session);
  switch (to) {
    case FileFormat::carmen:
      write_log(options, content);
      break;
    case FileFormat::ros:
      throw UsageError("a recording of ROS is read, never written");
    case FileFormat::tum:
      write_trajectory(options, content);
      break;
    case FileFormat::g2o:
    case FileFormat::toro:
      write_graph(options, to, content);
      break;
  }
  const std::size_t poses =
      content.trajectory.empty() && content.graph ? content.graph->id.size() : content.trajectory.size();
  nlohmann::ordered_json json{{"in", options.in},
                              {"from", to_string(content.format)},
                              {"out", options.out},
                              {"to", to_string(to)},
                              {"scans", content.log ? content.log->scans.size() : 0},
                              {"poses", poses},
                              {"edges", content.graph ? content.graph->graph.edges.size() : 0},
                              {"lost", content.lost}};
  json.update(provenance());
  write_json(session, json);
  if (session.talks()) {
    fmt::print("{} ({}) -> {} ({}): {} poses\n", options.in, to_string(content.format), options.out, to_string(to),
               poses);
    for (const std::string& what : content.lost) { fmt::print("  not in the new file: {}\n", what); }
  }
  return exit_done;
}

}  // namespace

void add_convert(CLI::App& program, Session& session) {
  auto options = std::make_shared<ConvertOptions>();
  const auto add_options = [options](CLI::App& command) {
    command
        .add_option("IN", options->in,
                    "file to read, plain or gzip, or folder of a ROS 2 recording; the format is told from the content")
        ->required();
    command.add_option("OUT", options->out, "file to write: .log, .clf, .carmen; .tum; .g2o; .graph, .toro")
        ->required();
    command.add_option("--to", options->to, "format to write, whatever the name: carmen, tum, g2o, toro")
        ->check(CLI::IsMember({"carmen", "tum", "g2o", "toro"}));
    options->reading.add_to(command);
  };
  CLI::App* command =
      add_command(program, session, "convert",
                  "From recordings of ROS, and between CARMEN logs, TUM trajectories and pose graphs (g2o, TORO).",
                  "flirt convert flirtlib-fr079.log.gz fr079.g2o", add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
