#pragma once

#include <string>
#include <vector>

namespace pcor::tool {

/// A table with a row for each flight, for a spreadsheet: comma-separated values (RFC 4180), the first row
/// the names of the columns. A number that there is not is an empty cell.
class FlightTable {
 public:
  explicit FlightTable(std::vector<std::string> columns) : rows_{std::move(columns)} {}

  /// @param cells as many as there are columns
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

  /// Writes the file, whole or not at all. @throws Error if it cannot be written.
  void write(const std::string& path) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// A number as a cell, with the digits that restore it; empty for NaN.
std::string cell(double value);

}  // namespace pcor::tool
