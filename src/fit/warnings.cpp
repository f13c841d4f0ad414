#include "fit/warnings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include <pcor/base/error.hpp>
#include <pcor/base/utc.hpp>
#include "fit/loss_function.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr double larger = 1.02;
constexpr double larger_elsewhere =
    1.05;  // a fit of half a flight may be a few per cent worse on the rest by chance
constexpr double max_chance = 30.0;     // s of consecutive outliers; spikes and gusts are shorter
constexpr double many_outliers = 0.05;  // fraction of all samples

// Flights hold 32-bit floats: columns that agree to better than their rounding, 6e-8, are one column.
constexpr double hopeless_condition = 1e7;
// Condition number of scaled columns; eq. 20 of the memo with an independent Mach number has 1400 on a flight
// with speed runs.
constexpr double collinear_condition = 300.0;
// A standard error above this share of an effect's typical size is worth a word.
constexpr double weak_share = 0.25;

}  // namespace

std::string why_worse(const RefitResult& result, double bulk_rms_before) {
  if (result.rms > larger * result.rms_before && result.bulk_rms > larger * bulk_rms_before) {
    return fmt::format(
        "the rms of the fitted samples is larger with the fit, {:.3f} hPa, "
        "than with the coefficients of the file, {:.3f} hPa",
        result.rms, result.rms_before);
  }
  const std::optional<HeldOutPart> held_out = worst_held_out(result.flights);
  if (held_out && held_out->is_off()) return held_out->text();
  for (const FlightFit& flight : result.flights) {
    if (flight.holdout && flight.after.rms > larger_elsewhere * flight.before.rms) {
      return fmt::format(
          "held-out {}: the rms is larger with the fit, {:.3f} hPa, than with the coefficients of the file, "
          "{:.3f} hPa",
          flight.flight, flight.after.rms, flight.before.rms);
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
        "{}: from {} to {} {} samples in a row are off by {:+.2f} hPa in the mean, each beyond {:.1f} "
        "deviations of the noise, so they are not outliers: an effect is missing there, or a sensor "
        "failed",
        longest.flight, utc_text(longest.begin, "%H:%M:%S"), utc_text(longest.end, "%H:%M:%S"),
        longest.samples, longest.mean, tukey_width));
  }
  const double share = static_cast<double>(result.outliers) / static_cast<double>(result.samples);
  if (share > many_outliers) {
    warnings.push_back(
        fmt::format("{:.0f} % of the samples were down-weighted as outliers; the robust loss may hide a "
                    "missing effect; try --loss none",
                    100.0 * share));
  }
  if (result.rms > larger * result.least_squares_rms) {
    warnings.push_back(
        fmt::format("the rms residual is {:.3f} hPa with plain least squares of all samples and {:.3f} hPa "
                    "with this fit: outliers are down-weighted, or a bound or a prior restricts a "
                    "coefficient; --loss none weights all samples equally",
                    result.least_squares_rms, result.rms));
  }
  return warnings;
}

std::vector<std::string> error_notes(const RefitResult& result, std::size_t flights, bool has_converged,
                                     bool with_doubt) {
  // Jackknife errors of n parts have a relative error of 1/sqrt(2 (n - 1)); limits are four of these on
  // either side.
  const double chance = 4.0 / std::sqrt(2.0 * (static_cast<double>(result.jackknife_parts) - 1.0));
  const double too_small = 1.0 + chance;
  const double too_large = 1.0 / too_small;
  std::vector<std::string> notes;
  if (!has_converged) {
    notes.emplace_back(
        "the staged fit did not converge: the stages keep changing each other's coefficients; fit the "
        "coefficients together, without stages");
  }
  // Uncertainty of a prior or of fixed parameters is not noise, so a jackknife cannot see it.
  const auto has_prior = [&](const FittedParameter& parameter) {
    return with_doubt ||
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
        fmt::format("one {} alone determines {}: its jackknife error is infinite (inf), and no other part "
                    "verifies its standard error; add a flight that determines it",
                    part, by_one));
  }
  if (!apart.empty()) {
    notes.push_back(fmt::format(
        "jackknife errors (without one {} at a time) differ from the errors by the noise model for {}: the "
        "noise model is wrong, or a few minutes dominate the fit; use the larger error",
        part, apart));
  }
  return notes;
}

