// apps/flirt/bench_slam_tables.hpp: the results of `flirt bench slam` as text, CSV and JSON.
#pragma once

#include "apps/flirt/bench_slam_run.hpp"

#include <string>
#include <vector>

namespace flirt::app {

/// All runs on one log.
struct SlamTable {
  SlamInput input;
  std::vector<SlamRow> rows;
};

/// Cells of a table: header and rows.
struct TextTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};
/// In columns.
std::string plain_text(const TextTable& table);

TextTable runs_table(const SlamTable& table);

/// Table 2 of the navigation paper (relations, translation and turn) beside its printed numbers. The three columns of
/// the paper are its filter, and its graph with the two front ends; the own column follows.
TextTable paper_table(const std::vector<SlamTable>& tables);

TextTable starts_table(const std::vector<JitteredStarts>& starts);

std::string runs_csv(const std::vector<SlamTable>& tables);
nlohmann::ordered_json runs_json(const std::vector<SlamTable>& tables);
nlohmann::ordered_json starts_json(const std::vector<JitteredStarts>& starts);

}  // namespace flirt::app
