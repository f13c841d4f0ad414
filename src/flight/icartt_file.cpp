#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include "base/quoting.hpp"
#include "flight/flight_file.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr int series_over_time = 1001;  // the file format index
// Characters of a name in a comment "NAME: value", which becomes an attribute of a netCDF output.
constexpr auto name_characters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> fields;
  for (std::size_t from = 0; from <= line.size();) {
    const std::size_t to = std::min(line.find(',', from), line.size());
    fields.push_back(trimmed(line.substr(from, to - from)));
    from = to + 1;
  }
  return fields;
}

/// The number that a text is; empty for any other text.
std::optional<double> number_in(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return text.empty() || *end != '\0' ? std::nullopt : std::optional(value);
}

/// The length of the header and the file format index, of the first line; empty for another kind of line.
std::optional<std::pair<int, int>> first_line_of(const std::string& line) {
  int length = 0;
  int index = 0;
  char more = 0;
  const int found = std::sscanf(line.c_str(), " %6d , %6d%c", &length, &index, &more);
  const bool ends = found == 2 || (found == 3 && (more == ',' || more == ' ' || more == '\r'));
  return ends && length > 12 && index >= 1001 && index < 10000 ? std::optional(std::pair(length, index))
                                                               : std::nullopt;
}

/// A text file of the ICARTT conventions, file format index 1001: one independent variable, the time, and
/// series over it. All of it is in memory.
///
/// The independent variable is called Time; its unit has the date of the header, from whose midnight it
/// counts. Missing values, and those below or above the limits of detection, are NaN; scale factors are
/// applied. The header's lines and its "NAME: value" comments are attributes: institution, source, project,
/// platform.
class IcarttFile final : public FlightFile {
 public:
  /// @throws Error "path:line: what is wrong; what to do"
  explicit IcarttFile(std::filesystem::path path);

  const std::filesystem::path& path() const override { return path_; }
  int variable_count() const override { return static_cast<int>(variables_.size()); }
  std::string variable_name(int variable) const override { return at(variable).name; }
  std::vector<int> dimensions_of(int /*variable*/) const override { return {0}; }
  std::string dimension_name(int /*dimension*/) const override { return "Time"; }
  std::size_t dimension_length(int /*dimension*/) const override { return variables_.front().values.size(); }
  std::vector<std::string> attribute_names(int variable) const override {
    return names_of(attributes_of(variable), &Attributes::value_type::first);
  }
  std::string text_attribute(int variable, const std::string& name) const override {
    for (const auto& [key, value] : attributes_of(variable)) {
      if (key == name) return value;
    }
    return {};
  }
  std::vector<double> number_attribute(int variable, const std::string& name) const override {
    const std::optional<double> value = number_in(text_attribute(variable, name));
    return value ? std::vector<double>{*value} : std::vector<double>();
  }
  Notes notes() const override { return notes_; }
  void read(int variable, RecordBlock records, double* out) const override {
    const std::vector<double>& values = at(variable).values;
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(records.first), records.count, out);
  }

 private:
  using Attributes = std::vector<std::pair<std::string, std::string>>;

  struct Variable {
    std::string name;
    Attributes attributes{};
    double scale = 1.0;
    std::vector<double> missing{};  ///< flags of missing values
    std::vector<double> values{};
  };

  class Reader;

  const Variable& at(int variable) const { return variables_.at(static_cast<std::size_t>(variable)); }
  const Attributes& attributes_of(int variable) const {
    return variable == whole_file ? attributes_ : at(variable).attributes;
  }

  std::filesystem::path path_;
  Attributes attributes_;
  std::vector<Variable> variables_;  // the time first
  Notes notes_{};
};

/// Reads line after line.
class IcarttFile::Reader {
 public:
  explicit Reader(IcarttFile& file) : file_(file), stream_(file.path_, std::ios::binary) {}

  void run() {
    const auto first = first_line_of(next());
    if (!first) fail("this is not the first line of an ICARTT file");
    if (first->second != series_over_time)
      fail(fmt::format("the file format index is {}, and pcor reads 1001, series over time; convert the file",
                       first->second));
    put("institution", next(2));
    put("source", next());
    put("project", next());
    next();  // volumes
    const std::string date = date_of(next());
    next();  // interval
    Variable& time = file_.variables_.emplace_back(Variable{"Time"});
    const std::vector<std::string> independent = fields_of(next());
    time.attributes = {{"units", fmt::format("seconds since {} 00:00:00 +0000", date)},
                       {"long_name", independent.front()}};
    time.missing = {-9999.0, -99999.0};
    read_names(count());
    read_comments();
    if (line_ != first->first)
      fail(fmt::format("the header has {} lines, but {} according to its first line", line_, first->first));
    read_values();
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw Error(Error::Code::file,
                fmt::format("{}:{}: {}; correct it, or fetch the file again from its source",
                            file_.path_.string(), line_, why));
  }

  /// The next line, or one further on.
  std::string next(int lines = 1) {
    std::string line;
    for (; lines > 0; --lines) {
      ++line_;
      if (!std::getline(stream_, line)) fail("the header ends too early");
    }
    return trimmed(line);
  }

  double number(const std::string& text) const {
    const std::optional<double> value = number_in(text);
    if (!value) fail(fmt::format("{} is not a number", quote(text)));
    return *value;
  }

