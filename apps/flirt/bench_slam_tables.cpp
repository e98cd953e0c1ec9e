#include "apps/flirt/bench_slam_tables.hpp"

#include "apps/flirt/error_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace flirt::app {
namespace {

/// Table 2 as printed: mean ± deviation, m and degrees.
struct PrintedRow {
  std::string_view log;
  std::array<std::string_view, 3> translation;
  std::array<std::string_view, 3> rotation;
};
constexpr std::array<std::string_view, 3> paper_methods{"rbpf", "olson", "flirt"};
constexpr std::array<std::string_view, 3> paper_names{"RBPF", "Graph Olson", "Graph FLIRT"};
constexpr std::array<PrintedRow, 2> printed{
    {{"fr079", {".06 ± .04", ".06 ± .04", ".06 ± .09"}, {".6 ± .6", ".6 ± .6", ".8 ± 1.1"}},
     {"intel", {".07 ± .08", ".03 ± .03", ".02 ± .02"}, {"3.0 ± 5.3", "1.3 ± 4.7", ".3 ± .3"}}}};

/// Of a method's runs the one with odometry, else the one without.
const SlamRow* row_of(const SlamTable& table, std::string_view method) {
  const SlamRow* found = nullptr;
  for (const SlamRow& row : table.rows) {
    if (row.method == method && (found == nullptr || row.odometry != "none")) { found = &row; }
  }
  return found;
}

std::string mean_and_deviation(const ErrorSummary& error, int digits) {
  return fmt::format("{:.{}f} ± {:.{}f}", error.mean, digits, error.deviation, digits);
}

enum class RelationPart : std::uint8_t { translation, rotation };

std::string relation_text(const SlamRow* row, RelationPart part) {
  if (row == nullptr || !row->relations || row->relations->difference.translation.count == 0) { return "-"; }
  const TrajectoryError& error = row->relations->difference;
  return part == RelationPart::translation ? mean_and_deviation(error.translation, 3)
                                           : mean_and_deviation(error.rotation_degrees, 2);
}

std::string name_of(RelationPart part) {
  return part == RelationPart::translation ? "way, m" : "turn, deg";
}

const PrintedRow* printed_for(const std::string& log) {
  const auto found = std::ranges::find_if(printed, [&](const PrintedRow& row) { return log.starts_with(row.log); });
  return found == printed.end() ? nullptr : &*found;
}

std::vector<std::string> printed_cells(const PrintedRow& row, RelationPart part) {
  std::vector<std::string> cells{std::string(row.log), "printed", name_of(part)};
  const auto& values = part == RelationPart::translation ? row.translation : row.rotation;
  cells.insert(cells.end(), values.begin(), values.end());
  return cells;
}

std::vector<std::string> found_cells(const SlamTable& table, RelationPart part) {
  std::vector<std::string> cells{table.input.name, "here", name_of(part)};
  const auto official = [&](std::string_view method) {
    const SlamRow* row = row_of(table, method);
    return row != nullptr && row->relations_source == "official" ? relation_text(row, part) : "-";
  };
  for (const std::string_view method : paper_methods) { cells.push_back(official(method)); }
  cells.push_back(official("auto"));
  return cells;
}

std::vector<std::string> row_cells(const SlamRow& row) {
  const std::string none = "-";
  std::vector<std::string> cells{row.method, row.odometry};
  cells.push_back(row.ate ? fmt::format("{:.3f}", row.ate->translation.rmse) : none);
  cells.push_back(row.rpe && row.rpe->translation.count > 0 ? fmt::format("{:.4f}", row.rpe->translation.rmse) : none);
  cells.push_back(relation_text(&row, RelationPart::translation));
  cells.push_back(relation_text(&row, RelationPart::rotation));
  if (row.relations && row.relations_source == "derived") { cells.back() += " derived"; }
  cells.push_back(row.quality.pairs > 0 ? fmt::format("{:.4f}", row.quality.point_to_line_rms) : none);
  cells.push_back(std::to_string(row.quality.occupied_cells));
  cells.push_back(row.closures ? fmt::format("{} / {}", row.closures->accepted, row.closures->wrong) : none);
  cells.push_back(row.mapped ? fmt::format("{:.2f}", row.cpu_seconds) : none);
  cells.push_back(row.mapped ? fmt::format("{:.1f}", row.latency.worst) : none);
  cells.push_back(row.mapped ? fmt::format("{:.0f}", row.memory_mb) : none);
  return cells;
}

/// Characters, not bytes: "±" is one.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

nlohmann::ordered_json row_json(const SlamRow& row) {
  nlohmann::ordered_json json{{"method", row.method}, {"odometry", row.odometry}};
  if (row.ate) { json["ate"] = error_json(*row.ate); }
  if (row.rpe) { json["rpe"] = error_json(*row.rpe); }
  if (row.relations) { json["relations"] = relations_json(*row.relations, row.relations_source); }
  json["quality"] = quality_json(row.quality);
  if (row.closures) { json["closures"] = {{"accepted", row.closures->accepted}, {"wrong", row.closures->wrong}}; }
  if (!row.mapped) { return json; }
  json["cpu_seconds"] = row.cpu_seconds;
  json["latency_ms"] = {{"median", row.latency.median}, {"p99", row.latency.p99}, {"worst", row.latency.worst}};
  json["peak_memory_mb"] = row.memory_mb;
  return json;
}

}  // namespace

