// apps/flirt/bench_table.hpp: tables of experiments, the same in CSV, JSON and HTML.
#pragma once

#include "flirt/eval/bootstrap.hpp"
#include "flirt/report/html.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

namespace flirt::app {

/// Cells are texts or numbers. Columns `x`, `x_low`, `x_high` in a row are a value with its 95 % interval.
struct Table {
  std::string name{};   ///< of its files
  std::string title{};  ///< for people
  std::vector<std::string> header{};
  std::vector<std::vector<nlohmann::ordered_json>> rows{};
};

using Cells = std::vector<nlohmann::ordered_json>;

/// value, low, high: three cells.
[[nodiscard]] Cells cells_of(double value, Interval interval);
/// All cells one after the other.
[[nodiscard]] Cells joined(std::initializer_list<Cells> parts);

/// Numbers with four decimals, texts in quotes where they hold a comma.
[[nodiscard]] std::string to_csv(const Table& table);
/// A list of objects, one per row.
[[nodiscard]] nlohmann::ordered_json to_json(const Table& table);
/// With a heading; a value and its interval share a cell.
void add_table(HtmlReport& report, const Table& table);

/// DIR/NAME.csv and DIR/NAME.json. Throws BadInput.
void write_table(const std::filesystem::path& folder, const Table& table);

}  // namespace flirt::app