  int count() {
    const double value = number(next());
    if (!(value >= 0.0 && value < 100'000.0)) fail("a number of lines is required here");
    return static_cast<int>(value);
  }

  std::vector<double> numbers(int requested) {
    std::vector<double> all;
    while (static_cast<int>(all.size()) < requested) {
      for (const std::string& field : fields_of(next())) all.push_back(number(field));
    }
    if (static_cast<int>(all.size()) > requested)
      fail(
          fmt::format("{} numbers are given here, but {} are required, one for each variable except the time",
                      all.size(), requested));
    return all;
  }

  void put(const std::string& name, const std::string& value) {
    if (!value.empty() && value != "N/A") file_.attributes_.emplace_back(name, value);
  }

  std::string date_of(const std::string& line) const {
    int year = 0;
    int month = 0;
    int day = 0;
    if (std::sscanf(line.c_str(), "%4d%*[ ,]%2d%*[ ,]%2d", &year, &month, &day) != 3)
      fail("the date of the data is required here, as 2018,11,04");
    return fmt::format("{:04}-{:02}-{:02}", year, month, day);
  }

  void read_names(int variables) {
    const std::vector<double> scales = numbers(variables);
    const std::vector<double> missing = numbers(variables);
    for (int i = 0; i < variables; ++i) {
      const std::vector<std::string> fields = fields_of(next());
      Variable& variable = file_.variables_.emplace_back(Variable{fields[0]});
      if (fields.size() > 1) variable.attributes.emplace_back("units", fields[1]);
      if (fields.size() > 2 && !fields[2].empty()) variable.attributes.emplace_back("icartt_name", fields[2]);
      if (fields.size() > 3 && !fields[3].empty()) variable.attributes.emplace_back("long_name", fields[3]);
      variable.scale = scales[static_cast<std::size_t>(i)];
      if (!std::isfinite(variable.scale) || variable.scale == 0.0)
        fail(fmt::format("the scale factor of {} is not a number other than 0", quote(variable.name)));
      variable.missing = {missing[static_cast<std::size_t>(i)]};
    }
  }

  void read_comments() {
    for (int special = count(); special > 0; --special) next();
    const int normal = count();
    for (int i = 0; i < normal; ++i) {
      const std::string line = next();
      const std::size_t colon = line.find_first_not_of(name_characters);
      if (colon == std::string::npos || colon == 0 || line[colon] != ':' || line[0] == '_') continue;
      const std::string name = line.substr(0, colon);
      const std::string value = trimmed(line.substr(colon + 1));
      put(name, value);
      if (name != "LLOD_FLAG" && name != "ULOD_FLAG") continue;
      // One number for all, or one for each; "N/A" and similar words mean no limit.
      for (const std::string& field : fields_of(value)) {
        const std::optional<double> flag = number_in(field);
        if (!flag) continue;
        for (Variable& variable : file_.variables_) {
          if (&variable != &file_.variables_.front()) variable.missing.push_back(*flag);
        }
      }
    }
  }

  /// How a file writes its last field: the characters behind the point, or all of them without a point.
  static std::pair<bool, std::size_t> format_of(const std::string& field) {
    const std::size_t point = field.find('.');
    return {point != std::string::npos, field.size() - (point == std::string::npos ? 0 : point)};
  }

  void read_values() {
    std::set<std::pair<bool, std::size_t>> formats;  // last fields that have a value
    for (std::string line; std::getline(stream_, line);) {
      ++line_;
      const char* at = line.c_str();
      if (trimmed(line).empty()) continue;
      const std::string last = trimmed(std::string_view(line).substr(line.rfind(',') + 1));
      // A last line without an end may lack digits too, unless it ends as all others do.
      if (stream_.eof()) {
        const bool has_all =
            fields_of(line).size() == file_.variables_.size() && formats == std::set{format_of(last)};
        if (!has_all) {
          file_.notes_.push_back(fmt::format(
              "line {} of {} was skipped: it is the last line, has no line break and may be truncated "
              "(\"{}\" at its end); fetch the file again from its source to include this record",
              line_, file_.path_.filename().string(), last));
          break;
        }
      }
      for (Variable& variable : file_.variables_) {
        char* end = nullptr;
        const double value = std::strtod(at, &end);
        const bool is_last = &variable == &file_.variables_.back();
        const bool is_empty = end == at;
        while (*end == ' ' || *end == '\t' || *end == '\r') ++end;
        const bool ends = is_last
                              ? std::string_view(end).find_first_not_of(", \t\r") == std::string_view::npos
                              : *end == ',';
        if (is_empty || !ends) {
          const std::size_t fields = fields_of(line).size();
          fail(fmt::format(
              "{} numbers with commas between them are required here; {}", file_.variables_.size(),
              fields == file_.variables_.size() ? fmt::format("{} has no number", variable.name)
                                                : fmt::format("the line has {} fields", fields)));
        }
        const bool is_missing =
            std::find(variable.missing.begin(), variable.missing.end(), value) != variable.missing.end();
        variable.values.push_back(is_missing ? nan : value * variable.scale);
        at = end + (*end == ',' ? 1 : 0);
      }
      if (!std::isnan(file_.variables_.back().values.back())) formats.insert(format_of(last));
    }
  }

  IcarttFile& file_;
  std::ifstream stream_;
  int line_ = 0;
};

IcarttFile::IcarttFile(std::filesystem::path path) : path_(std::move(path)) { Reader(*this).run(); }

}  // namespace

bool is_icartt(const std::filesystem::path& path) {
  std::string start(40, '\0');
  std::ifstream(path, std::ios::binary).read(start.data(), static_cast<std::streamsize>(start.size()));
  return first_line_of(start.substr(0, start.find('\n'))).has_value();
}

std::unique_ptr<FlightFile> open_icartt(const std::filesystem::path& path) {
  return std::make_unique<IcarttFile>(path);
}

}  // namespace pcor::internal
