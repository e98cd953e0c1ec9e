// apps/flirt/bench_arena.cpp: `flirt bench arena`, ours and the rival methods in every combination on the same queries.
#include "flirt/eval/arena.hpp"
#include "flirt/io/file.hpp"
#include "flirt/io/log.hpp"
#include "flirt/io/svg.hpp"

#include "apps/flirt/bench_table.hpp"
#include "apps/flirt/command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>

namespace flirt::app {
namespace {

struct BenchArenaOptions {
  std::string log;
  std::string out;
  std::vector<std::string> detectors;
  std::vector<std::string> descriptors;
  std::vector<std::string> matchers;
  ArenaParams arena;
  ParamFlags params;
};

Cells rate_cells(const Rate& rate) {
  return cells_of(rate.value(), rate.wilson());
}

/// One line per contender, ours first.
Table contenders_table(const Arena& arena) {
  Table table{.name = "contenders",
              .title = "Every combination on the same queries",
              .header = {"detector", "descriptor", "matcher", "keypoints", "repeatability", "repeatability_low",
                         "repeatability_high", "average_precision"}};
  for (const ArenaProtocol protocol : arena_protocols) {
    for (const char* column :
         {"", "_low", "_high", "_by_inliers", "_recall_at_95", "_only_default", "_only_this", "_p"}) {
      table.header.push_back(std::string(to_string(protocol)) + column);
    }
  }
  table.header.insert(table.header.end(), {"detect_us", "describe_us", "match_us"});
  for (const ContenderResult& result : arena.contenders) {
    Cells row = joined({{result.detector, result.descriptor, result.matcher, result.keypoints},
                        rate_cells(result.repeatability),
                        {result.average_precision}});
    for (const ArenaProtocolResult& own : result.protocols) {
      row = joined({row,
                    rate_cells(own.by_residual),
                    {own.by_inliers.value(), own.recall_at_95, own.with_default.only_first,
                     own.with_default.only_second, own.with_default.p_value()}});
    }
    table.rows.push_back(joined({row, {result.times.detect_us, result.times.describe_us, result.times.match_us}}));
  }
  return table;
}

Table shortlists_table(const Arena& arena) {
  Table table{.name = "shortlists",
              .title = "GLAROT: a scan from within 0.5 m among the first",
              .header = {"detector", "protocol"}};
  for (const std::size_t length : shortlist_lengths) {
    for (const char* part : {"", "_low", "_high"}) { table.header.push_back(fmt::format("first_{}{}", length, part)); }
  }
  table.header.insert(table.header.end(), {"build_us", "compare_us"});
  for (const ShortlistResult& result : arena.shortlists) {
    for (const ArenaProtocol protocol : arena_protocols) {
      const auto& recall = result.recall[static_cast<std::size_t>(protocol)];
      table.rows.push_back(joined({{result.detector, to_string(protocol)},
                                   rate_cells(recall[0]),
                                   rate_cells(recall[1]),
                                   rate_cells(recall[2]),
                                   {result.build_us, result.compare_us}}));
    }
  }
  return table;
}

Table curves_table(const Arena& arena) {
  Table table{.name = "precision-recall",
              .title = "The match with most inliers, accepted from so many on",
              .header = {"detector", "descriptor", "matcher", "protocol", "inliers", "accepted", "right", "queries",
                         "precision", "recall"}};
  for (const ContenderResult& result : arena.contenders) {
    for (const ArenaProtocol protocol : arena_protocols) {
      for (const ArenaPoint& point : result.protocols[static_cast<std::size_t>(protocol)].curve) {
        table.rows.push_back({result.detector, result.descriptor, result.matcher, to_string(protocol), point.inliers,
                              point.precision.total, point.precision.hits, point.recall.total, point.precision.value(),
                              point.recall.value()});
      }
    }
  }
  return table;
}

/// Colour and marker tell the descriptor, the dash the matcher.
svg::SeriesStyle style_of(const ContenderResult& result) {
  const std::vector<NamedDescriptor> descriptors = all_descriptors();
  const auto found = std::ranges::find(descriptors, result.descriptor, &NamedDescriptor::name);
  svg::SeriesStyle style = svg::series_style(static_cast<std::size_t>(found - descriptors.begin()));
  style.dash = result.matcher == "ransac"   ? svg::Dash::solid
               : result.matcher == "clique" ? svg::Dash::dashed
                                            : svg::Dash::dotted;
  return style;
}

/// A panel per detector.
svg::Figure figure(const Arena& arena, ArenaProtocol protocol) {
  svg::Figure figure{
      .title = fmt::format("Precision and recall over the least number of inliers, protocol {}", to_string(protocol)),
      .columns = 2};
  for (const ShortlistResult& detector : arena.shortlists) {
    svg::Chart chart{.title = detector.detector,
                     .x = {.label = "recall", .low = 0.0, .high = 1.0},
                     .y = {.label = "precision", .low = 0.0, .high = 1.0}};
    for (const ContenderResult& result : arena.contenders) {
      if (result.detector != detector.detector) { continue; }
      svg::Series line{.legend = fmt::format("{}, {}", result.descriptor, result.matcher), .style = style_of(result)};
      for (const ArenaPoint& point : result.protocols[static_cast<std::size_t>(protocol)].curve) {
        if (point.precision.total == 0) { continue; }
        line.x.push_back(point.recall.value());
        line.y.push_back(point.precision.value());
      }
      chart.series.push_back(std::move(line));
    }
    figure.panels.emplace_back(std::move(chart));
  }
  return figure;
}

std::string introduction(const BenchArenaOptions& options, const Arena& arena) {
  return fmt::format(
      "{}: {} queries against {} scans; under “revisit” (10 m of travel around the query leave the map) {} of them "
      "can be answered. “paper” and “revisit” are right poses (0.5 m, 10°) of the match with the least residual, "
      "with Wilson's 95 % intervals; “only default” and “only this”: queries that one of the two got right, and p of "
      "McNemar's exact test. Recall at 95: the largest at a precision of 0.95 over the least number of inliers. "
      "Repeatability and average precision (nearest descriptor) are of the next scan in the log, all regions {} m. "
      "Times are CPU µs of one thread, a scan or a pair of scans. The last line is `flirt localize`: all beams against "
      "the evidence of all scans; its time is a query's over the number of scans.",
      options.log, arena.queries, arena.scans, arena.answerable, options.arena.common_radius);
}

nlohmann::ordered_json arena_json(const BenchArenaOptions& options, const Arena& arena, const Session& session) {
  nlohmann::ordered_json json{{"experiment", "arena"},
                              {"log", options.log},
                              {"every", options.arena.every},
                              {"queries", arena.queries},
                              {"answerable", arena.answerable},
                              {"scans", arena.scans},
                              {"contenders", to_json(contenders_table(arena))},
                              {"shortlists", to_json(shortlists_table(arena))},
                              {"params", options.params.json()},
                              {"seed", session.seed}};
  json.update(provenance());
  return json;
}

void write_all(const BenchArenaOptions& options, const Arena& arena, const nlohmann::ordered_json& json) {
  const std::filesystem::path out = value_or_quit(folder_for_results(options.out));
  HtmlReport page("The arena");
  page.paragraph(introduction(options, arena));
  add_table(page, contenders_table(arena));
  add_table(page, shortlists_table(arena));
  for (const ArenaProtocol protocol : arena_protocols) {
    const std::string drawing = svg::to_svg(figure(arena, protocol));
    value_or_quit(write_file_atomically(out / fmt::format("arena-{}.svg", to_string(protocol)), drawing));
    page.figure(drawing, fmt::format("Protocol {}.", to_string(protocol)));
  }
  for (const Table& table : {contenders_table(arena), shortlists_table(arena), curves_table(arena)}) {
    write_table(out, table);
  }
  value_or_quit(write_file_atomically(out / "arena.json", json_text(json, 1)));
  value_or_quit(write_file_atomically(out / "report.html", page.text()));
}

std::string with_interval(const Rate& rate) {
  const Interval interval = rate.wilson();
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", rate.value(), interval.low, interval.high);
}

void print(const Arena& arena) {
  fmt::print("{} queries, {} of them answerable under revisit, {} scans\n", arena.queries, arena.answerable,
             arena.scans);
  fmt::print("{:<13} {:<13} {:<6} {:>5} {:>6} {:>5}  {:<20} {:>7} {:>6}  {:<20} {:>7} {:>6} {:>8} {:>8} {:>8}\n",
             "detector", "descriptor", "match", "keyp.", "repeat", "a.p.", "paper, least resid.", "inliers", "p",
             "revisit", "inliers", "p", "detect", "describe", "us/pair");
  for (const ContenderResult& result : arena.contenders) {
    const auto& [paper, revisit] = result.protocols;
    fmt::print(
        "{:<13} {:<13} {:<6} {:>5.1f} {:>6.3f} {:>5.3f}  {} {:>7.3f} {:>6.4f}  {} {:>7.3f} {:>6.4f} {:>8.1f} "
        "{:>8.1f} {:>8.2f}\n",
        result.detector, result.descriptor, result.matcher, result.keypoints, result.repeatability.value(),
        result.average_precision, with_interval(paper.by_residual), paper.by_inliers.value(),
        paper.with_default.p_value(), with_interval(revisit.by_residual), revisit.by_inliers.value(),
        revisit.with_default.p_value(), result.times.detect_us, result.times.describe_us, result.times.match_us);
  }
  fmt::print("\nGLAROT: a scan from within 0.5 m among the first 1, 10, 100\n");
  for (const ShortlistResult& result : arena.shortlists) {
    for (const ArenaProtocol protocol : arena_protocols) {
      const auto& recall = result.recall[static_cast<std::size_t>(protocol)];
      fmt::print("  {:<13} {:<7} {:.3f} {:.3f} {:.3f}   build {:.1f} us, compare {:.2f} us\n", result.detector,
                 to_string(protocol), recall[0].value(), recall[1].value(), recall[2].value(), result.build_us,
                 result.compare_us);
    }
  }
}

int run(BenchArenaOptions& options, const Session& session) {
  options.params.resolve(session, {"ransac"});
  const LoadedLog loaded = value_or_quit(read_log(options.log, {}, progress_bar(session, "reading")));
  if (loaded.log.map_from_robot.empty()) {
    throw BadInput(options.log + ": expected a log with poses (they are the truth), found none");
  }
  const std::vector<Contender> list = contenders(options.detectors, options.descriptors, options.matchers);
  const Arena arena = value_or_quit(
      bench_arena(loaded.log, list, options.arena, session.threads, progress_bar(session, "arena")), options.log);
  const nlohmann::ordered_json json = arena_json(options, arena, session);
  if (!options.out.empty()) { write_all(options, arena, json); }
  write_json(session, json);
  if (session.talks()) { print(arena); }
  return exit_done;
}

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& list) {
  std::vector<std::string> names;
  names.reserve(list.size());
  for (const Named& named : list) { names.push_back(named.name); }
  return names;
}

}  // namespace

