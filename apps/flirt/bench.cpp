// apps/flirt/bench.cpp: the family of `flirt bench` commands; each lives in a file of its name.
#include "apps/flirt/command.hpp"

namespace flirt::app {

void add_bench(CLI::App& program, Session& session) {
  CLI::App* bench = program.add_subcommand("bench", "Experiments with intervals: what a method reaches on a log.");
  bench->require_subcommand(1);
  bench->footer("Example: flirt bench localization fr079.log.gz --protocol revisit --every 3 -o results");
  add_bench_buildings(*bench, session);
  add_bench_detectors(*bench, session);
  add_bench_descriptors(*bench, session);
  add_bench_ablation(*bench, session);
  add_bench_arena(*bench, session);
  add_bench_localization(*bench, session);
  add_bench_tracking(*bench, session);
  add_bench_optimizers(*bench, session);
  add_bench_slam(*bench, session);
  add_bench_speed(*bench, session);
}

}  // namespace flirt::app
