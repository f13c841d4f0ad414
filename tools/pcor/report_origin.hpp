#pragma once

#include <string>
#include <vector>

#include <pcor/report/report.hpp>
#include "command.hpp"

namespace pcor::tool {

/// Stores the command line of this run for `write_report_of_run`.
void remember_command(int count, const char* const* words);

/// Prints the steps, each on a line: "To apply it: pcor process ...".
void print_next_steps(const std::vector<NextStep>& steps);

/// Input files of a report, and the next steps.
struct ReportFiles {
  std::vector<std::string> models{};
  std::vector<std::string> flights{};  ///< fitted or compared with a model
  std::vector<std::string> held_out{};
  std::vector<NextStep> next{};
};

/// Writes the report named by the options, with its provenance at the foot: the command, the date, the
/// program, and the files. @throws Error as does `write_report`.
void write_report_of_run(Report report, const ReportFiles& files, const CommonOptions& options);

}  // namespace pcor::tool
