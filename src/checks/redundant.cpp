#include "checks/redundant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "numerics/missing.hpp"
#include "roles/variable_naming.hpp"

namespace pcor::internal {
namespace {

using SeriesOfFlight = std::function<std::vector<double>(const CheckedFlight&)>;

/// The avionics delay and smooth their pressures by about half a second, which is 0.05 hPa at this rate,
/// hPa/s.
constexpr double fastest_of_avionics = 0.1;

/// Sums at each record; empty if the series have different lengths, as if one is not available.
std::vector<double> sum_of(std::vector<double> a, const std::vector<double>& b) {
  if (a.size() != b.size()) return {};
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}

std::vector<double> total_of(const MeasuredPair& pair) {
  return sum_of(pair.static_pressure, pair.dynamic_pressure);
}

std::vector<double> static_of(const MeasuredPair& pair) { return pair.static_pressure; }

/// Whether one of the two systems is the avionics.
bool with_avionics(const CheckedFlight& flight) {
  return std::any_of(flight.measured.begin(), flight.measured.end(), [](const MeasuredPair& pair) {
    return pair.name.rfind(avionics_static_pressure, 0) == 0;
  });
}

/// Airborne records; with the avionics, those at which neither pressure changes faster than
/// `fastest_of_avionics`.
std::vector<bool> comparable(const CheckedFlight& flight) {
  std::vector<bool> result = flight.air.flying;
  if (!with_avionics(flight)) return result;
  const std::vector<double>& time = flight.air.time();
  const auto half_width = static_cast<std::size_t>(std::max(1.0, std::round(2.5 / flight.air.step())));
  const MeasuredPair& pair = flight.measured.front();
  for (const std::vector<double>& pressure : {total_of(pair), pair.static_pressure}) {
    for (std::size_t i = 0; i < result.size(); ++i) {
      result[i] = result[i] && i >= half_width && i + half_width < pressure.size() &&
                  std::abs(pressure[i + half_width] - pressure[i - half_width]) /
                          (time[i + half_width] - time[i - half_width]) <=
                      fastest_of_avionics;
    }
  }
  return result;
}

/// Smallest relevant difference of two total pressures, hPa: twice the combined uncertainty of the
/// transducers of two pairs (memo, Background: 0.1 hPa of PSF, 0.05 hPa of QCF).
constexpr double min_total_difference = 0.3;

bool has_two(const CheckedFlight& flight) { return flight.measured.size() > 1; }

SeriesOfFlight of_pair(std::size_t number, std::vector<double> (*series)(const MeasuredPair& pair)) {
  return [=](const CheckedFlight& flight) {
    return has_two(flight) ? series(flight.measured[number]) : std::vector<double>{};
  };
}

/// Smallest relevant difference of two corrected static pressures, hPa: the rms difference of the memo's eq.
/// 18 and LAMS.
constexpr double min_static_difference = 0.3;

bool has_second(const CheckedFlight& flight) { return flight.second.has_value(); }

std::vector<double> model_pressure(const CheckedFlight& flight) {
  return has_second(flight) ? flight.air.pressure : std::vector<double>{};
}

std::vector<double> second_pressure(const CheckedFlight& flight) {
  return has_second(flight) ? flight.second->pressure : std::vector<double>{};
}

ReportTable table_of(const RedundantFit& fit, std::string title) {
  ReportTable table{
      std::move(title),
      "Standard errors include autocorrelation and slow drift of the differences. The offset is the value at "
      "0 hPa.",
      {"fit", "slope", "std. error of the slope", "offset, hPa", "std. error of the offset, hPa",
       "rms, hPa"}};
  const auto row = [&](const char* name, const LineFit& line) {
    table.rows.push_back({name, fmt::format("{:.6f}", line.slope), fmt::format("{:.6f}", line.slope_error),
                          fmt::format("{:+.3f}", line.offset), fmt::format("{:.3f}", line.offset_error),
                          fmt::format("{:.3f}", line.rms)});
  };
  row("ordinary", fit.ordinary);
  row("orthogonal", fit.orthogonal);
  return table;
}

/// Two series at the airborne records at which both systems measure the same air, over all flights of one
/// record interval: with the avionics, PS_A/QC_A, records at which neither static nor total pressure changes
/// faster than 0.1 hPa/s over five seconds (memo, Supporting Evidence for Accuracy of p_t). Both may be empty
/// for a flight.
Redundant redundant(const CheckedFlights& flights, const SeriesOfFlight& first,
                    const SeriesOfFlight& second) {
  Redundant both;
  both.step =
      usual_step(flights, [&](const CheckedFlight& flight) { return sum_of(first(flight), second(flight)); });
  for (const CheckedFlight& flight : flights) {
    const std::vector<double> a = first(flight);
    const std::vector<double> b = second(flight);
    if (a.empty() || b.empty() || !has_step(flight, both.step)) continue;
    const std::vector<bool> in_use = comparable(flight);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const bool known = in_use[i] && std::isfinite(a[i]) && std::isfinite(b[i]);
      both.first.push_back(known ? a[i] : nan);
      both.second.push_back(known ? b[i] : nan);
      both.time.push_back(flight.air.time()[i]);
    }
  }
  return both;
}

/// Adds the numbers of a fit, numbers of the interface first, its table and its columns, and notes on the
/// avionics and on flights that are not used. @param names of the two series
void add_results(const CheckedFlights& flights, const std::string& check, const SeriesOfFlight& first,
                 const SeriesOfFlight& second, const std::array<std::string, 2>& names,
                 const RedundantFit& fit, std::string table, CheckResult& result) {
  const auto add_line = [&result](const std::string& prefix, const LineFit& line) {
    add_number(prefix + "slope", "", {line.slope, line.slope_error}, result);
    add_number(prefix + "offset", "_hpa", {line.offset, line.offset_error}, result);
    result.numbers.emplace_back(prefix + "rms_hpa", line.rms);
  };
  add_line("", fit.ordinary);
  add_number("mean_difference", "_hpa", fit.difference, result);
  add_number("across", "_hpa", fit.across, result);
  result.numbers.emplace_back("scatter_hpa", fit.scatter);
  add_line("orthogonal_", fit.orthogonal);
  result.numbers.emplace_back("samples", static_cast<double>(fit.samples));
  if (std::any_of(flights.begin(), flights.end(), with_avionics)) {
    result.notes.push_back(fmt::format(
        "The avionics smooth their pressures, so samples with a pressure change above {} hPa/s are excluded",
        fastest_of_avionics));
  }
  const auto has_both = [&](const CheckedFlight& flight) {
    return has_value(first(flight)) && has_value(second(flight));
  };
  note_other_steps(flights, fit.step, has_both, result.notes);
  result.tables = {table_of(fit, std::move(table))};
  const auto column = [&](const char* name, const std::string& title, const SeriesOfFlight& series) {
    return column_of(flights, check + name, title, "hPa", [&series](const CheckedFlight& flight) {
      return masked(series(flight), comparable(flight));
    });
  };
  result.columns = {column(" one", names[0], first), column(" two", names[1], second)};
}

/// 5th and 95th percentile of the finite values; NaN without values. A few samples, as of a take-off, do not
/// widen this range.
std::pair<double, double> central_range_of(std::vector<double> values) {
  values.erase(
      std::remove_if(values.begin(), values.end(), [](double value) { return !std::isfinite(value); }),
      values.end());
  if (values.empty()) return {nan, nan};
  const auto percentile = [&values](std::size_t percent) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * percent / 100);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  return {percentile(5), percentile(95)};
}

}  // namespace

