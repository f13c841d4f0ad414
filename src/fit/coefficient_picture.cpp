#include "fit/coefficient_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

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
    const std::string error = is_known ? fmt::format(" ± {:.2g}", p.standard_error) : "";
    const std::string unit = p.unit.empty() || p.unit == "1" ? "" : " " + p.unit;
    panel.rows.push_back(
        {p.name,
         {compares ? ReportDot{percent * (p.value - p.start), is_known ? percent * p.standard_error : 0.0}
                   : ReportDot{nan, 0.0}},
         fmt::format("{} → {:.4g}{}{}{}", std::isfinite(p.start) ? fmt::format("{:.4g}", p.start) : "new",
                     p.value, error, unit, is_known ? "" : ", error unknown")});
  }
  if (std::none_of(panel.rows.begin(), panel.rows.end(),
                   [](const ReportDotRow& row) { return std::isfinite(row.dots.front().value); }))
    return std::nullopt;
  return panel;
}

}  // namespace pcor::internal
