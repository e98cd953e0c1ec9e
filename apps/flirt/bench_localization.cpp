// apps/flirt/bench_localization.cpp: `flirt bench localization`, single scans found in the map of the rest of their
// log.
#include "flirt/eval/distractors.hpp"
#include "flirt/eval/localization.hpp"
#include "flirt/eval/localization_ablation.hpp"
#include "flirt/io/feature_params_json.hpp"
#include "flirt/io/file.hpp"
#include "flirt/map/place_map.hpp"

#include "apps/flirt/command.hpp"
#include "apps/flirt/feature_flags.hpp"
#include "apps/flirt/localization_outputs.hpp"
#include "apps/flirt/localize_flags.hpp"
#include "apps/flirt/posed_log.hpp"
#include "apps/flirt/tracking_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace flirt::app {
namespace {

struct BenchLocalizationOptions {
  std::string log;
  std::string poses;  ///< trajectory to take instead of the log's
  std::string out;
  std::string protocol{"paper"};
  FeatureFlags features;
  LocalizeFlags localize;
  std::vector<std::string> distractors;
  bool ablation{false};
  std::vector<std::string> variants;
  LocalizationBenchParams bench;
  ParamFlags params;
};

/// The variants that were asked for, `full` always first.
std::vector<LocalizationVariant> variants_of(const BenchLocalizationOptions& options) {
  std::vector<LocalizationVariant> variants = localization_variants(options.bench.localize);
  if (options.variants.empty()) { return variants; }
  std::vector<LocalizationVariant> asked{variants.front()};
  for (const std::string& name : options.variants) {
    const auto found = std::ranges::find(variants, name, &LocalizationVariant::name);
    if (found == variants.end()) {
      std::string names;
      for (const LocalizationVariant& variant : variants) { names += fmt::format(" {}", variant.name); }
      throw UsageError(fmt::format("--variants: expected some of{}, found '{}'", names, name));
    }
    if (found != variants.begin()) { asked.push_back(*found); }
  }
  return asked;
}

void write_files(const std::filesystem::path& out, const LocalizationRun& run, const ScanLog& log,
                 const nlohmann::ordered_json& json) {
  value_or_quit(write_file_atomically(out / "queries.csv", queries_csv(run)));
  if (run.bench.revisit) { value_or_quit(write_file_atomically(out / "evidence.csv", evidence_csv(run))); }
  value_or_quit(write_file_atomically(out / "localization.json", json_text(json)));
  value_or_quit(write_file_atomically(out / "localization.svg", localization_curves(run)));
  value_or_quit(write_file_atomically(out / "report.html", localization_page(run, log)));
}

int run(BenchLocalizationOptions& options, const Session& session) {
  options.params.resolve(session, {"ransac"});
  options.bench.seed = session.seed;
  options.bench.localize = options.localize.localize();
  options.bench.protocol = options.protocol == "revisit" ? LocalizationProtocol::revisit : LocalizationProtocol::paper;
  if (options.protocol != "revisit" && (options.ablation || !options.distractors.empty())) {
    throw UsageError("--distractors, --ablation: expected with --protocol revisit");
  }
  if (const std::uint32_t least = options.bench.localize.papers.ransac.min_inliers;
      options.protocol == "paper" && least > paper_n_min) {
    throw UsageError(
        fmt::format("--ransac-min-inliers: expected up to {} with --protocol paper, found {}", paper_n_min, least));
  }
  const std::vector<LocalizationVariant> variants =
      options.ablation ? variants_of(options) : std::vector<LocalizationVariant>{};
  const bool joins = options.bench.join > 1;
  if (joins && (options.protocol != "revisit" || options.bench.localize.method == LocalizeMethod::papers)) {
    throw UsageError("--join: expected --protocol revisit and a --method other than papers with it");
  }
  const ScanLog log = joins ? log_to_track(options.log, session, options.poses)
                            : read_posed_log(options.log, options.poses, session).log;
  std::vector<LoadedLog> others;
  others.reserve(options.distractors.size());
  for (const std::string& other : options.distractors) { others.push_back(value_or_quit(read_log(other))); }
  const PlaceMap map = value_or_quit(
      build_place_map(log, options.features.features(), session.threads, progress_bar(session, "features"),
                      variances_for(options.bench.localize.papers.match.distance)),
      options.log);
  LocalizationRun done{.log = options.log,
                       .poses = options.poses,
                       .protocol = options.protocol,
                       .method = options.localize.method(),
                       .every = options.bench.every,
                       .join = options.bench.join,
                       .feature_params = json_from_feature_params(map.feature_params()),
                       .params = options.params.json()};
  done.bench = bench_localization(log, map, options.bench, session.threads, progress_bar(session, "localizing"));
  for (std::size_t i = 0; i < others.size(); ++i) {
    done.distractors.push_back(
        {options.distractors[i], ask_distractors(others[i].log, map, options.bench.every, options.bench.localize,
                                                 session.threads, progress_bar(session, "distractors"))});
  }
  if (options.ablation) {
    done.ablation =
        ablate_localization(log, map, options.bench, variants, session.threads, progress_bar(session, "ablation"));
  }
  const nlohmann::ordered_json json = localization_json(done, session);
  if (!options.out.empty()) { write_files(value_or_quit(folder_for_results(options.out)), done, log, json); }
  write_json(session, json);
  if (session.talks()) {
    fmt::print("{}", localization_text(done));
    if (options.ablation) { fmt::print("\n{}", ablation_text(done)); }
  }
  return exit_done;
}

}  // namespace

void add_bench_localization(CLI::App& bench, Session& session) {
  auto options = std::make_shared<BenchLocalizationOptions>();
  const auto add_options = [options](CLI::App& command) {
    command.add_option("LOG", options->log, "log with corrected poses (they are the truth)")->required();
    command.add_option("--poses", options->poses, poses_flag_help);
    command
        .add_option("--protocol", options->protocol,
                    "paper: only the query leaves the map; revisit: 10 m of travel around it (default paper)")
        ->check(CLI::IsMember({"paper", "revisit"}));
    command.add_option("--every", options->bench.every, "query every K-th scan (default 1)")
        ->check(CLI::Range(1, 1000000));
    command
        .add_option("--join", options->bench.join,
                    "revisit: ask for each scan together with those before it, N in all, by odometry (default 1)")
        ->check(CLI::Range(1, 1000));
    command.add_option(
        "--distractors", options->distractors,
        "with revisit: log of another building, of which every K-th scan is asked, too; may be repeated");
    command.add_flag("--ablation", options->ablation,
                     "with revisit: run again without each ingredient, with a paired test against all of them");
    command.add_option("--variants", options->variants, "with --ablation: only these, separated by commas")
        ->delimiter(',')
        ->needs("--ablation");
    command.add_option("-o,--output", options->out,
                       "folder for localization.json, queries.csv, evidence.csv, localization.svg and report.html");
    options->features.add(command, options->params);
    options->localize.add(command, options->params);
  };
  CLI::App* command =
      add_command(bench, session, "localization", "Find single scans of a log in the map of its other scans.",
                  "flirt bench localization fr079.log.gz --protocol revisit --every 3 -o results", add_options);
  session.on(command, [&session, options] { return run(*options, session); });
}

}  // namespace flirt::app
