// apps/flirt/command.hpp: what all subcommands share: common options, parameter flags, JSON output, progress, errors.
//
// A subcommand is one file with one function, declared below and called by main():
//
//   void add_info(CLI::App& program, Session& session) {
//     auto options = std::make_shared<InfoOptions>();
//     const auto add_options = [options](CLI::App& command) {
//       command.add_option("LOG", options->log, "log file")->required();
//       options->params.add(command, "ransac", options->ransac);     // --ransac-inlier-distance and so on
//     };
//     CLI::App* command = add_command(program, session, "info", "What a log holds.", "flirt info a.log", add_options);
//     session.on(command, [&session, options] { options->params.resolve(session); ...; return exit_done; });
//   }
//
// Commands that make features use feature_flags.hpp for --detector, --descriptor and their parameters.
#pragma once

#include "flirt/core/parallel.hpp"
#include "flirt/core/result.hpp"

#include "apps/flirt/param_flags.hpp"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>

namespace flirt::app {

enum ExitCode : int { exit_done = 0, exit_usage = 1, exit_bad_input = 2, exit_internal = 3, exit_not_found = 4 };

/// Ends the command with exit code 2; the message is FILE:LINE: what was expected, what was found.
struct BadInput : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// Ends the command with exit code 1.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The value, or the end of the command with its error; `file`: what the error is about, where it does not say so.
template <class T>
T value_or_quit(Result<T> result, const std::string& file = {}) {
  if (!result) { throw BadInput((file.empty() ? "" : file + ": ") + result.error().message); }
  if constexpr (!std::is_void_v<T>) { return std::move(*result); }
}

/// Options that every subcommand has, and what main() runs after parsing.
struct Session {
  std::string json;    ///< file for the machine-readable result, "-" = stdout, empty = none
  std::string config;  ///< TOML file with parameters
  std::size_t threads{0};
  std::uint64_t seed{0};
  bool is_seed_given{false};  ///< by --seed
  bool quiet{false};
  std::function<int()> run;

  /// `action` runs after parsing when `command` was the one asked for; it returns an exit code.
  void on(CLI::App* command, std::function<int()> action) {
    command->final_callback([this, action = std::move(action)] { run = action; });
  }
  [[nodiscard]] bool json_on_stdout() const { return json == "-"; }
  /// Prints for people go to stdout unless it carries the JSON or --quiet was given.
  [[nodiscard]] bool talks() const { return !quiet && !json_on_stdout(); }
};

/// A subcommand with the common options and those of `add_options`, made only when the command line names it: making
/// all takes long. `example` closes its help.
CLI::App* add_command(CLI::App& program, Session& session, const std::string& name, const std::string& description,
                      const std::string& example, std::function<void(CLI::App&)> add_options);

/// As all results are written: an end of line after it, and bytes that are no UTF-8 (in names of files) replaced.
std::string json_text(const nlohmann::ordered_json& json, int indent = 2);

/// Checks for numbers of at least 0, and above it: CLI11's own name the end of the range in 309 digits.
std::string expect_at_least_0(const std::string& text);
std::string expect_above_0(const std::string& text);

/// Writes `result` where --json says (file: atomically), two-space indented; nothing without --json.
void write_json(const Session& session, const nlohmann::ordered_json& result);
/// The same for text that is already formatted, for example JSON lines.
void write_json_text(const Session& session, const std::string& text);

/// The folder for results, made if need be.
Result<std::filesystem::path> folder_for_results(const std::string& folder);

/// A bar on stderr when it is a terminal, not --quiet, and the work takes more than a second; else silent.
Progress progress_bar(const Session& session, const std::string& label);

/// What a stage took, µs; null where it did not run.
nlohmann::ordered_json stage_json(double us);

/// Version, commit and processor, as results carry them: {version, commit, cpu}.
nlohmann::ordered_json provenance();

void add_info(CLI::App& program, Session& session);
void add_detect(CLI::App& program, Session& session);
void add_match(CLI::App& program, Session& session);
void add_map(CLI::App& program, Session& session);
void add_localize(CLI::App& program, Session& session);
void add_slam(CLI::App& program, Session& session);
void add_simulate(CLI::App& program, Session& session);
void add_evaluate(CLI::App& program, Session& session);
void add_convert(CLI::App& program, Session& session);
void add_bench(CLI::App& program, Session& session);
void add_bench_buildings(CLI::App& bench, Session& session);
void add_bench_localization(CLI::App& bench, Session& session);
void add_bench_tracking(CLI::App& bench, Session& session);
void add_bench_optimizers(CLI::App& bench, Session& session);
void add_bench_slam(CLI::App& bench, Session& session);
void add_bench_detectors(CLI::App& bench, Session& session);
void add_bench_descriptors(CLI::App& bench, Session& session);
void add_bench_ablation(CLI::App& bench, Session& session);
void add_bench_arena(CLI::App& bench, Session& session);
void add_bench_speed(CLI::App& bench, Session& session);

}  // namespace flirt::app
