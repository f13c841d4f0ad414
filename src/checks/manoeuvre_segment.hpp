#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "checks/checks.hpp"
#include "checks/verdict.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {

/// Stretch of a flight with a manoeuvre, and its usable samples.
struct ManoeuvreSegment {
  const CheckedFlight* flight = nullptr;
  Interval interval;
  std::vector<std::size_t> records;  ///< airborne records that are not excluded

  /// Times of the samples, s since 1970 UTC.
  std::vector<double> time() const { return of(flight->air.time()); }
  /// Values of the samples in a series of the flight; NaN for a series that the flight does not have.
  std::vector<double> of(const std::vector<double>& series) const;
  double mean(const std::vector<double>& series) const;  ///< Mean of a series; NaN if all values are missing
  double step() const { return flight->air.step(); }
  /// Regression of `y` on series `x`, all at the samples. Coefficient 0 is a constant, coefficient 1 a drift
  /// in time; the means of time and series are subtracted first.
  LeastSquares regression(const std::vector<double>& y, const std::vector<std::vector<double>>& x) const;
  /// Name like "rf05.nc, 2011-11-17 22:51:00 to 22:53:00".
  std::string location() const;
  /// Short name like "rf05.nc 22:51", for pictures.
  std::string label() const;
};

/// All stretches of all flights in the given regime.
std::vector<ManoeuvreSegment> segments_of_regime(const CheckedFlights& flights, Regime regime);

/// Minimum and maximum of the known values; NaN if all are missing.
std::pair<double, double> range_of(const std::vector<double>& values);
std::vector<double> squares_of(std::vector<double> values);
double standard_deviation(const std::vector<double>& values);
/// The first series minus the second one, of the same length.
std::vector<double> difference(std::vector<double> a, const std::vector<double>& b);
/// Direction of a vector, deg, from 0 to 360.
double direction_of(double east, double north);
/// Values minus their mean.
std::vector<double> subtract_mean(std::vector<double> values);

/// A number of each item. @param of_item function of an item, or pointer to its member
template <class Items, class Function>
auto each_of(const Items& items, const Function& of_item) {
  std::vector<std::decay_t<decltype(std::invoke(of_item, items.front()))>> numbers;
  for (const auto& item : items) numbers.push_back(std::invoke(of_item, item));
  return numbers;
}

/// Natural difference of the tail winds of the two legs of a reverse heading, m/s rms: the wind changes, and
/// legs of minutes cannot show it. The memo's 18 pairs of the GV reach +-0.2 m/s: 0.2 sqrt(18).
inline constexpr double change_of_wind = 0.85;

/// Missing inputs for the wind along the aircraft's axis, as a text that follows "no flight"; empty if a
/// flight has all of them.
std::string missing_for_tail_wind(const CheckedFlights& flights);

/// Result of a check whose flights have no manoeuvre that can be used: the first of the `notes` is the
/// reason, otherwise the criterion of the regime.
CheckResult regime_not_found(const CheckedFlights& flights, Regime regime, const Notes& notes = {});

/// Column over all records of all flights. `series` returns the series of a flight, of its length or empty.
ReportColumn column_of(const CheckedFlights& flights, std::string name, std::string title, std::string unit,
                       const std::function<std::vector<double>(const CheckedFlight&)>& series);

/// Column over all records of all flights with values in manoeuvres, NaN elsewhere.
/// @param all objects with a member `flown`
/// @param series function of such an object: the values at the records of the manoeuvre
template <class Manoeuvre, class Series>
ReportColumn column_in(const CheckedFlights& flights, std::string name, std::string title, std::string unit,
                       const std::vector<Manoeuvre>& all, const Series& series) {
  return column_of(flights, std::move(name), std::move(title), std::move(unit),
                   [&](const CheckedFlight& flight) {
                     std::vector<double> values(flight.air.size(), nan);
                     for (const Manoeuvre& each : all) {
                       if (each.flown.flight != &flight) continue;
                       const std::vector<double> here = series(each);
                       for (std::size_t i = 0; i < here.size(); ++i) values[each.flown.records[i]] = here[i];
                     }
                     return values;
                   });
}

/// Series of a flight where it is `used`, NaN elsewhere. An empty series stays empty.
std::vector<double> masked(std::vector<double> series, const std::vector<bool>& used);

/// Record interval with the most known values of a series, s; NaN without a value.
double usual_step(const CheckedFlights& flights,
                  const std::function<std::vector<double>(const CheckedFlight&)>& series);

/// Adds a note if some flights are not used because of their record interval.
/// @param step of the used flights, s @param has_values whether a flight has values for the check, with any
/// interval
void note_other_steps(const CheckedFlights& flights, double step,
                      const std::function<bool(const CheckedFlight&)>& has_values, Notes& notes);

/// Result with the reason why the check was not run.
CheckResult not_run(std::string reason);

}  // namespace pcor::internal