std::string plain_text(const TextTable& table) {
  std::vector<std::size_t> widths;
  const auto widen = [&](const std::vector<std::string>& cells) {
    widths.resize(std::max(widths.size(), cells.size()), 0);
    for (std::size_t i = 0; i < cells.size(); ++i) { widths[i] = std::max(widths[i], width_of(cells[i])); }
  };
  widen(table.header);
  for (const auto& row : table.rows) { widen(row); }
  std::string text;
  const auto add = [&](const std::vector<std::string>& cells) {
    text += ' ';
    for (std::size_t i = 0; i < cells.size(); ++i) {
      text += ' ' + cells[i];
      if (i + 1 < cells.size()) { text.append(widths[i] - width_of(cells[i]) + 1, ' '); }
    }
    text += '\n';
  };
  add(table.header);
  for (const auto& row : table.rows) { add(row); }
  return text;
}

TextTable runs_table(const SlamTable& table) {
  TextTable text{.header = {"method", "odometry", "ATE m", "RPE m", "relations m", "deg", "point-line m", "cells",
                            "loop edges / wrong", "CPU s", "worst ms", "MB"},
                 .rows = {}};
  for (const SlamRow& row : table.rows) { text.rows.push_back(row_cells(row)); }
  return text;
}

TextTable paper_table(const std::vector<SlamTable>& tables) {
  TextTable text{.header = {"log", "", "error"}, .rows = {}};
  text.header.insert(text.header.end(), paper_names.begin(), paper_names.end());
  text.header.emplace_back("auto");
  for (const SlamTable& table : tables) {
    if (table.input.relations.empty()) { continue; }
    for (const RelationPart part : {RelationPart::translation, RelationPart::rotation}) {
      if (const PrintedRow* row = printed_for(table.input.name)) { text.rows.push_back(printed_cells(*row, part)); }
      text.rows.push_back(found_cells(table, part));
    }
  }
  return text;
}

TextTable starts_table(const std::vector<JitteredStarts>& starts) {
  TextTable text{.header = {"log", "method", "starts", "within the bound", "bound m", "ATE least", "median", "worst"},
                 .rows = {}};
  for (const JitteredStarts& run : starts) {
    std::vector<double> ate = run.ate;
    std::ranges::sort(ate);
    text.rows.push_back({run.name, run.method, std::to_string(ate.size()), std::to_string(run.kept),
                         fmt::format("{:.3f}", run.bound), fmt::format("{:.3f}", ate.front()),
                         fmt::format("{:.3f}", ate[ate.size() / 2]), fmt::format("{:.3f}", ate.back())});
  }
  return text;
}

std::string runs_csv(const std::vector<SlamTable>& tables) {
  std::string csv =
      "log,method,odometry,ate_m,relations,relations_m,relations_m_sd,relations_deg,relations_deg_sd,point_to_line_m,"
      "occupied_cells,loop_edges,wrong,cpu_s,median_ms,p99_ms,worst_ms,peak_mb,rpe_m,relations_source\n";
  for (const SlamTable& table : tables) {
    for (const SlamRow& row : table.rows) {
      csv += fmt::format("{},{},{},{},", table.input.name, row.method, row.odometry,
                         row.ate ? fmt::format("{:.5f}", row.ate->translation.rmse) : "");
      const bool has_relations = row.relations && row.relations->difference.translation.count > 0;
      if (has_relations) {
        const ErrorSummary& way = row.relations->difference.translation;
        const ErrorSummary& turn = row.relations->difference.rotation_degrees;
        csv += fmt::format("{},{:.5f},{:.5f},{:.4f},{:.4f},", way.count, way.mean, way.deviation, turn.mean,
                           turn.deviation);
      } else {
        csv += ",,,,,";
      }
      csv += fmt::format("{},{},", row.quality.pairs > 0 ? fmt::format("{:.5f}", row.quality.point_to_line_rms) : "",
                         row.quality.occupied_cells);
      csv += row.closures ? fmt::format("{},{},", row.closures->accepted, row.closures->wrong) : ",,";
      csv += row.mapped ? fmt::format("{:.3f},{:.3f},{:.3f},{:.3f},{:.1f},", row.cpu_seconds, row.latency.median,
                                      row.latency.p99, row.latency.worst, row.memory_mb)
                        : ",,,,,";
      csv += fmt::format(
          "{},{}\n", row.rpe && row.rpe->translation.count > 0 ? fmt::format("{:.5f}", row.rpe->translation.rmse) : "",
          has_relations ? row.relations_source : "");
    }
  }
  return csv;
}

nlohmann::ordered_json runs_json(const std::vector<SlamTable>& tables) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const SlamTable& table : tables) {
    nlohmann::ordered_json log{{"name", table.input.name},
                               {"log", table.input.file},
                               {"scans", table.input.log.scans.size()},
                               {"odometry", table.input.odometry},
                               {"runs", nlohmann::ordered_json::array()}};
    for (const SlamRow& row : table.rows) { log["runs"].push_back(row_json(row)); }
    json.push_back(std::move(log));
  }
  return json;
}

nlohmann::ordered_json starts_json(const std::vector<JitteredStarts>& starts) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const JitteredStarts& run : starts) {
    json.push_back(
        {{"name", run.name}, {"method", run.method}, {"bound_m", run.bound}, {"within", run.kept}, {"ate_m", run.ate}});
  }
  return json;
}

}  // namespace flirt::app
