#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <new>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include <pcor/base/atomic_file.hpp>
#include <pcor/base/error.hpp>
#include <pcor/base/message.hpp>

#include "program.hpp"

#include "commands.hpp"
#include "communicator.hpp"
#include "crash.hpp"
#include "events.hpp"
#include "model_name.hpp"
#include "report_origin.hpp"
#include "text.hpp"
#include "usage.hpp"

namespace pcor::tool {
namespace {

constexpr int work_not_done = 1;
constexpr int wrong_usage = 2;

/// Removes unfinished files when the program is stopped.
extern "C" void stop(int signal) {
  pcor::remove_unfinished_files();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void mind_signals() {
  // Signals ignored by the caller, as by nohup, remain ignored.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGALRM, SIGXCPU, SIGUSR1, SIGUSR2})
    if (std::signal(signal, stop) == SIG_IGN) std::signal(signal, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // the write fails with an error instead
}

/// Opens closed standard streams: otherwise the first opened file would take their number, and receive their
/// output.
void fill_closed_streams() {
  while (true) {
    // A read-only descriptor makes writes fail: output to closed streams is discarded.
    const int descriptor = open("/dev/null", O_RDONLY);
    if (descriptor > STDERR_FILENO) close(descriptor);
    if (descriptor < 0 || descriptor > STDERR_FILENO) return;
  }
}

/// Standard output of a run is printed by the first rank, for all.
void print_nothing() {
  const int nowhere = open("/dev/null", O_WRONLY);
  if (nowhere < 0) return;
  dup2(nowhere, STDOUT_FILENO);
  close(nowhere);
}

/// @throws CLI::ArgumentMismatch if a command does not distribute its work over processes
void require_parallel_command(const CLI::App& program) {
  const std::string name = program.get_subcommands().front()->get_name();
  if (comm().size() == 1 ||
      std::find(parallel_commands.begin(), parallel_commands.end(), name) != parallel_commands.end())
    return;
  throw CLI::ArgumentMismatch(
      fmt::format("several processes are supported by {} only; run pcor {} as one process, or flight by "
                  "flight as described in docs/campaigns.md",
                  fmt::join(parallel_commands, ", "), name));
}

/// @throws Error if the ranks were given different commands
void require_one_command(const std::vector<std::string>& words) {
  comm().all_gather("", std::hash<std::string>()(fmt::format("{}", fmt::join(words, "\n"))));
}

/// Parses the command line and runs it. @return the exit status
int run(int argc, char** argv) {
  remember_command(argc, argv);
  CLI::App program("Corrects the static and dynamic pressure that a research aircraft measures.", "pcor");
  program.set_version_flag("--version", "pcor " PCOR_VERSION, "print the version of the program");
  program.set_help_flag("-h,--help", "print this help");
  program.require_subcommand(1);
  program.footer(
      "delta-p: the correction, hPa, that is added to the static pressure and subtracted from the dynamic "
      "pressure.\nLAMS: the laser air-motion sensor, which measures the airspeed ahead of the "
      "aircraft.\nFurther terms: docs/glossary.md.\n\nExit status: 0 done, 2 the command line cannot be "
      "parsed, 1 any other failure.");

  std::vector<std::function<void()>> runs;
  for (const auto add : commands) runs.push_back(add(program));
  take_models_by_name(program);

  std::vector<std::string> words(argv + 1, argv + argc);
  // "help X" and "--help X" as "X --help".
  if (!words.empty() && (words[0] == "help" || words[0] == "--help" || words[0] == "-h")) {
    words.erase(words.begin());
    words.emplace_back("--help");
  }
  require_one_command(words);
  try {
    program.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    const std::string misplaced = flights_behind_holdout(program, words);
    if (!misplaced.empty()) throw CLI::ArgumentMismatch(misplaced);
    require_parallel_command(program);
  } catch (const CLI::Success& help_or_version) {
    if (program.get_subcommands().empty() && words.front()[0] != '-') {
      print_error(usage_message(program, "", words));
      return wrong_usage;
    }
    std::ostringstream text;
    program.exit(help_or_version, text, text);
    std::string printed = text.str();
    // A hidden group of options leaves a second empty line.
    for (std::size_t at = 0; (at = printed.find("\n\n\n")) != std::string::npos;) printed.erase(at, 1);
    print_text(printed);
    return 0;
  } catch (const CLI::ParseError& error) {
    print_error(usage_message(program, error.what(), words));
    return wrong_usage;
  }

  const auto all = program.get_subcommands({});
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i]->parsed()) runs[i]();
  }
  return 0;
}

/// Whether the process must end at once, without the exit handlers.
bool is_final(const Error& error) {
  return error.code() == Error::Code::output || error.code() == Error::Code::file;
}

/// Ends the work after an error on this rank or on another one.
Ending failed(const Error& error, bool at_once) {
  // Output is flushed before other ranks learn of the end.
  flush_text();
  std::fflush(stdout);
  const Error of_all = comm().finalize(error).value_or(error);
  print_error(fmt::format("pcor: {}", of_all.what()));
  send_error(sanitize_line(of_all.what()), to_string(of_all.code()));
  // HDF5 may keep unwritten data after any error, and would try to write it at exit.
  return {work_not_done, at_once || is_final(of_all) || comm().size() == 1};
}

}  // namespace

Ending run_program(int argc, char** argv, Communicator& comm) {
  mind_signals();
  const CrashesExplained explained;
  fill_closed_streams();
  set_communicator(comm);
  if (!is_speaker()) print_nothing();
  try {
    set_program(argv[0]);
    const int status = run(argc, argv);
    flush_text();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      throw Error(Error::Code::output,
                  "standard output: cannot be written; check the space at its destination");
    if (const auto error = comm.finalize()) return failed(*error, false);
    return {status};
  } catch (const Error& error) {
    return failed(error, false);
  } catch (const std::filesystem::filesystem_error& error) {
    return failed(Error(Error::Code::system, fmt::format("{}: {}; check this path and its permissions",
                                                         error.path1().string(), error.code().message())),
                  false);
  } catch (const std::system_error& error) {
    // Exception of fmt::print if the output fails.
    return failed(
        Error(Error::Code::output,
              fmt::format("standard output: {}; check the space at its destination", error.code().message())),
        false);
  } catch (const std::bad_alloc&) {
    return failed(
        Error(Error::Code::system,
              "the memory is exhausted; give fewer or shorter flights, or use a machine with more memory"),
        true);
  } catch (const std::exception& error) {
    return failed(
        Error(Error::Code::system, fmt::format("internal error, please report it: {}", error.what())), false);
  }
}

void end_process(const Ending& ending) {
  if (!ending.at_once) std::exit(ending.status);
  std::fflush(nullptr);
  std::_Exit(ending.status);
}

}  // namespace pcor::tool
