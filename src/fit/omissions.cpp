#include "fit/omissions.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fit/prior.hpp"
#include "numerics/bounded_least_squares.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {

SquaredResiduals::SquaredResiduals(FitFlights& flights, const Solution& solution)
    : flights_(flights), solution_(solution) {
  const std::vector<std::size_t>& requested = flights.setup().requested;
  is_linear_ = std::all_of(requested.begin(), requested.end(),
                           [&flights](std::size_t parameter) { return flights.is_linear()[parameter]; });
  if (is_linear_) factor_ = flights.unweighted_factor(solution.values);
}

double SquaredResiduals::at(const Eigen::VectorXd& values) const {
  if (!is_linear_) {
    const auto squares_of = [&](std::size_t, const FitFlight& fit) {
      const std::vector<double> residual =
          fit.residuals().values(flight_parameters(fit.residuals(), flights_.task(), values).data());
      double squares = 0.0;
      for (const std::size_t i : fit.kept()) squares += residual[i] * residual[i];
      return squares;
    };
    const std::vector<double> parts = flights_.of_each(squares_of, values);
    return std::accumulate(parts.begin(), parts.end(), 0.0);
  }
  const std::vector<std::size_t>& requested = flights_.setup().requested;
  Eigen::VectorXd step = Eigen::VectorXd::Ones(as_index(requested.size()) + 1);
  step.head(as_index(requested.size())) = values(requested) - solution_.values(requested);
  return (factor_ * step).squaredNorm();
}

double SquaredResiduals::minimum() const {
  if (!is_linear_ || flights_.task().options.fit_reference) return nan;
  const double residual_norm = factor_(factor_.rows() - 1, factor_.cols() - 1);
  return residual_norm * residual_norm;
}

std::vector<Omission> omissions(FitFlights& flights, const Solution& solution, const FitSums& sums,
                                const SquaredResiduals& squares) {
  const std::vector<std::size_t>& requested = flights.setup().requested;
  const FitTask& task = flights.task();
  const ScaledLoss loss(task.options.loss, solution.deviation);
  const Eigen::Index size = as_index(requested.size());
  const PriorRows drawn = prior_rows(task, requested);
  const Eigen::MatrixXd prior = solution.deviation * drawn.rows;
  // Rows of derivatives and residual at some coefficients, with the rows of the prior.
  const auto rows_at = [&](const Eigen::VectorXd& values) {
    Eigen::MatrixXd rows(size + prior.rows(), size + 1);
    rows.topRows(size) = flights.reduce(values, loss).factor.topRows(size);
    rows.bottomLeftCorner(prior.rows(), size) = prior;
    rows.bottomRightCorner(prior.rows(), 1) = prior * (values(requested) - drawn.centre);
    task.report_progress();
    return rows;
  };
  const Eigen::MatrixXd rows_of_fit = rows_at(solution.values);
  const auto limits = [](const ModelDefinition& model) { return std::isfinite(model.model.policy.minimum); };
  const ModelDefinition* const second = task.reference.model();
  const bool has_minimum = limits(task.model) || (second != nullptr && limits(*second));
  std::vector<Omission> result;
  for (const std::size_t parameter : requested) {
    const std::string& effect = task.parameters[parameter].effect;
    const auto is_of_effect = [&effect](const Omission& each) { return each.effect == effect; };
    if (std::any_of(result.begin(), result.end(), is_of_effect)) continue;
    std::vector<Eigen::Index> others;
    std::vector<std::size_t> parameters;  // other parameters
    Eigen::VectorXd changed = solution.values;
    for (Eigen::Index k = 0; k < size; ++k) {
      const std::size_t p = requested[static_cast<std::size_t>(k)];
      if (task.parameters[p].effect == effect) {
        changed[as_index(p)] = task.parameters[p].neutral;
      } else {
        others.push_back(k);
        parameters.push_back(p);
      }
    }
    // A linear problem needs one step from the fit to least squares; otherwise a few. A minimum of delta-p
    // may stop them, so they start again from the model without the effect.
    const auto refitted = [&](bool is_from_fit) {
      Eigen::VectorXd values = changed;
      Eigen::VectorXd x = solution.values(parameters);
      const int max_rounds = squares.is_linear() ? 1 : 8;
      for (int round = 0; round < max_rounds && !others.empty(); ++round) {
        const bool extrapolates = round == 0 && is_from_fit;
        const Eigen::MatrixXd rows = extrapolates ? rows_of_fit : rows_at(values);
        const Eigen::MatrixXd columns = rows(Eigen::all, others);
        Eigen::VectorXd right = columns * x - rows.col(size);
        if (extrapolates) right -= rows.leftCols(size) * (changed - solution.values)(requested);
        if (!right.allFinite()) break;
        const Eigen::VectorXd before = x;
        x = bounded_least_squares(columns, right, task.lower(parameters), task.upper(parameters), x);
        values(parameters) = x;
        if ((x - before).norm() < 1e-6 * x.norm()) break;
      }
      return squares.at(values);
    };
    const double from_fit = refitted(true);
    const double sum_of_squares = has_minimum ? std::fmin(from_fit, refitted(false)) : from_fit;
    result.push_back({effect, sums.rms_of(sum_of_squares), sums.r_squared(sum_of_squares)});
  }
  return result;
}

}  // namespace pcor::internal
