#include "fit/global_search.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <utility>

#include <pcor/base/error.hpp>
#include "numerics/decompositions.hpp"
#include "numerics/least_cost.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr unsigned long seed = 20120106;
constexpr int trials_per_dimension = 500;

/// Least squares of a trial: searched parameters as given, linear ones solved for.
class Trial {
 public:
  Trial(FitFlights& flights, Eigen::VectorXd values, const std::vector<std::size_t>& free)
      : flights_(flights), free_(free), parameters_(std::move(values)) {
    for (std::size_t k = 0; k < free.size(); ++k) {
      (flights.is_linear()[free[k]] ? linear_ : searched_).push_back(as_index(k));
    }
    best_ = requested();
  }

  const std::vector<Eigen::Index>& searched() const { return searched_; }
  const Eigen::VectorXd& best() const { return best_; }

  double operator()(const std::vector<double>& searched) {
    for (std::size_t i = 0; i < searched.size(); ++i) parameters_[parameter(searched_[i])] = searched[i];
    const Reduction reduction = flights_.reduce(parameters_, {}, free_);
    flights_.task().tell();
    if (!reduction.valid) return infinity;
    const Eigen::VectorXd residual = reduction.factor.rightCols(1);
    double squares = residual.squaredNorm();
    Eigen::VectorXd found = requested();
    if (!linear_.empty()) {
      const Eigen::MatrixXd rows = reduction.factor(Eigen::all, linear_);
      const Eigen::VectorXd step = least_norm_solution(rows, -residual);
      squares = (residual + rows * step).squaredNorm();
      for (std::size_t i = 0; i < linear_.size(); ++i) found[linear_[i]] += step[as_index(i)];
    }
    if (squares < minimum_) {
      minimum_ = squares;
      best_ = found;
    }
    return squares;
  }

 private:
  Eigen::Index parameter(Eigen::Index k) const { return as_index(free_[static_cast<std::size_t>(k)]); }

  Eigen::VectorXd requested() const { return parameters_(free_); }

  FitFlights& flights_;
  const std::vector<std::size_t>& free_;
  Eigen::VectorXd parameters_;
  std::vector<Eigen::Index> linear_;
  std::vector<Eigen::Index> searched_;
  double minimum_ = infinity;
  Eigen::VectorXd best_;
};

}  // namespace

Eigen::VectorXd global_search(FitFlights& flights, const Eigen::VectorXd& values,
                              const std::vector<std::size_t>& free) {
  const FitTask& task = flights.task();
  Trial trial(flights, values, free);
  if (trial.searched().empty()) {
    throw Error(
        Error::Code::usage,
        "--search: the residual is linear in every free coefficient, so there is only one minimum; omit the "
        "option");
  }
  std::vector<double> lower;
  std::vector<double> upper;
  std::vector<double> start;
  for (const Eigen::Index k : trial.searched()) {
    const std::size_t position = free[static_cast<std::size_t>(k)];
    const auto& [low, high] = task.parameters[position].bounds;
    if (!std::isfinite(low) || !std::isfinite(high)) {
      const std::string& name = task.parameters[position].name;
      throw Error(Error::Code::usage,
                  fmt::format("--search: {} has no bounds to search between; give the effect "
                              "bounds = {{ {} = [lower, upper] }} in the model file",
                              name, name.substr(name.rfind('.') + 1)));
    }
    lower.push_back(low);
    upper.push_back(high);
    start.push_back(0.5 * (low + high));
  }
  nlopt::srand(seed);
  nlopt::opt search(nlopt::GN_CRS2_LM, static_cast<unsigned>(lower.size()));
  search.set_lower_bounds(lower);
  search.set_upper_bounds(upper);
  search.set_maxeval(trials_per_dimension * static_cast<int>(lower.size()));
  search.set_ftol_rel(1e-6);
  minimize_objective(search, std::ref(trial), start);
  return trial.best();
}

}  // namespace pcor::internal
