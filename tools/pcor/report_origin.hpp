#pragma once

#include <string>
#include <vector>

#include <pcor/report/report.hpp>
#include "command.hpp"

namespace pcor::tool {

/// Stores the command line of this run for `write_report_of_run`.
void remember_command(int count, const char* const* words);

/// Input files of a report, and the next step.
struct ReportFiles {
  std::vector<std::string> models{};
  std::vector<std::string> flights{};  ///< fitted or compared with a model
  std::vector<std::string> held_out{};
  std::string next{};  ///< "To apply it: pcor process ..."; may be empty
};

/// Whether a report is requested, as a page or as figures.
bool wants_report(const CommonOptions& options);

/// Checks, before the work, that the requested figures can be made. @throws Error if they cannot.
void require_figures(const CommonOptions& options);

/// Writes a report with its provenance at the foot: the command, the date, the program, and the files; as a
/// page, as figures, or both, as the options request.
/// @throws Error as do `write_report` and `write_figures`.
void write_report_of_run(Report report, const ReportFiles& files, const CommonOptions& options);

}  // namespace pcor::tool