RedundantFit fit_of(const Redundant& both) {
  RedundantFit fit;
  fit.step = both.step;
  fit.ordinary = ordinary_fit(both.first, both.second);
  fit.orthogonal = orthogonal_fit(both.first, both.second);
  // For pressures that vary by hundreds of times their differences the two lines have the same errors.
  const LeastSquares line = least_squares({std::vector<double>(both.first.size(), 1.0), both.first},
                                          both.second, both.time, both.step);
  for (LineFit* const each : {&fit.ordinary, &fit.orthogonal}) {
    each->offset_error = line.coefficients[0].error;
    each->slope_error = line.coefficients[1].error;
  }
  const std::vector<double> off = difference(both.second, both.first);
  std::vector<double> middle = sum_of(both.second, both.first);
  for (double& value : middle) value *= 0.5;
  const LeastSquares mean = mean_of(off, both.time, both.step);
  fit.difference = mean.coefficients.front();
  fit.scatter = mean.rms;
  fit.samples = mean.samples;
  const auto [lowest, highest] = central_range_of(both.first);
  // The slope of the difference against the mean is zero also where noise exceeds the range, as in level
  // flight; the ordinary line is then too flat, and the orthogonal one undetermined (Bland and Altman 1986,
  // Lancet 327, 307).
  const LeastSquares change =
      least_squares({std::vector<double>(middle.size(), 1.0), middle}, off, both.time, both.step);
  fit.across = (highest - lowest) * change.coefficients[1];
  return fit;
}

