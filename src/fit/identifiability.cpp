#include "fit/identifiability.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include <pcor/base/error.hpp>
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

bool sees_static_defect(const FitTask& task) {
  return task.reference.sees_static_defect() ||
         std::any_of(task.further.begin(), task.further.end(), sees_static_defect);
}

// Flights hold 32-bit floats: columns that agree to better than their rounding, 6e-8, are one column.
constexpr double hopeless_condition = 1e7;
// Condition number of scaled columns; eq. 20 of the memo with an independent Mach number has 1400 on a flight
// with speed runs.
constexpr double collinear_condition = 300.0;
// A standard error above this share of an effect's typical size is reported.
constexpr double weak_share = 0.25;

}  // namespace

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
          fmt::format(
              "{} has no influence on these flights, so it cannot be fitted; fix it: --fix {}{}",
              to_string(k), to_string(k),
              !sees_static_defect(task)
                  ? ", or add a reference other than total: to fit delta-p, which a total "
                    "pressure does not contain"
              : task.model.model.policy.minimum > -infinity
                  ? fmt::format(", unless delta-p is at its minimum, {:g} hPa, because the reference is "
                                "far below the model: see the bias by compare",
                                task.model.model.policy.minimum)
                  : ""));
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
    words.push_back(fmt::format(
        "{0} is {1}, {2:.3g} +- {3:.2g} (typical size {4:.2g}): --fix {0} fixes it; to determine it: "
        "{5}{6}{7}",
        parameter.name, error > parameter.typical ? "not determined" : "weakly determined",
        solution.values[as_index(position)], error, parameter.typical, parameter.manoeuvre,
        partners.empty() ? "" : "; it is correlated with ", partners));
  }
  if (condition > collinear_condition) {
    words.push_back(fmt::format(
        "do not interpret one coefficient alone: they are nearly collinear (condition number {:.0f}); "
        "their sum is better determined than each",
        condition));
  }
  const bool has_manoeuvre = flown[static_cast<std::size_t>(Regime::pitch_manoeuvre)] ||
                             flown[static_cast<std::size_t>(Regime::yaw_manoeuvre)] ||
                             flown[static_cast<std::size_t>(Regime::speed_run)];
  if (flown.any() && !has_manoeuvre) {
    words.emplace_back(
        "coefficients may absorb missing effects: add a flight with a pitch or yaw manoeuvre or a speed run; "
        "these flights lack them; in climbs, angle of attack, Mach number and weight are correlated");
  }
  return words;
}

std::vector<std::string> bound_notes(const FitTask& task, const Solution& solution, double condition) {
  std::vector<std::string> words;
  for (std::size_t p = 0; p < solution.at_bound.size(); ++p) {
    if (!solution.at_bound[p]) continue;
    words.push_back(fmt::format(
        "{} is at its bound {:.6g}: {}; the unconstrained optimum lies outside, and the errors of "
        "the other coefficients are valid only if the bound is right",
        task.parameters[p].name, solution.values[as_index(p)],
        condition > collinear_condition ? "fix one of the nearly collinear coefficients with --fix"
                                        : "widen the bound in the model file if it is too narrow"));
  }
  return words;
}

}  // namespace pcor::internal
