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

using SeriesOfFlight = std::function<std::vector<double>(const CheckedFlight&)>;

/// Two series at the airborne records at which both systems measure the same air, over all flights: with the
/// avionics, PS_A/QC_A, records at which neither static nor total pressure changes faster than 0.1 hPa/s over
/// five seconds (memo, Supporting Evidence for Accuracy of p_t). Both may be empty for a flight.
Redundant redundant(const CheckedFlights& flights, const SeriesOfFlight& first, const SeriesOfFlight& second);

RedundantFit fit_of(const Redundant& both);

/// Test statistics of a fit: the difference, and its change with the pressure.
std::vector<TestStatistic> judged_of(const RedundantFit& fit, double size);

/// Name of the check, titles of the two series, of the table and of the picture, and its caption.
struct RedundantTexts {
  std::string name{};
  std::string first{};
  std::string second{};
  std::string table{};
  std::string picture{};
  std::string caption{};
};

/// Adds the numbers of a fit, numbers of the interface first, its table and its picture, and a note on the
/// avionics.
void show(const CheckedFlights& flights, const SeriesOfFlight& first, const SeriesOfFlight& second,
          const RedundantFit& fit, const RedundantTexts& texts, CheckResult& result);

}  // namespace pcor::internal