double condition_number(const Reduction& reduction, const FitTask& task,
                        const std::vector<std::size_t>& requested) {
  // Coefficients of a surface have a prior, which makes them identifiable.
  std::vector<Eigen::Index> free;
  for (std::size_t k = 0; k < requested.size(); ++k) {
    if (task.surface_of(requested[k]) == nullptr) free.push_back(as_index(k));
  }
  if (free.empty()) return 1.0;
  const auto to_string = [&](Eigen::Index k) -> const std::string& {
    return task.parameters[requested[static_cast<std::size_t>(free[static_cast<std::size_t>(k)])]].name;
  };
  Eigen::MatrixXd scaled = reduction.factor(Eigen::all, free);
  const Eigen::VectorXd lengths = reduction.lengths()(free);
  for (Eigen::Index k = 0; k < scaled.cols(); ++k) {
    const double length = scaled.col(k).norm();
    if (!(lengths[k] > 0.0)) {
      throw Error(
          Error::Code::fit,
          fmt::format("{} has no influence on these flights, so it cannot be fitted; fix it: --fix {}",
                      to_string(k), to_string(k)));
    }
    if (!(length > lengths[k] / hopeless_condition)) {
      throw Error(
          Error::Code::fit,
          fmt::format("--stage: {} is not identifiable together with the offsets of the intervals; move it "
                      "to the last stage",
                      to_string(k)));
    }
    scaled.col(k) /= length;
  }
  const Eigen::VectorXd singular = singular_values(scaled);
  const double ratio = singular[0] / singular[singular.size() - 1];
  const double condition = std::isfinite(ratio) ? ratio : infinity;
  if (ratio < hopeless_condition || task.uses_prior()) return condition;
  const Eigen::VectorXd weak = weakest_direction(scaled).cwiseAbs();
  std::vector<std::string> names;
  for (Eigen::Index k = 0; k < weak.size(); ++k) {
    if (weak[k] > 0.1 * weak.maxCoeff()) names.push_back(to_string(k));
  }
  throw Error(
      Error::Code::fit,
      fmt::format("{} are not identifiable together on these flights (condition number {:.0e}); fix one of "
                  "them, e.g. --fix {}",
                  fmt::join(names, ", "), condition, names.back()));
}

std::vector<std::string> identifiability_notes(const FitTask& task, const Solution& solution,
                                               const Eigen::MatrixXd& covariance,
                                               const std::vector<std::size_t>& fitted, double condition,
                                               const RegimeSet& flown) {
  const Eigen::Index size = as_index(fitted.size());  // fixed parameters follow them
  std::vector<std::string> words;
  // With priors, large standard errors are expected.
  for (Eigen::Index a = 0; a < size && !task.uses_prior(); ++a) {
    const std::size_t position = fitted[static_cast<std::size_t>(a)];
    const FitParameter& parameter = task.parameters[position];
    const double error = std::sqrt(covariance(a, a));
    if (!(parameter.typical > 0.0) || !(error > weak_share * parameter.typical)) continue;
    std::string partners;
    for (Eigen::Index b = 0; b < size; ++b) {
      const double correlation = covariance(a, b) / std::sqrt(covariance(a, a) * covariance(b, b));
      if (a == b || !(std::abs(correlation) > 0.9)) continue;
      partners += fmt::format("{}{} ({:+.3f})", partners.empty() ? "" : ", ",
                              task.parameters[fitted[static_cast<std::size_t>(b)]].name, correlation);
    }
    words.push_back(
        fmt::format("{} is {}: {:.3g} +- {:.2g}, with a typical size of {:.2g}{}{}; fix it with --fix {}; to "
                    "determine it: {}",
                    parameter.name, error > parameter.typical ? "not determined" : "weakly determined",
                    solution.values[as_index(position)], error, parameter.typical,
                    partners.empty() ? "" : ", and it is correlated with ", partners, parameter.name,
                    parameter.manoeuvre));
  }
  if (condition > collinear_condition) {
    words.push_back(
        fmt::format("the coefficients are nearly collinear (condition number {:.0f}): their sum is better "
                    "determined than each; do not interpret one alone",
                    condition));
  }
  const bool has_manoeuvre = flown[static_cast<std::size_t>(Regime::pitch_manoeuvre)] ||
                             flown[static_cast<std::size_t>(Regime::yaw_manoeuvre)] ||
                             flown[static_cast<std::size_t>(Regime::speed_run)];
  if (flown.any() && !has_manoeuvre) {
    words.emplace_back(
        "the flights have no pitch manoeuvre, yaw manoeuvre or speed run: the coefficients depend on climbs "
        "and slow changes, in which angle of attack, Mach number and weight are correlated, and may absorb "
        "missing effects");
  }
  return words;
}

std::vector<std::string> bound_notes(const FitTask& task, const Solution& solution, double condition) {
  std::vector<std::string> words;
  for (std::size_t p = 0; p < solution.at_bound.size(); ++p) {
    if (!solution.at_bound[p]) continue;
    words.push_back(
        fmt::format("{} is at its bound {:.6g}; the unconstrained optimum lies outside, and the errors of "
                    "the other coefficients are valid only if the bound is right; {}",
                    task.parameters[p].name, solution.values[as_index(p)],
                    condition > collinear_condition
                        ? "the coefficients are nearly collinear, so fix one of them with --fix"
                        : "if the bound is too narrow, widen it in the model file"));
  }
  return words;
}

}  // namespace pcor::internal
