#pragma once

#include <string>
#include <vector>

#include <pcor/report/report.hpp>
#include "command.hpp"

namespace pcor::tool {

/// Keeps the command line of this run for `write_report_of_run`.
void remember_command(int count, const char* const* words);

/// Which files a report is of.
struct ReportFiles {
  std::vector<std::string> models{};
  std::vector<std::string> flights{};  ///< to which a model was fitted, or that it was held against
  std::vector<std::string> held_out{};
};

/// Whether a report is asked for, be it as a page or as figures.
bool wants_report(const CommonOptions& options);

/// Makes sure, before the work, that the figures that are asked for can be made. @throws Error if they
/// cannot.
void require_figures(const CommonOptions& options);

/// Writes a report whose foot says how it came to be: the command, the date, the program, and the files; as a
/// page, as figures, or both, as the options say.
/// @throws Error as `write_report` and `write_figures`.
void write_report_of_run(Report report, const ReportFiles& files, const CommonOptions& options);

}  // namespace pcor::tool
