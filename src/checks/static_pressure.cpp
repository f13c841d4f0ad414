#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "checks/redundant.hpp"

namespace pcor::internal {
namespace {

/// Smallest relevant difference of two corrected static pressures, hPa: the rms difference of the memo's eq.
/// 18 and LAMS.
constexpr double min_static_difference = 0.3;

bool has_second(const CheckedFlight& flight) { return flight.second.has_value(); }

std::vector<double> own(const CheckedFlight& flight) {
  return has_second(flight) ? flight.air.pressure : std::vector<double>{};
}

std::vector<double> other(const CheckedFlight& flight) {
  return has_second(flight) ? flight.second->pressure : std::vector<double>{};
}

}  // namespace

CheckResult check_static_pressure(const CheckedFlights& flights) {
  const auto first = std::find_if(flights.begin(), flights.end(), has_second);
  if (first == flights.end()) {
    return not_run(
        "no flight has a second static system (known are PSFD/QCF, PSFRD/QCFR, PSF/QCF and "
        "PS_A/QC_A); --reference static:OTHER.toml names one with its correction");
  }
  const RedundantFit fit = fit_of(redundant(flights, own, other));
  if (std::isnan(fit.ordinary.slope)) {
    return not_run(
        fmt::format("{} and the model have too few values at the same time in the air", first->second_name));
  }
  CheckResult result;
  decide(judged_of(fit, min_static_difference), result);
  result.finding = fmt::format(
      "The static pressure of {} minus static pressure of the model is {} on average, with slope {:.6f} +- "
      "{:.6f} and rms {:.3f} hPa about the orthogonal line.",
      first->second_name, with_error(fit.difference, "hPa", 3), fit.orthogonal.slope,
      fit.orthogonal.slope_error, fit.orthogonal.rms);
  if (!first->second_corrected) {
    // The defect of the second system is unknown, so a difference does not contradict the model.
    withhold("the second system is uncorrected, so it does not test the model", result);
    result.finding += fmt::format(
        " The pressure of {} is uncorrected, so the difference includes its defect: --reference "
        "static:OTHER.toml gives its correction.",
        first->second_name);
  }
  result.cannot_see =
      "The check does not detect errors common to both systems: errors of the reference of both fits (the "
      "scale of LAMS, the temperature), and effects that act equally on both ports.";
  show(flights, own, other, fit,
       {"static-pressure", "static pressure of the model", "static pressure of " + first->second_name,
        fmt::format("Static pressure of {} against static pressure of the model", first->second_name),
        first->second_corrected ? "Corrected static pressures of the two systems"
                                : "Static pressure of the model and of an uncorrected second system",
        "The line is an orthogonal fit."},
       result);
  return result;
}

}  // namespace pcor::internal
