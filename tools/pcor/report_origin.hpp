#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pcor/report/report.hpp>

namespace pcor::tool {

/// Keeps the command line of this run for `write_report_of_run`.
void remember_command(int count, const char* const* words);

/// Which files a report is of.
struct ReportFiles {
  std::vector<std::string> models{};
  std::vector<std::string> flights{};  ///< to which a model was fitted, or that it was held against
  std::vector<std::string> held_out{};
};

/// Writes a report whose foot says how it came to be: the command, the date, the program, and the files.
/// @throws Error as `write_report`.
void write_report_of_run(Report report, const ReportFiles& files, const std::filesystem::path& path);

}  // namespace pcor::tool
