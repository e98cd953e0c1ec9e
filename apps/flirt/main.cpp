// apps/flirt/main.cpp: the program flirt; each subcommand lives in a file of its name.
#include "apps/flirt/command.hpp"
#include "flirt_version.hpp"

#include <cstdio>
#include <exception>
#include <new>

namespace {

/// The code, unless what was printed did not arrive.
int after_printing(int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) { return code; }
  std::fprintf(stderr, "flirt: stdout: expected to print, found it full or closed\n");
  return flirt::app::exit_bad_input;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace flirt::app;  // NOLINT(google-build-using-namespace): every second word here is from there
  CLI::App program{"Interest regions for 2D laser scans: matching, localization, mapping.", "flirt"};
  program.set_version_flag("--version", "flirt " FLIRT_VERSION " (" FLIRT_COMMIT ")");
  program.require_subcommand(1);
  program.get_formatter()->column_width(44);
  Session session;
  try {
    add_info(program, session);
    add_detect(program, session);
    add_match(program, session);
    add_map(program, session);
    add_localize(program, session);
    add_slam(program, session);
    add_simulate(program, session);
    add_evaluate(program, session);
    add_convert(program, session);
    add_bench(program, session);
    program.parse(argc, argv);
    return after_printing(session.run());
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? exit_done : exit_usage;
  } catch (const UsageError& error) {
    std::fprintf(stderr, "flirt: %s\n", error.what());
    return exit_usage;
  } catch (const BadInput& error) {
    std::fprintf(stderr, "flirt: %s\n", error.what());
    return exit_bad_input;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "flirt: internal error: not enough memory\n");
    return exit_internal;
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) { return after_printing(exit_internal); }  // fmt::print throws
    std::fprintf(stderr, "flirt: internal error: %s\n", error.what());
    return exit_internal;
  }
}
