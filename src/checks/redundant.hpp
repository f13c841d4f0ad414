#pragma once

#include <functional>
#include <string>
#include <vector>

#include <pcor/numerics/line_fit.hpp>
#include "checks/flown.hpp"

namespace pcor::internal {

/// Two measurements of one pressure over all flights, one flight after another, NaN where either may not be
/// used.
struct Redundant {
  std::vector<double> first{};   ///< hPa
  std::vector<double> second{};  ///< hPa
  std::vector<double> time{};    ///< s since 1970 UTC
  double step = 1.0;             ///< s
};

/// The lines through them and the mean of their difference, with errors for the memory of what is left.
struct RedundantFit {
  LineFit ordinary{};       ///< second on first: all noise is in the second
  LineFit orthogonal{};     ///< both have equal noise
  Estimated difference{};   ///< mean of second less first, hPa
  double scatter = 0.0;     ///< of the difference, hPa
  Estimated across{};       ///< how the difference changes from the least to the greatest pressure, hPa
  std::size_t samples = 0;  ///< in use
};

/// The first series against the second at the records that are `used`, over all flights. Both may be empty
/// for a flight.
using SeriesOfFlight = std::function<std::vector<double>(const CheckedFlight&)>;
Redundant redundant(const CheckedFlights& flights, const SeriesOfFlight& first, const SeriesOfFlight& second,
                    const std::function<std::vector<bool>(const CheckedFlight&)>& used);

RedundantFit fit_of(const Redundant& both);

/// Whether one of the two systems is that of the avionics, PS_A/QC_A.
bool with_avionics(const CheckedFlight& flight);

/// The avionics delay and smooth their pressures by some half a second, which is 0.05 hPa at this rate,
/// hPa/s.
inline constexpr double fastest_of_avionics = 0.1;

/// The records in the air at which both systems measure the same air: with avionics those at which neither
/// static nor total pressure changes faster than `fastest_of_avionics` over five seconds (memo,
/// Supporting Evidence for Accuracy of p_t).
std::vector<bool> comparable(const CheckedFlight& flight);

/// What is to be said where the avionics took part.
std::string note_on_avionics();

/// What is judged of a fit: the difference, and how it changes with the pressure.
std::vector<TestStatistic> judged_of(const RedundantFit& fit, double size);

/// The numbers of a fit for scripts, those of the interface first.
void add_numbers(const RedundantFit& fit, CheckResult& result);

/// The two fits as a table.
ReportTable table_of(const RedundantFit& fit, const std::string& title);

}  // namespace pcor::internal
