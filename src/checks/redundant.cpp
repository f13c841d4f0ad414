#include "checks/redundant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

/// The avionics delay and smooth their pressures by about half a second, which is 0.05 hPa at this rate,
/// hPa/s.
constexpr double fastest_of_avionics = 0.1;

/// Whether one of the two systems is the avionics.
bool with_avionics(const CheckedFlight& flight) {
  return std::any_of(flight.measured.begin(), flight.measured.end(),
                     [](const MeasuredPair& pair) { return pair.name.rfind("PS_A", 0) == 0; });
}

/// Airborne records at which the pressure changes no faster than `fastest_of_avionics`.
std::vector<bool> steady(const CheckedFlight& flight, const std::vector<double>& pressure) {
  const std::vector<double>& time = flight.air.time();
  const auto reach = static_cast<std::size_t>(std::max(1.0, std::round(2.5 / flight.air.step())));
  std::vector<bool> result(pressure.size(), false);
  for (std::size_t i = reach; i + reach < pressure.size(); ++i) {
    const double rate = (pressure[i + reach] - pressure[i - reach]) / (time[i + reach] - time[i - reach]);
    result[i] = flight.air.flying[i] && std::abs(rate) <= fastest_of_avionics;
  }
  return result;
}

std::vector<bool> comparable(const CheckedFlight& flight) {
  if (!with_avionics(flight)) return flight.air.flying;
  const MeasuredPair& pair = flight.measured.front();
  std::vector<double> total = pair.static_pressure;
  for (std::size_t i = 0; i < total.size(); ++i) total[i] += pair.dynamic_pressure[i];
  const std::vector<bool> one = steady(flight, total);
  const std::vector<bool> two = steady(flight, pair.static_pressure);
  std::vector<bool> both(one.size());
  for (std::size_t i = 0; i < both.size(); ++i) both[i] = one[i] && two[i];
  return both;
}

void add_numbers(const RedundantFit& fit, CheckResult& result) {
  result.numbers.insert(result.numbers.end(), {{"slope", fit.ordinary.slope},
                                               {"slope_stderr", fit.ordinary.slope_error},
                                               {"offset_hpa", fit.ordinary.offset},
                                               {"offset_stderr_hpa", fit.ordinary.offset_error},
                                               {"rms_hpa", fit.ordinary.rms},
                                               {"mean_difference_hpa", fit.difference.value},
                                               {"mean_difference_stderr_hpa", fit.difference.error},
                                               {"across_hpa", fit.across.value},
                                               {"across_stderr_hpa", fit.across.error},
                                               {"scatter_hpa", fit.scatter},
                                               {"orthogonal_slope", fit.orthogonal.slope},
                                               {"orthogonal_slope_stderr", fit.orthogonal.slope_error},
                                               {"orthogonal_offset_hpa", fit.orthogonal.offset},
                                               {"orthogonal_offset_stderr_hpa", fit.orthogonal.offset_error},
                                               {"orthogonal_rms_hpa", fit.orthogonal.rms},
                                               {"samples", static_cast<double>(fit.samples)}});
}

ReportTable table_of(const RedundantFit& fit, const std::string& title) {
  ReportTable table;
  table.title = title;
  table.caption =
      "Standard errors include autocorrelation and slow drift of the differences. The offset is the value at "
      "0 hPa.";
  table.headers = {"fit", "slope", "std. error", "offset, hPa", "std. error", "rms, hPa"};
  const auto row = [&](const char* name, const LineFit& line) {
    table.rows.push_back({name, fmt::format("{:.6f}", line.slope), fmt::format("{:.6f}", line.slope_error),
                          fmt::format("{:+.3f}", line.offset), fmt::format("{:.3f}", line.offset_error),
                          fmt::format("{:.3f}", line.rms)});
  };
  row("ordinary", fit.ordinary);
  row("orthogonal", fit.orthogonal);
  return table;
}

}  // namespace

Redundant redundant(const CheckedFlights& flights, const SeriesOfFlight& first,
                    const SeriesOfFlight& second) {
  Redundant both;
  for (const CheckedFlight& flight : flights) {
    const std::vector<double> a = first(flight);
    const std::vector<double> b = second(flight);
    if (a.empty() || b.empty()) continue;
    const std::vector<bool> in_use = comparable(flight);
    both.step = flight.air.step();
    for (std::size_t i = 0; i < a.size(); ++i) {
      const bool known = in_use[i] && std::isfinite(a[i]) && std::isfinite(b[i]);
      both.first.push_back(known ? a[i] : nan);
      both.second.push_back(known ? b[i] : nan);
      both.time.push_back(flight.air.time()[i]);
    }
  }
  return both;
}

RedundantFit fit_of(const Redundant& both) {
  RedundantFit fit;
  fit.ordinary = ordinary_fit(both.first, both.second);
  fit.orthogonal = orthogonal_fit(both.first, both.second);
  // For pressures that vary by hundreds of times their differences the two lines have the same errors.
  const LeastSquares line = least_squares({std::vector<double>(both.first.size(), 1.0), both.first},
                                          both.second, both.time, both.step);
  for (LineFit* const each : {&fit.ordinary, &fit.orthogonal}) {
    each->offset_error = line.coefficients[0].error;
    each->slope_error = line.coefficients[1].error;
  }
  std::vector<double> difference(both.first.size());
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] = both.second[i] - both.first[i];
  const LeastSquares mean = mean_of(difference, both.time, both.step);
  fit.difference = mean.coefficients.front();
  fit.scatter = mean.rms;
  fit.samples = mean.samples;
  const auto [least, greatest] = range_of(both.first);
  fit.across = {(fit.orthogonal.slope - 1.0) * (greatest - least),
                fit.orthogonal.slope_error * (greatest - least)};
  return fit;
}

std::vector<TestStatistic> judged_of(const RedundantFit& fit, double size) {
  return {judged(fit.difference, size, "hPa", "difference of the systems"),
          judged(fit.across, size, "hPa", "change over the range of pressure")};
}

void show(const CheckedFlights& flights, const SeriesOfFlight& first, const SeriesOfFlight& second,
          const RedundantFit& fit, const RedundantTexts& texts, CheckResult& result) {
  add_numbers(fit, result);
  if (std::any_of(flights.begin(), flights.end(), with_avionics)) {
    result.notes.push_back(fmt::format(
        "The avionics smooth their pressures; samples with a pressure change above {} hPa/s are excluded",
        fastest_of_avionics));
  }
  result.tables.push_back(table_of(fit, texts.table));
  PairPanel panel;
  const auto add_column = [&](const std::string& name, const std::string& title,
                              const SeriesOfFlight& series) {
    result.columns.push_back(column_of(flights, name, title, "hPa", [&series](const CheckedFlight& flight) {
      return masked(series(flight), comparable(flight));
    }));
    return name;
  };
  panel.title = texts.picture;
  panel.caption = texts.caption;
  panel.x = add_column(texts.name + " one", texts.first, first);
  panel.y = add_column(texts.name + " two", texts.second, second);
  panel.lines = {{1.0, 0.0, "equal"}, {fit.orthogonal.slope, fit.orthogonal.offset, "fitted line"}};
  result.pictures.emplace_back(std::move(panel));
}

}  // namespace pcor::internal
