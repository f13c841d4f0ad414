#pragma once

#include <string>
#include <utility>
#include <vector>

#include "command.hpp"

namespace pcor::tool {

/// Table with a row for each flight, for a spreadsheet: comma-separated values (RFC 4180), the first row the
/// names of the columns. A missing number is an empty cell.
class FlightTable {
 public:
  explicit FlightTable(std::vector<std::string> columns) : rows_{std::move(columns)} {}

  /// @param cells one per column
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

  /// Writes the file atomically. @throws Error if it cannot be written.
  void write(const std::string& path) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// Adds the option --table, the file of such a table.
void add_table_option(CLI::App& command, std::string& table, const std::string& description);

/// Number as a cell, with enough digits to restore it; empty for NaN.
std::string cell(double value);

}  // namespace pcor::tool
