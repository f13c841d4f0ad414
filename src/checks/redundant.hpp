#pragma once

#include <vector>

#include <pcor/numerics/line_fit.hpp>
#include "checks/manoeuvre_segment.hpp"

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
  Estimate difference{};    ///< mean of second minus first, hPa
  double scatter = 0.0;     ///< scatter of the difference, hPa
  Estimate across{};        ///< change of the difference from the 5th to the 95th percentile of pressure, hPa
  std::size_t samples = 0;  ///< number of samples used
  double step = 1.0;        ///< record interval of the samples, s
};

RedundantFit fit_of(const Redundant& both);

/// Test statistics of a fit: the difference, and its change with the pressure.
std::vector<TestStatistic> test_statistics_of(const RedundantFit& fit, double size);

}  // namespace pcor::internal
