#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pcor/report/report.hpp>
#include <pcor/residuals/samples.hpp>
#include "numerics/missing.hpp"

namespace pcor::internal {

/// Report on samples of flights. Its columns have the shown records of each flight, one flight after another.
class FlightReport {
 public:
  Report& report() { return report_; }
  const Report& report() const { return report_; }

  /// Adds a flight: its name, the times of the shown records, and the intervals that contain one of them.
  void add_flight(std::shared_ptr<const FlightSamples> samples, std::vector<std::size_t> records);

  /// Values of a series at the shown records of all flights; NaN for a flight without the series. A flight is
  /// found by its name and times; flights with equal names and times are matched in order.
  ///
  /// @param flights with a member `samples`, which may be null
  /// @param series member of a flight, or a function of it, with a value for each record, or empty
  template <class Flight, class Series>
  std::vector<double> joined(const std::vector<Flight>& flights, const Series& series) const {
    std::vector<double> values;
    values.reserve(report_.time.size());
    std::vector<bool> is_taken(flights.size(), false);
    for (const ShownFlight& shown : flights_) {
      std::size_t f = 0;
      while (f < flights.size() && (is_taken[f] || !is_same(flights[f].samples, shown.samples))) ++f;
      std::vector<double> part;
      if (f < flights.size()) {
        is_taken[f] = true;
        part = std::invoke(series, flights[f]);
      }
      for (const std::size_t i : shown.records) values.push_back(i < part.size() ? part[i] : nan);
    }
    return values;
  }

  /// Adds the column of a series (see `joined`) if it has a value, and returns whether it has.
  template <class Flight, class Series>
  bool add_column(const std::string& name, const std::string& title, const std::string& unit,
                  const std::vector<Flight>& flights, const Series& series) {
    std::vector<double> values = joined(flights, series);
    if (!has_value(values)) return false;
    report_.columns.push_back({name, title, unit == "1" ? "" : unit, std::move(values)});
    return true;
  }

  /// Adds the column of a quantity of `FlightMotion` as `add_column` does. @param name of the member;
  /// "true_airspeed" for the airspeed
  bool add_motion(const std::string& name);

  /// Adds the columns "latitude" and "longitude", each if it has a value.
  void add_position();

  /// States each flight and its period in the facts of the report.
  void add_flights_to_info();

 private:
  struct ShownFlight {
    std::shared_ptr<const FlightSamples> samples;
    std::vector<std::size_t> records;
  };

  static bool is_same(const std::shared_ptr<const FlightSamples>& one,
                      const std::shared_ptr<const FlightSamples>& other) {
    return one == other || (one != nullptr && one->name == other->name && one->time == other->time);
  }

  Report report_;
  std::vector<ShownFlight> flights_;
};

}  // namespace pcor::internal
