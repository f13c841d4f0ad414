#include "fit_summary.hpp"

#include <optional>

#include "command.hpp"

namespace pcor::tool {

void print_fit_summary(const RefitResult& fit) {
  const std::optional<HeldOutPart> held_out = worst_held_out(fit.flights);
  if (held_out && held_out->is_off()) say("Warning: {}.\n", held_out->text());
  if (fit.left > 0.0)
    say("Model error varying with the flight state: {:.2f} hPa (rms); slow drift of the noise: {:.2f} hPa.\n",
        fit.left, fit.drift_rms);
  if (fit.between_flights > 0.0)
    say("Standard deviation between flights of the mean residual: {:.2f} hPa.\n", fit.between_flights);
}

}  // namespace pcor::tool
