#include "fit/held_out_panel.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "base/phrasing.hpp"

namespace pcor::internal {
namespace {

/// The bias of each held-out part, and what the fit expects.
DotPanel held_out_panel(const std::vector<FlightFit>& flights, std::size_t parts) {
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
    const HeldOutPart part{flight.flight, flight.after, flight.expected_bias, parts};
    panel.rows.push_back({flight.flight,
                          {{flight.after.bias, 0.0}, {0.0, flight.expected_bias}},
                          fmt::format("{:+.3f} hPa, expected 0 ± {:.3f}{}", flight.after.bias,
                                      flight.expected_bias, part.is_off() ? ": off" : "")});
  }
  return panel;
}

}  // namespace

void summarise_held_out(Report& report, const std::vector<FlightFit>& flights) {
  const std::optional<HeldOutPart> worst = worst_held_out(flights);
  if (worst && worst->is_off()) report.summary.push_back(sentence(worst->text()));
}

void add_held_out(Report& report, const std::vector<FlightFit>& flights) {
  if (const std::optional<HeldOutPart> worst = worst_held_out(flights))
    report.items.emplace_back(held_out_panel(flights, worst->parts));
}

}  // namespace pcor::internal
