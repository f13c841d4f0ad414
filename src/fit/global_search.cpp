#include "fit/global_search.hpp"

#include <fmt/format.h>

#include <cmath>

#include <pcor/base/error.hpp>
#include "numerics/decompositions.hpp"
#include "numerics/least_cost.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr unsigned long seed = 20120106;
constexpr int trials_per_dimension = 500;

}  // namespace

Eigen::VectorXd global_search(FitFlights& flights, Eigen::VectorXd values,
                              const std::vector<std::size_t>& free) {
  const FitTask& task = flights.task();
  std::vector<std::size_t> searched;
  std::vector<Eigen::Index> linear;  // indices among the free parameters
  std::vector<double> lower;
  std::vector<double> upper;
  std::vector<double> start;
  for (std::size_t k = 0; k < free.size(); ++k) {
    if (flights.is_linear()[free[k]]) {
      linear.push_back(as_index(k));
      continue;
    }
    const auto& [low, high] = task.parameters[free[k]].bounds;
    if (!std::isfinite(low) || !std::isfinite(high)) {
      const std::string& name = task.parameters[free[k]].name;
      throw Error(Error::Code::usage,
                  fmt::format("--search: {} has no bounds to search between; give the effect "
                              "bounds = {{ {} = [lower, upper] }} in the model file",
                              name, name.substr(name.rfind('.') + 1)));
    }
    searched.push_back(free[k]);
    lower.push_back(low);
    upper.push_back(high);
    start.push_back(0.5 * (low + high));
  }
  if (searched.empty()) {
    throw Error(
        Error::Code::usage,
        "--search: the residual is linear in every free coefficient, so there is only one minimum; omit the "
        "option");
  }
  Eigen::VectorXd best = values(free);
  double minimum = infinity;
  // Least squares with the searched parameters as given and the linear ones solved for.
  const auto trial = [&](const std::vector<double>& given) {
    for (std::size_t i = 0; i < given.size(); ++i) values[as_index(searched[i])] = given[i];
    const Reduction reduction = flights.reduce(values, {}, free);
    task.tell();
    if (!reduction.valid) return infinity;
    const Eigen::VectorXd residual = reduction.factor.rightCols(1);
    double squares = residual.squaredNorm();
    Eigen::VectorXd found = values(free);
    if (!linear.empty()) {
      const Eigen::MatrixXd rows = reduction.factor(Eigen::all, linear);
      const Eigen::VectorXd step = least_norm_solution(rows, -residual);
      squares = (residual + rows * step).squaredNorm();
      found(linear) += step;
    }
    if (squares < minimum) {
      minimum = squares;
      best = found;
    }
    return squares;
  };
  nlopt::srand(seed);
  nlopt::opt search(nlopt::GN_CRS2_LM, static_cast<unsigned>(lower.size()));
  search.set_lower_bounds(lower);
  search.set_upper_bounds(upper);
  search.set_maxeval(trials_per_dimension * static_cast<int>(lower.size()));
  search.set_ftol_rel(1e-6);
  minimize_objective(search, trial, start);
  return best;
}

}  // namespace pcor::internal
