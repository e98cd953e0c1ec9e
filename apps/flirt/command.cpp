#include "apps/flirt/command.hpp"

#include "flirt/io/file.hpp"

#include "flirt_version.hpp"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <memory>

namespace flirt::app {
namespace {

/// Lets options that take numbers take nothing else: CLI11 reads -1 as 2^64 − 1, as all that is larger, and
/// nan as within every range.
void check_numbers(CLI::App& command) {
  const auto unsigned_number = [](const std::string& text) -> std::string {
    if (text.starts_with('-')) { return "expected a number of 0 or more, found " + text; }
    errno = 0;
    std::strtoull(text.c_str(), nullptr, 0);
    return errno == ERANGE ? "expected a number of up to 2^64 - 1, found " + text : "";
  };
  const auto finite = [](const std::string& text) {
    return std::isfinite(std::strtod(text.c_str(), nullptr)) ? "" : "expected a finite number, found " + text;
  };
  for (CLI::Option* option : command.get_options()) {
    if (option->get_type_name().starts_with("UINT")) { option->check(CLI::Validator(unsigned_number, "")); }
    if (option->get_type_name().starts_with("FLOAT")) { option->check(CLI::Validator(finite, "")); }
  }
}

}  // namespace

CLI::App* add_command(CLI::App& program, Session& session, const std::string& name, const std::string& description,
                      const std::string& example, std::function<void(CLI::App&)> add_options) {
  CLI::App* command = program.add_subcommand(name, description);
  command->footer("Example: " + example);
  command->preparse_callback([command, &session, add_options = std::move(add_options)](std::size_t /*arguments*/) {
    command->add_option("--json", session.json, "write the machine-readable result to this file, - for stdout");
    command->add_option("--config", session.config, "TOML file with parameters; flags win over it");
    command->add_option("--threads", session.threads, "threads, 0 for one per processor (default 0)")
        ->check(CLI::Range(0, 1024));
    command->add_option("--seed", session.seed, "seed of everything random (default 0)")
        ->each([&session](const std::string& /*text*/) { session.is_seed_given = true; });
    command->add_flag("--quiet", session.quiet, "print nothing but errors");
    add_options(*command);
    check_numbers(*command);
  });
  return command;
}

std::string expect_at_least_0(const std::string& text) {
  return std::strtod(text.c_str(), nullptr) < 0 ? "expected a number of 0 or more, found " + text : "";
}

std::string expect_above_0(const std::string& text) {
  return std::strtod(text.c_str(), nullptr) <= 0 ? "expected a number above 0, found " + text : "";
}

std::string json_text(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void write_json(const Session& session, const nlohmann::ordered_json& result) {
  write_json_text(session, json_text(result));
}

void write_json_text(const Session& session, const std::string& text) {
  if (session.json.empty()) { return; }
  if (session.json_on_stdout()) {
    std::cout << text << std::flush;
    if (!std::cout) { throw BadInput("stdout: expected to write the result, found it closed"); }
  } else {
    value_or_quit(write_file_atomically(session.json, text));
  }
}

Result<std::filesystem::path> folder_for_results(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) { return fail(folder + ": expected a folder to write to, found: " + error.message()); }
  return std::filesystem::path(folder);
}

Progress progress_bar(const Session& session, const std::string& label) {
  if (session.quiet || isatty(STDERR_FILENO) == 0) { return {}; }
  struct State {
    std::chrono::steady_clock::time_point start{std::chrono::steady_clock::now()};
    int shown{-1};
  };
  return [label, state = std::make_shared<State>()](double done) {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - state->start).count();
    const int percent = static_cast<int>(done * 100);
    if (seconds < 1.0 || percent == state->shown) { return; }
    state->shown = percent;
    const std::string bar(static_cast<std::size_t>(percent * 3 / 10), '#');
    std::fprintf(stderr, "\r%s [%-30s] %3d %%  %.0f s left ", label.c_str(), bar.c_str(), percent,
                 done > 0 ? seconds / done - seconds : 0.0);
    if (percent == 100) { std::fprintf(stderr, "\r\033[K"); }
  };
}

nlohmann::ordered_json stage_json(double us) {
  return us > 0 ? nlohmann::ordered_json(us) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json provenance() {
  std::string cpu = "unknown";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) {
      cpu = line.substr(line.find(':') + 2);
      break;
    }
  }
  return {{"version", FLIRT_VERSION}, {"commit", FLIRT_COMMIT}, {"cpu", cpu}};
}

}  // namespace flirt::app
