#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <functional>
#include <new>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include <pcor/words/error.hpp>
#include <pcor/words/replacement_file.hpp>

#include "commands.hpp"
#include "crash.hpp"
#include "model_name.hpp"
#include "report_origin.hpp"
#include "text.hpp"
#include "usage.hpp"

namespace {

constexpr int work_not_done = 1;
constexpr int wrong_usage = 2;

/// Leaves nothing unfinished behind when the program is stopped.
extern "C" void stop(int signal) {
  pcor::remove_unfinished_files();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Reads the command line and does what it says. @return the exit status
int run(int argc, char** argv) {
  pcor::tool::remember_command(argc, argv);
  CLI::App program("Corrects the static and dynamic pressure that a research aircraft measures.", "pcor");
  program.set_version_flag("--version", "pcor " PCOR_VERSION, "print the version of the program");
  program.set_help_flag("-h,--help", "print this help");
  program.require_subcommand(1);
  program.footer(
      "delta-p: the correction, hPa, that is added to the static pressure and taken off the dynamic "
      "pressure.\n"
      "LAMS: the laser air-motion sensor, which measures the airspeed ahead of the aircraft.\n"
      "Further words: docs/glossary.md.\n\n"
      "Exit status: 0 done, 1 the work could not be done, 2 usage.");

  std::vector<std::function<void()>> runs;
  for (const auto add : pcor::tool::commands) runs.push_back(add(program));
  pcor::tool::take_models_by_name(program);

  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    program.parse(argc, argv);
    const std::string misplaced = pcor::tool::flights_behind_holdout(program, words);
    if (!misplaced.empty()) throw CLI::ArgumentMismatch(misplaced);
  } catch (const CLI::Success& help_or_version) {
    std::ostringstream text;
    program.exit(help_or_version, text, text);
    pcor::tool::say_text(text.str());
    return 0;
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "{}\n", pcor::tool::usage_message(program, error.what(), words));
    return wrong_usage;
  } catch (const pcor::Error& error) {
    fmt::print(stderr, "pcor: {}\n", error.what());
    return work_not_done;
  }

  const auto all = program.get_subcommands({});
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i]->parsed()) runs[i]();
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, stop);
  pcor::tool::explain_crashes();
  pcor::tool::set_program(argv[0]);
  try {
    const int status = run(argc, argv);
    pcor::tool::finish_text();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      throw pcor::Error("standard output: cannot be written; check the space where it goes");
    }
    return status;
  } catch (const pcor::Error& error) {
    fmt::print(stderr, "pcor: {}\n", error.what());
    return work_not_done;
  } catch (const std::system_error& error) {
    // fmt::print throws it where the text does not go out.
    fmt::print(stderr, "pcor: standard output: {}; check the space where it goes\n", error.code().message());
    return work_not_done;
  } catch (const std::bad_alloc&) {
    fmt::print(
        stderr,
        "pcor: the memory is exhausted; give fewer or shorter flights at a time, or a machine with more\n");
    return work_not_done;
  } catch (const std::exception& error) {
    fmt::print(stderr, "pcor: a fault of the program itself, please report it: {}\n", error.what());
    return work_not_done;
  }
}
