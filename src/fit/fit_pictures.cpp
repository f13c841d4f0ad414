#include "fit/fit_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/phrasing.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {

std::optional<DotPanel> coefficient_picture(const std::vector<FittedParameter>& parameters,
                                            const std::string& before_is, const std::string& after_is) {
  DotPanel panel;
  panel.title = "Coefficients before and after";
  panel.caption = fmt::format(
      "Change of each coefficient ({} relative to {}), with its standard error. A change of many standard "
      "errors means that the old value was wrong for these flights, or that the coefficient absorbs a "
      "missing effect.",
      after_is, before_is);
  panel.series = {""};
  panel.axis = "change";
  panel.unit = "%";
  panel.lines = {{before_is, 0.0}};
  for (const FittedParameter& p : parameters) {
    if (!p.fitted || !std::isfinite(p.value)) continue;
    const double percent = 100.0 / std::abs(p.start);
    const bool is_known = std::isfinite(p.standard_error);
    // Compares previous values larger than the error; a relative change from nearly zero is meaningless.
    const bool compares = std::isfinite(percent) && !(is_known && std::abs(p.start) < p.standard_error);
    const bool has_error = is_known && p.standard_error > 0.0;
    const int decimals = has_error ? decimals_of_error(p.standard_error) : 0;
    const std::string value =
        has_error ? fmt::format("{:.{}f} ± {:.{}f}", p.value, decimals, p.standard_error, decimals)
                  : fmt::format("{:.4g}", p.value);
    const std::string unit = p.unit.empty() || p.unit == "1" ? "" : " " + p.unit;
    panel.rows.push_back(
        {p.name,
         {compares ? ReportDot{percent * (p.value - p.start), is_known ? percent * p.standard_error : 0.0}
                   : ReportDot{nan, 0.0}},
         fmt::format("{} → {}{}{}", std::isfinite(p.start) ? fmt::format("{:.4g}", p.start) : "new", value,
                     unit, is_known ? "" : ", error unknown")});
  }
  const auto shown = std::count_if(panel.rows.begin(), panel.rows.end(), [](const ReportDotRow& row) {
    return std::isfinite(row.dots.front().value);
  });
  if (shown == 0) return std::nullopt;
  if (shown < static_cast<std::ptrdiff_t>(panel.rows.size()))
    panel.caption +=
        " A row has no marker if the old value is absent, zero or smaller than the error; see the numbers at "
        "the right.";
  return panel;
}

void summarise_held_out(Report& report, const std::vector<FlightFit>& flights) {
  const std::optional<HeldOutPart> worst = worst_held_out(flights);
  if (worst && worst->is_off()) report.summary.push_back(sentence(worst->text()));
}

void add_held_out(Report& report, const std::vector<FlightFit>& flights) {
  const std::optional<HeldOutPart> worst = worst_held_out(flights);
  if (!worst) return;
  DotPanel panel;
  panel.title = "Held-out parts";
  panel.caption =
      "The mean residual of each part that was not used in the fit. The bar about zero is the standard "
      "deviation that the fit expects: from the changes of the residual in the fit, the errors of the "
      "coefficients, and the misfit of the law.";
  panel.axis = "bias";
  panel.unit = "hPa";
  panel.series = {"held out", "expected"};
  for (const FlightFit& flight : flights) {
    if (!flight.holdout) continue;
    const HeldOutPart part{flight.flight, flight.after, flight.expected_bias, worst->parts};
    panel.rows.push_back({flight.flight,
                          {{flight.after.bias, 0.0}, {0.0, flight.expected_bias}},
                          fmt::format("{:+.3f} hPa, expected 0 ± {:.3f}{}", flight.after.bias,
                                      flight.expected_bias, part.is_off() ? ": off" : "")});
  }
  report.items.emplace_back(std::move(panel));
}

}  // namespace pcor::internal
