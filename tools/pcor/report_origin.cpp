#include "report_origin.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <ctime>
#include <utility>

#include <pcor/base/utc.hpp>
#include <pcor/report/figures.hpp>
#include "communicator.hpp"
#include "processes.hpp"

namespace pcor::tool {
namespace {

std::string command_of_this_run;

FigureUse use_named(const std::string& name) {
  return name == "column" ? FigureUse::column : name == "slide" ? FigureUse::slide : FigureUse::page;
}

}  // namespace

void remember_command(int count, const char* const* words) {
  command_of_this_run = "pcor";
  for (const std::string& word : without_processes({words + 1, words + count}))
    command_of_this_run += " " + shell_quote(word);
}

bool wants_report(const CommonOptions& options) {
  return !options.report.empty() || !options.figures.empty();
}

void require_figures(const CommonOptions& options) {
  if (is_speaker() && !options.figures.empty()) pcor::require_figures(options.figures);
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
  if (!options.report.empty()) write_report(report, options.report);
  if (!options.figures.empty()) write_figures(report, options.figures, use_named(options.figures_for));
}

}  // namespace pcor::tool
