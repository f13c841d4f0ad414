#include "fit_summary.hpp"

#include <optional>
#include <string>

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

void add_fit_summary(nlohmann::ordered_json& json, const RefitResult& fit) {
  json["estimator"] = std::string(fit.estimator);
  json["left_hpa"] = fit.left;
  json["drift_hpa"] = fit.drift_rms;
  json["least_squares_rms_hpa"] = fit.least_squares_rms;
  if (const std::optional<HeldOutPart> part = worst_held_out(fit.flights)) {
    json["holdout"] = {{"name", part->flight},
                       {"rms_hpa", part->statistics.rms},
                       {"bias_hpa", part->statistics.bias},
                       {"expected_hpa", part->expected},
                       {"is_off", part->is_off()}};
  }
}

}  // namespace pcor::tool
