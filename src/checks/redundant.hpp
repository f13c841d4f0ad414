#pragma once

#include <functional>
#include <string>
#include <vector>

#include <pcor/numerics/line_fit.hpp>
#include "checks/flown.hpp"

namespace pcor::internal {

/// Two measurements of one pressure over all flights, one flight after another; NaN if either is unusable.
struct Redundant {
  std::vector<double> first{};   ///< hPa
  std::vector<double> second{};  ///< hPa
  std::vector<double> time{};    ///< s since 1970 UTC
  double step = 1.0;             ///< s
};

/// Fitted lines and mean of the difference; the errors include the autocorrelation of the residuals.
struct RedundantFit {
  LineFit ordinary{};       ///< second on first: all noise in the second
  LineFit orthogonal{};     ///< equal noise in both
  Estimated difference{};   ///< mean of second minus first, hPa
  double scatter = 0.0;     ///< scatter of the difference, hPa
  Estimated across{};       ///< change of the difference from the minimum to the maximum pressure, hPa
  std::size_t samples = 0;  ///< number of samples used
};

/// Pair of the first and the second series at the records that are `used`, over all flights. Both may be
/// empty for a flight.
using SeriesOfFlight = std::function<std::vector<double>(const CheckedFlight&)>;
Redundant redundant(const CheckedFlights& flights, const SeriesOfFlight& first, const SeriesOfFlight& second,
                    const std::function<std::vector<bool>(const CheckedFlight&)>& used);

RedundantFit fit_of(const Redundant& both);

/// Whether one of the two systems is the avionics, PS_A/QC_A.
bool with_avionics(const CheckedFlight& flight);

/// The avionics delay and smooth their pressures by about half a second, which is 0.05 hPa at this rate,
/// hPa/s.
inline constexpr double fastest_of_avionics = 0.1;

/// Airborne records at which both systems measure the same air: with avionics, records at which neither
/// static nor total pressure changes faster than `fastest_of_avionics` over five seconds (memo, Supporting
/// Evidence for Accuracy of p_t).
std::vector<bool> comparable(const CheckedFlight& flight);

/// Note on the use of the avionics.
std::string note_on_avionics();

/// Test statistics of a fit: the difference, and its change with the pressure.
std::vector<TestStatistic> judged_of(const RedundantFit& fit, double size);

/// Adds the numbers of a fit to the JSON result, numbers of the interface first.
void add_numbers(const RedundantFit& fit, CheckResult& result);

/// Table of the two fits.
ReportTable table_of(const RedundantFit& fit, const std::string& title);

}  // namespace pcor::internal
