#include "flight_table.hpp"

#include <fmt/format.h>

#include <cmath>

#include <pcor/base/atomic_file.hpp>
#include <pcor/base/message.hpp>

namespace pcor::tool {
namespace {

std::string escaped(const std::string& cell) {
  const std::string text = sanitize_line(cell);
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"') quoted += '"';
    quoted += letter;
  }
  return quoted + '"';
}

}  // namespace

void FlightTable::write(const std::string& path) const {
  std::string text;
  for (const std::vector<std::string>& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) text += (i == 0 ? "" : ",") + escaped(row[i]);
    text += "\r\n";
  }
  AtomicFile(path).write(text);
}

void add_table_option(CLI::App& command, std::string& table, const std::string& description) {
  command.add_option("--table", table, description)->check(is_file_name())->type_name("FILE.csv");
}

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{}", value) : std::string(); }

}  // namespace pcor::tool
