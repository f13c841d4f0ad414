#include <pcor/flight/flight.hpp>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <sstream>
#include <vector>

#include "flight/flight_file.hpp"
#include "reading.hpp"

namespace {

/// File that contains only times. Lines of the text: units, calendar, FlightDate, TimeInterval, base time,
/// times.
class TimesFile final : public pcor::FlightFile {
 public:
  explicit TimesFile(const std::string& text) {
    std::istringstream lines(text);
    for (std::string* attribute : {&units_, &calendar_, &date_, &interval_}) std::getline(lines, *attribute);
    std::string number;
    if (std::getline(lines, number)) base_ = std::strtod(number.c_str(), nullptr);
    while (std::getline(lines, number)) times_.push_back(std::strtod(number.c_str(), nullptr));
  }

  const std::filesystem::path& path() const override { return path_; }
  int variable_count() const override { return 2; }
  std::optional<int> find_variable(const std::string& name) const override {
    if (name == "Time") return time;
    if (name == "base_time") return base_time;
    return std::nullopt;
  }
  std::string variable_name(int variable) const override { return variable == time ? "Time" : "base_time"; }
  std::vector<int> dimensions_of(int variable) const override {
    return variable == time ? std::vector{0} : std::vector<int>{};
  }
  std::string dimension_name(int /*dimension*/) const override { return "Time"; }
  std::size_t dimension_length(int /*dimension*/) const override { return times_.size(); }
  std::vector<std::string> attribute_names(int /*variable*/) const override { return {}; }
  std::string text_attribute(int variable, const std::string& name) const override {
    if (variable == time) return name == "units" ? units_ : name == "calendar" ? calendar_ : "";
    return name == "FlightDate" ? date_ : name == "TimeInterval" ? interval_ : "";
  }
  std::vector<double> number_attribute(int /*variable*/, const std::string& /*name*/) const override {
    return {};
  }
  bool is_numeric(int /*variable*/) const override { return true; }
  double max_number(int /*variable*/) const override { return std::numeric_limits<double>::max(); }
  std::vector<double> missing_values(int /*variable*/) const override { return {}; }
  std::array<double, 2> valid_range(int /*variable*/) const override {
    return {std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max()};
  }
  void read(int variable, pcor::RecordBlock records, double* out) const override {
    if (variable == base_time) *out = base_;
    for (std::size_t i = 0; variable == time && i < records.count; ++i) out[i] = times_[records.first + i];
  }

 private:
  static constexpr int time = 0, base_time = 1;

  std::filesystem::path path_ = "a file";
  std::string units_, calendar_, date_, interval_;
  double base_ = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> times_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return fuzz::reading(bytes, size, [](const std::string& text) {
    const pcor::Flight flight(std::make_unique<TimesFile>(text), pcor::TimestampAlignment::begin);
    std::vector<double> times(flight.records());
    flight.read_time_stamps({0, times.size()}, times.data());
    for (std::size_t i = 1; i < times.size(); ++i)
      if (!(times[i] > times[i - 1])) std::abort();
  });
}
