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
#include <pcor/base/error_code.hpp>
#include <pcor/base/message.hpp>
#include <pcor/parallel/fork_communicator.hpp>

#include "program.hpp"

#include "commands.hpp"
#include "communicator.hpp"
#include "crash.hpp"
#include "events.hpp"
#include "model_name.hpp"
#include "processes.hpp"
#include "report_origin.hpp"
#include "text.hpp"
#include "usage.hpp"

namespace pcor::tool {
namespace {

constexpr int work_not_done = 1;
constexpr int wrong_usage = 2;

/// Leaves nothing unfinished behind when the program is stopped.
extern "C" void stop(int signal) {
  pcor::remove_unfinished_files();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void mind_signals() {
  // A signal that the caller has ignored, as nohup does, stays so.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGALRM, SIGXCPU, SIGUSR1, SIGUSR2})
    if (std::signal(signal, stop) == SIG_IGN) std::signal(signal, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // the write fails, and says why
}

/// Where a standard stream is closed, the first file that is opened would take its place, and what
/// is said there.
void fill_closed_streams() {
  while (true) {
    // Nothing can be written to standard output so: what is said there is missed.
    const int place = open("/dev/null", O_RDONLY);
    if (place > STDERR_FILENO) close(place);
    if (place < 0 || place > STDERR_FILENO) return;
  }
}

/// What is printed on standard output comes from the first of a team, for all.
void print_nothing() {
  const int nowhere = open("/dev/null", O_WRONLY);
  if (nowhere < 0) return;
  dup2(nowhere, STDOUT_FILENO);
  close(nowhere);
}

/// @throws CLI::ArgumentMismatch if several processes would all do the whole work of a command
void require_parallel_command(const CLI::App& program) {
  const std::string name = program.get_subcommands().front()->get_name();
  if (comm().size() == 1 ||
      std::find(parallel_commands.begin(), parallel_commands.end(), name) != parallel_commands.end())
    return;
  throw CLI::ArgumentMismatch(fmt::format(
      "several processes work together on {} only; run pcor {} as one process, or flight by flight as "
      "docs/campaigns.md says",
      fmt::join(parallel_commands, ", "), name));
}

/// @throws Error if the processes of the team were given different commands
void require_one_command(const std::vector<std::string>& words) {
  comm().gather("", std::hash<std::string>()(fmt::format("{}", fmt::join(words, "\n"))));
}

/// Reads the command line and does what it says. @return the exit status
int run(int argc, char** argv) {
  remember_command(argc, argv);
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
  for (const auto add : commands) runs.push_back(add(program));
  take_models_by_name(program);

  const std::vector<std::string> words(argv + 1, argv + argc);
  require_one_command(words);
  try {
    program.parse(argc, argv);
    const std::string misplaced = flights_behind_holdout(program, words);
    if (!misplaced.empty()) throw CLI::ArgumentMismatch(misplaced);
    require_parallel_command(program);
  } catch (const CLI::Success& help_or_version) {
    std::ostringstream text;
    program.exit(help_or_version, text, text);
    say_text(text.str());
    return 0;
  } catch (const CLI::ParseError& error) {
    tell(usage_message(program, error.what(), words));
    return wrong_usage;
  }

  const auto all = program.get_subcommands({});
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i]->parsed()) runs[i]();
  }
  return 0;
}

/// Whether nothing more is to be done, not even at the exit.
bool is_final(const Error& error) {
  return error.code() == Error::Code::output || error.code() == Error::Code::file;
}

/// Ends the work that failed here, or with another member of the team.
Ending failed(const Error& error, bool at_once) {
  // What was said goes out before others know that this is the end.
  finish_text();
  std::fflush(stdout);
  const Error of_all = comm().leave(error).value_or(error);
  if (*of_all.what() != '\0') tell(fmt::format("pcor: {}", of_all.what()));
  send_event({{"error", sanitize_line(of_all.what())}, {"code", to_string(of_all.code())}});
  // HDF5 may hold what it could not write, whatever the refusal was: it would try once more at the exit.
  return {work_not_done, at_once || is_final(of_all) || comm().size() == 1};
}

}  // namespace

Ending run_program(int argc, char** argv) {
  fill_closed_streams();  // before there are connections of processes, which would take their places
  std::signal(SIGCHLD, SIG_DFL);
  try {
    ForkCommunicator comm(processes_to_begin({argv + 1, argv + argc}));
    return run_program(argc, argv, comm, comm.rank() == 0 ? work_not_done : ForkCommunicator::has_told);
  } catch (const Error& error) {
    tell(fmt::format("pcor: {}", error.what()));
    return {work_not_done};
  }
}

Ending run_program(int argc, char** argv, Communicator& comm, int status_of_crash) {
  mind_signals();
  const CrashesExplained explained(status_of_crash);
  fill_closed_streams();
  set_communicator(comm);
  if (!is_speaker()) print_nothing();
  try {
    set_program(argv[0]);
    const int status = run(argc, argv);
    finish_text();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      throw Error("standard output: cannot be written; check the space where it goes");
    if (const auto error = comm.leave()) return failed(*error, false);
    return {status};
  } catch (const Error& error) {
    return failed(error, false);
  } catch (const std::filesystem::filesystem_error& error) {
    return failed(Error(fmt::format("{}: {}; check this path and its permissions", error.path1().string(),
                                    error.code().message())),
                  false);
  } catch (const std::system_error& error) {
    // fmt::print throws it where the text does not go out.
    return failed(
        Error(fmt::format("standard output: {}; check the space where it goes", error.code().message())),
        false);
  } catch (const std::bad_alloc&) {
    return failed(
        Error("the memory is exhausted; give fewer or shorter flights at a time, or a machine with more"),
        true);
  } catch (const std::exception& error) {
    return failed(Error(fmt::format("a fault of the program itself, please report it: {}", error.what())),
                  false);
  }
}

void end_process(const Ending& ending) {
  if (!ending.at_once) std::exit(ending.status);
  std::fflush(nullptr);
  std::_Exit(ending.status);
}

}  // namespace pcor::tool
