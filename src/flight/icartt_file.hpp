#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flight/flight_file.hpp"

namespace pcor::internal {

/// True where the first line is that of an ICARTT file: "70, 1001".
bool is_icartt(const std::filesystem::path& path);

/// A text file of the ICARTT conventions, file format index 1001: one independent variable, the time, and series
/// over it. All of it is in memory.
///
/// The independent variable is called Time; its unit has the date of the header, from whose midnight it counts.
/// Missing values, and those below or above the limits of detection, are NaN; scale factors are applied. The
/// header's lines and its "NAME: value" comments are attributes: institution, source, project, platform.
class IcarttFile final : public FlightFile {
 public:
  /// @throws Error "path:line: what is wrong; what to do"
  explicit IcarttFile(std::filesystem::path path);

  const std::filesystem::path& path() const override { return path_; }
  int variable_count() const override { return static_cast<int>(variables_.size()); }
  std::optional<int> find_variable(const std::string& name) const override;
  std::string variable_name(int variable) const override { return at(variable).name; }
  std::vector<int> dimensions_of(int /*variable*/) const override { return {0}; }
  std::string dimension_name(int /*dimension*/) const override { return "Time"; }
  std::size_t dimension_length(int /*dimension*/) const override { return variables_.front().values.size(); }
  std::vector<std::string> attribute_names(int variable) const override;
  std::string text_attribute(int variable, const std::string& name) const override;
  std::vector<double> number_attribute(int variable, const std::string& name) const override;
  bool is_numeric(int /*variable*/) const override { return true; }
  double greatest_number(int variable) const override;
  std::vector<double> missing_values(int /*variable*/) const override { return {}; }
  std::array<double, 2> valid_range(int variable) const override;
  void read(int variable, RecordBlock records, double* out) const override;

 private:
  using Attributes = std::vector<std::pair<std::string, std::string>>;

  struct Variable {
    std::string name;
    Attributes attributes{};
    double scale = 1.0;
    std::vector<double> missing{};  ///< numbers of the file that are no values
    std::vector<double> values{};
  };

  class Reader;

  const Variable& at(int variable) const { return variables_.at(static_cast<std::size_t>(variable)); }
  const Attributes& attributes_of(int variable) const;

  std::filesystem::path path_;
  Attributes attributes_;
  std::vector<Variable> variables_;  // the time first
};

}  // namespace pcor::internal
