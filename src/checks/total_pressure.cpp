#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "checks/redundant.hpp"

namespace pcor::internal {
namespace {

/// Smallest relevant difference of two total pressures, hPa: twice the combined uncertainty of the
/// transducers of two pairs (memo, Background: 0.1 hPa of PSF, 0.05 hPa of QCF).
constexpr double min_total_difference = 0.3;

bool has_two(const CheckedFlight& flight) { return flight.measured.size() > 1; }

std::vector<double> total_of(const CheckedFlight& flight, std::size_t number) {
  if (!has_two(flight)) return {};
  const MeasuredPair& pair = flight.measured[number];
  std::vector<double> total = pair.static_pressure;
  for (std::size_t i = 0; i < total.size(); ++i) total[i] += pair.dynamic_pressure[i];
  return total;
}

SeriesOfFlight static_of(std::size_t number) {
  return [number](const CheckedFlight& flight) {
    return has_two(flight) ? flight.measured[number].static_pressure : std::vector<double>{};
  };
}

SeriesOfFlight total(std::size_t number) {
  return [number](const CheckedFlight& flight) { return total_of(flight, number); };
}

}  // namespace

CheckResult check_total_pressure(const CheckedFlights& flights) {
  const auto first = std::find_if(flights.begin(), flights.end(), has_two);
  if (first == flights.end()) {
    return not_run(
        "no flight has a second pair of pressures (known are PSFD/QCF, PSFRD/QCFR, PSF/QCF and "
        "PS_A/QC_A); --reference static:OTHER.toml names one");
  }
  const std::string& one = first->measured[0].name;
  const std::string& two = first->measured[1].name;
  const RedundantFit fit = fit_of(redundant(flights, total(0), total(1)));
  if (std::isnan(fit.ordinary.slope)) {
    return not_run(fmt::format("{} and {} have too few values at the same time in the air", one, two));
  }
  const RedundantFit statics = fit_of(redundant(flights, static_of(0), static_of(1)));

  CheckResult result;
  decide(judged_of(fit, min_total_difference), result);
  result.finding = fmt::format(
      "The total pressure of {} minus total pressure of {} is {} on average, with slope {:.6f} +- {:.6f} and "
      "rms {:.3f} hPa about the line, while the static pressures alone differ by {:+.2f} hPa with a scatter "
      "of {:.2f} hPa.",
      two, one, with_error(fit.difference, "hPa", 3), fit.ordinary.slope, fit.ordinary.slope_error,
      fit.ordinary.rms, statics.difference.value, statics.scatter);
  result.cannot_see =
      "The check does not detect static defects, which cancel in the total pressure, and losses common to "
      "both pitots, for example at large angles.";
  show(flights, total(0), total(1), fit,
       {"total-pressure", "total pressure, " + one, "total pressure, " + two,
        fmt::format("Total pressure of {} against {}", two, one), "Total pressures of the two systems",
        "Static defects cancel in the total pressure: the difference shows errors of the transducers, the "
        "pitots and the lines."},
       result);
  result.numbers.emplace_back("static_mean_difference_hpa", statics.difference.value);
  result.numbers.emplace_back("static_mean_difference_stderr_hpa", statics.difference.error);
  result.numbers.emplace_back("static_scatter_hpa", statics.scatter);
  return result;
}

}  // namespace pcor::internal
