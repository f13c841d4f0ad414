#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "checks/checks.hpp"
#include "checks/verdict.hpp"

namespace pcor::internal {

/// A stretch of a flight in which something was flown, with the samples of it that may be used.
struct Flown {
  const CheckedFlight* flight = nullptr;
  Interval interval;
  std::vector<std::size_t> places;  ///< records in the air and not excluded

  /// Their times, s since 1970 UTC.
  std::vector<double> time() const;
  /// Their values in a series of the flight; NaN for a series that the flight does not have.
  std::vector<double> of(const std::vector<double>& series) const;
  double mean(const std::vector<double>& series) const;  ///< NaN where nothing has a value
  double step() const { return flight->air.step(); }
  /// "rf05.nc, 2011-11-17 22:51:00 to 22:53:00".
  std::string location() const;
};

/// All stretches of all flights in which a regime was flown.
std::vector<Flown> all_flown(const CheckedFlights& flights, Regime regime);

/// The least and the greatest of the values that are there; NaN for none.
std::pair<double, double> range_of(const std::vector<double>& values);
double mean_value(const std::vector<double>& values);
double standard_deviation(const std::vector<double>& values);
/// The values less their mean.
std::vector<double> less_mean(std::vector<double> values);

/// How much the tail winds of the two legs of a reverse heading differ although nothing is wrong, m/s rms:
/// the wind changes, and legs of minutes cannot show it. The memo's 18 pairs of the GV reach +-0.2 m/s: 0.2
/// sqrt(18).
inline constexpr double change_of_wind = 0.85;

/// What the flights lack for the wind along the aircraft's axis, in words that follow "no flight"; empty
/// where one of them has it.
std::string missing_for_tail_wind(const CheckedFlights& flights);

/// "no speed run (airspeed changes by ...) was found in the flights; --intervals adds one".
std::string not_flown(const CheckedFlights& flights, Regime regime);

/// A column of a report's pictures over all records of all flights. `series` gives that of a flight, of its
/// length or empty.
ReportColumn column_of(const CheckedFlights& flights, std::string name, std::string title, std::string unit,
                       const std::function<std::vector<double>(const CheckedFlight&)>& series);

/// A series of a flight where it is `used`, NaN elsewhere. One without values stays so.
std::vector<double> masked(std::vector<double> series, const std::vector<bool>& used);

/// The series in the stretches of this flight, NaN elsewhere.
std::vector<double> only_in(const CheckedFlight& flight, const std::vector<Flown>& all,
                            const std::vector<double>& series);

/// The attack of a flight, deg: of the model, else as recorded; empty where there is none.
const std::vector<double>& attack_of(const FlightAir& air);
/// As `attack_of`.
const std::vector<double>& sideslip_of(const FlightAir& air);

/// A result with the name of its check, and why it did not run.
CheckResult not_run(std::string name, std::string reason);

}  // namespace pcor::internal
