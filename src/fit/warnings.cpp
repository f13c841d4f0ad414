#include "fit/warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include <pcor/base/utc.hpp>
#include "fit/loss_function.hpp"

namespace pcor::internal {
namespace {

constexpr double larger = 1.02;
constexpr double larger_elsewhere =
    1.05;  // a fit of half a flight may be a few per cent worse on the rest by chance
constexpr double more_than_any_defect = 10.0;  // hPa; static defects of aircraft are 1 to 6 hPa
constexpr double max_chance = 30.0;            // s of consecutive outliers; spikes and gusts are shorter
constexpr double many_outliers = 0.05;         // fraction of all samples

}  // namespace

std::string why_worse(const RefitResult& result, double bulk_rms_before) {
  if (result.rms > larger * result.rms_before && result.bulk_rms > larger * bulk_rms_before) {
    return fmt::format(
        "the rms of the fitted samples increases from {:.3f} hPa with the input model to {:.3f} hPa with the "
        "fit",
        result.rms_before, result.rms);
  }
  if (result.defect_error > more_than_any_defect) {
    return fmt::format(
        "the standard error of delta-p is {:.0f} hPa, so these flights do not determine the model; hold "
        "coefficients with --fix, or give a further reference",
        result.defect_error);
  }
  const std::optional<HeldOutPart> held_out = worst_held_out(result.flights);
  if (held_out && held_out->is_off()) return held_out->text();
  for (const FlightFit& flight : result.flights) {
    if (flight.holdout && flight.after.rms > larger_elsewhere * flight.before.rms) {
      return fmt::format(
          "held-out {}: the rms increases from {:.3f} hPa with the input model to {:.3f} hPa with the fit",
          flight.flight, flight.before.rms, flight.after.rms);
    }
  }
  return "";
}

std::vector<std::string> fit_warnings(const RefitResult& result, const OutlierRun& longest) {
  std::vector<std::string> warnings;
  if (result.r_squared < 0.0) {
    warnings.push_back(
        fmt::format("the residuals vary more than the delta-p implied by the reference (R2 {:.2f}): a "
                    "constant would be better than this model",
                    result.r_squared));
  }
  if (longest.duration() >= max_chance) {
    warnings.push_back(fmt::format(
        "look for a missing effect or a failed sensor: {}, {}-{} UTC, mean residual {:+.2f} hPa; {} "
        "consecutive samples, each beyond {:.1f} standard deviations of the noise, are not treated as "
        "outliers",
        longest.flight, utc_text(longest.begin, "%H:%M:%S"), utc_text(longest.end, "%H:%M:%S"), longest.mean,
        longest.samples, tukey_width));
  }
  const double share = static_cast<double>(result.outliers) / static_cast<double>(result.samples);
  if (share > many_outliers) {
    warnings.push_back(
        fmt::format("{:.0f} % of the samples were down-weighted as outliers; the robust loss may hide a "
                    "missing effect; try --loss none",
                    100.0 * share));
  }
  if (result.rms > larger * result.least_squares_rms) {
    warnings.push_back(fmt::format(
        "compare with --loss none: rms {:.3f} hPa with this fit, {:.3f} hPa with plain least squares "
        "of all samples; outliers are down-weighted, or a bound or a prior restricts a coefficient",
        result.rms, result.least_squares_rms));
  }
  return warnings;
}

std::vector<std::string> error_notes(const RefitResult& result, std::size_t flights, bool has_converged,
                                     bool with_uncertainty) {
  // Jackknife errors of n parts have a relative error of 1/sqrt(2 (n - 1)); limits are four of these on
  // either side.
  const double chance = 4.0 / std::sqrt(2.0 * (static_cast<double>(result.jackknife_parts) - 1.0));
  const double too_small = 1.0 + chance;
  const double too_large = 1.0 / too_small;
  std::vector<std::string> notes;
  if (!has_converged) {
    notes.emplace_back(
        "fit the coefficients together, without --stage: the stages keep changing each other's coefficients "
        "and did not converge");
  }
  // Uncertainty of a prior or of fixed parameters is not noise, so a jackknife cannot see it.
  const auto has_prior = [&](const FittedParameter& parameter) {
    return with_uncertainty ||
           std::any_of(result.surfaces.begin(), result.surfaces.end(), [&](const SurfaceFit& each) {
             return parameter.name.rfind(each.effect + ".", 0) == 0;
           });
  };
  const char* const part = result.jackknife_parts == flights ? "flight" : "part of the flights";
  std::string by_one;
  std::string apart;
  for (const FittedParameter& parameter : result.parameters) {
    if (std::isinf(parameter.jackknife_error)) {
      by_one += (by_one.empty() ? "" : ", ") + parameter.name;
      continue;
    }
    const double ratio = parameter.jackknife_error / parameter.noise_error;
    if (!(ratio > too_small || (ratio < too_large && !has_prior(parameter)))) continue;
    apart += fmt::format("{}{} ({:.2g} against {:.2g})", apart.empty() ? "" : ", ", parameter.name,
                         parameter.jackknife_error, parameter.noise_error);
  }
  if (!by_one.empty()) {
    notes.push_back(
        fmt::format("add a flight: one {} alone determines {}; the jackknife error is infinite (inf), and no "
                    "other part verifies the standard error",
                    part, by_one));
  }
  if (!apart.empty()) {
    notes.push_back(fmt::format(
        "use the larger of the jackknife error and the standard error: jackknife errors differ from errors "
        "by noise alone (without misfit and calibration) for {}; the noise model is wrong, or a few minutes "
        "dominate the fit (the jackknife leaves out one {} at a time)",
        apart, part));
  }
  return notes;
}

}  // namespace pcor::internal