void add_bench_arena(CLI::App& bench, Session& session) {
  auto options = std::make_shared<BenchArenaOptions>();
  const auto add_options = [options](CLI::App& command) {
    command.add_option("LOG", options->log, "log with corrected poses")->required();
    command.add_option("--every", options->arena.every, "query every K-th scan (default 1)")
        ->check(CLI::Range(1, 1000000));
    std::vector<std::string> descriptors = names_of(all_descriptors());
    descriptors.emplace_back("none");
    const auto add_list = [&](const char* flag, std::vector<std::string>& chosen,
                              const std::vector<std::string>& names) {
      command.add_option(flag, chosen, fmt::format("some of {} (default all)", fmt::join(names, ",")))
          ->delimiter(',')
          ->check(CLI::IsMember(names));
    };
    add_list("--detectors", options->detectors, names_of(all_detectors()));
    add_list("--descriptors", options->descriptors, descriptors);
    add_list("--matchers", options->matchers, {"ransac", "clique", "hough"});
    command.add_option("-o,--output", options->out,
                       "folder for report.html, arena.json, tables (CSV, JSON) and figures (SVG)");
    options->params.add(command, "ransac", options->arena.matchers.ransac);
    options->params.add(command, "clique", options->arena.matchers.clique);
    options->params.add(command, "hough", options->arena.matchers.hough);
    options->params.add(command, "glarot", options->arena.glarot);
  };
  CLI::App* command =
      add_command(bench, session, "arena",
                  "Ours and rival detectors, descriptors and matchers in every combination, in both "
                  "localization protocols.",
                  "flirt bench arena aces.log.gz --every 10 --detectors curvature,falko -o results", add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