std::vector<TestStatistic> test_statistics_of(const RedundantFit& fit, double size) {
  return {test_statistic(fit.difference, size, "hPa", "difference of the systems"),
          test_statistic(fit.across, size, "hPa", "change from the 5th to the 95th percentile of pressure")};
}

CheckResult check_total_pressure(const CheckedFlights& flights) {
  const auto first = std::find_if(flights.begin(), flights.end(), has_two);
  if (first == flights.end()) {
    return not_run(
        "no flight has a second pair of pressures (known are PSFD/QCF, PSFRD/QCFR, PSF/QCF and "
        "PS_A/QC_A); --reference static:OTHER.toml names one");
  }
  const std::string& one = first->measured[0].name;
  const std::string& two = first->measured[1].name;
  const SeriesOfFlight first_total = of_pair(0, total_of);
  const SeriesOfFlight second_total = of_pair(1, total_of);
  const RedundantFit fit = fit_of(redundant(flights, first_total, second_total));
  if (std::isnan(fit.ordinary.slope)) {
    return not_run(fmt::format("{} and {} have too few values at the same time in the air", one, two));
  }
  const RedundantFit statics = fit_of(redundant(flights, of_pair(0, static_of), of_pair(1, static_of)));

  CheckResult result;
  set_verdict(test_statistics_of(fit, min_total_difference), result);
  result.finding = fmt::format(
      "The total pressure of {} minus total pressure of {} is {} on average, with slope {:.6f} +- {:.6f} and "
      "rms {:.3f} hPa about the line, while the static pressures alone differ by {:+.2f} hPa with a scatter "
      "of {:.2f} hPa.",
      two, one, format_number(fit.difference, "hPa", 3), fit.ordinary.slope, fit.ordinary.slope_error,
      fit.ordinary.rms, statics.difference.value, statics.scatter);
  result.limitations =
      "The check does not detect static defects, which cancel in the total pressure, and losses common to "
      "both pitots, for example at large angles.";
  add_results(flights, "total-pressure", first_total, second_total,
              {"total pressure, " + one, "total pressure, " + two}, fit,
              fmt::format("Total pressure of {} against {}", two, one), result);
  add_number("static_mean_difference", "_hpa", statics.difference, result);
  result.numbers.emplace_back("static_scatter_hpa", statics.scatter);
  return result;
}

CheckResult check_static_pressure(const CheckedFlights& flights) {
  const auto first = std::find_if(flights.begin(), flights.end(), has_second);
  if (first == flights.end()) {
    return not_run(
        "no flight has a second static system (known are PSFD/QCF, PSFRD/QCFR, PSF/QCF and "
        "PS_A/QC_A); --reference static:OTHER.toml names one with its correction");
  }
  const RedundantFit fit = fit_of(redundant(flights, model_pressure, second_pressure));
  if (std::isnan(fit.ordinary.slope)) {
    return not_run(
        fmt::format("{} and the model have too few values at the same time in the air", first->second_name));
  }
  CheckResult result;
  set_verdict(test_statistics_of(fit, min_static_difference), result);
  result.finding = fmt::format(
      "The static pressure of {} minus static pressure of the model is {} on average, with slope {:.6f} +- "
      "{:.6f} and rms {:.3f} hPa about the line.",
      first->second_name, format_number(fit.difference, "hPa", 3), fit.ordinary.slope,
      fit.ordinary.slope_error, fit.ordinary.rms);
  if (!first->second_corrected) {
    // The defect of the second system is unknown, so a difference does not contradict the model.
    mark_inconclusive("the second system is uncorrected, so it does not test the model", result);
    result.finding += fmt::format(
        " The pressure of {} is uncorrected, so the difference includes its defect: --reference "
        "static:OTHER.toml gives its correction.",
        first->second_name);
  }
  result.limitations =
      "The check does not detect errors common to both systems: errors of the reference of both fits (the "
      "scale of LAMS, the temperature), and effects that act equally on both ports.";
  add_results(flights, "static-pressure", model_pressure, second_pressure,
              {"static pressure of the model", "static pressure of " + first->second_name}, fit,
              fmt::format("Static pressure of {} against static pressure of the model", first->second_name),
              result);
  return result;
}

}  // namespace pcor::internal
