#include "fit_summary.hpp"

#include <optional>

#include "command.hpp"

namespace pcor::tool {

void add_trust_option(CLI::App& command, bool& trust) {
  command.add_flag("--trust-reference", trust,
                   "assume exact calibrations of the reference and the thermometer: standard errors exclude "
                   "their uncertainty ([uncertainty] of the model or default sizes), and effects of the "
                   "reference are not tested");
}

void print_fit_summary(const RefitResult& fit) {
  const std::optional<HeldOutPart> held_out = worst_held_out(fit.flights);
  if (held_out && held_out->is_off()) say("Warning: {}.\n", held_out->text());
  if (fit.left > 0.0)
    say("Model error varying with the flight state: {:.2f} hPa (rms); slow drift of the noise: {:.2f} hPa.\n",
        fit.left, fit.drift_rms);
}

}  // namespace pcor::tool
