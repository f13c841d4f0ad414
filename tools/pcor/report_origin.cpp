#include "report_origin.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <ctime>
#include <utility>

#include <pcor/base/utc.hpp>
#include "communicator.hpp"

namespace pcor::tool {
namespace {

std::string command_of_this_run;

}  // namespace

void remember_command(int count, const char* const* words) {
  command_of_this_run = "pcor";
  for (int i = 1; i < count; ++i) command_of_this_run += " " + shell_quote(words[i]);
}

void print_next_steps(const std::vector<NextStep>& steps) {
  for (const NextStep& step : steps)
    print_formatted("{}{}{}\n", step.text, step.command.empty() ? "" : ": ", step.command);
}

void write_report_of_run(Report report, const ReportFiles& files, const CommonOptions& options) {
  report.next = files.next;
  report.origin.emplace_back("Command", command_of_this_run);
  report.origin.emplace_back(
      "Made", utc_text(static_cast<double>(std::time(nullptr)), "%Y-%m-%d %H:%M UTC by pcor " PCOR_VERSION));
  const auto add = [&report](const char* name, const std::vector<std::string>& paths) {
    if (!paths.empty()) report.origin.emplace_back(name, fmt::format("{}", fmt::join(paths, ", ")));
  };
  add(files.models.size() > 1 ? "Model files" : "Model file", files.models);
  add(files.held_out.empty() ? "Flights" : "Fitted flights", files.flights);
  add("Held-out flights", files.held_out);
  add("Choices", choices_of_this_run());
  write_report(report, options.report);
}

}  // namespace pcor::tool
