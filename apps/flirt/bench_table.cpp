#include "apps/flirt/bench_table.hpp"

#include "flirt/io/file.hpp"

#include "apps/flirt/command.hpp"

#include <fmt/format.h>

#include <cmath>

namespace flirt::app {
namespace {

std::string text_of(const nlohmann::ordered_json& cell) {
  if (cell.is_string()) { return cell.get<std::string>(); }
  if (cell.is_number_integer()) { return cell.dump(); }
  if (cell.is_number() && std::isfinite(cell.get<double>())) { return fmt::format("{:.4f}", cell.get<double>()); }
  return "";
}

std::string csv_text_of(const nlohmann::ordered_json& cell) {
  const std::string text = text_of(cell);
  return text.find(',') == std::string::npos ? text : '"' + text + '"';
}

bool starts_interval(const std::vector<std::string>& header, std::size_t i) {
  return i + 2 < header.size() && header[i + 1] == header[i] + "_low" && header[i + 2] == header[i] + "_high";
}

std::string spaced(std::string name) {
  for (char& c : name) { c = c == '_' ? ' ' : c; }
  return name;
}

std::string decimals(const nlohmann::ordered_json& cell) {
  return cell.is_number() && std::isfinite(cell.get<double>()) ? fmt::format("{:.3f}", cell.get<double>()) : "–";
}

}  // namespace

Cells cells_of(double value, Interval interval) {
  return {value, interval.low, interval.high};
}

Cells joined(std::initializer_list<Cells> parts) {
  Cells all;
  for (const Cells& part : parts) { all.insert(all.end(), part.begin(), part.end()); }
  return all;
}

std::string to_csv(const Table& table) {
  std::string csv = fmt::format("{}\n", fmt::join(table.header, ","));
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) { csv += (i == 0 ? "" : ",") + csv_text_of(row[i]); }
    csv += '\n';
  }
  return csv;
}

nlohmann::ordered_json to_json(const Table& table) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const auto& row : table.rows) {
    nlohmann::ordered_json object;
    for (std::size_t i = 0; i < row.size(); ++i) { object[table.header[i]] = row[i]; }
    rows.push_back(std::move(object));
  }
  return rows;
}

void add_table(HtmlReport& report, const Table& table) {
  report.heading(table.title);
  std::vector<std::string> header;
  for (std::size_t i = 0; i < table.header.size(); ++i) {
    header.push_back(spaced(table.header[i]));
    if (starts_interval(table.header, i)) {
      header.back() += " [95 %]";
      i += 2;
    }
  }
  std::vector<std::vector<std::string>> rows;
  for (const auto& cells : table.rows) {
    std::vector<std::string>& row = rows.emplace_back();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (!starts_interval(table.header, i)) {
        row.push_back(text_of(cells[i]));
        continue;
      }
      row.push_back(fmt::format("{} [{}, {}]", decimals(cells[i]), decimals(cells[i + 1]), decimals(cells[i + 2])));
      i += 2;
    }
  }
  report.table(header, rows);
}

void write_table(const std::filesystem::path& folder, const Table& table) {
  value_or_quit(write_file_atomically(folder / (table.name + ".csv"), to_csv(table)));
  value_or_quit(write_file_atomically(folder / (table.name + ".json"), json_text(to_json(table), 1)));
}

}  // namespace flirt::app
