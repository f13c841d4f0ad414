#include "fit/solver.hpp"

#include <ceres/cost_function.h>
#include <ceres/iteration_callback.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include "fit/prior.hpp"
#include "numerics/bounded_least_squares.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t min_free_bins = 15;  // one minute: noise deviation to 20 %

void require_samples(const FitFlights& flights, std::size_t free, bool is_stage) {
  const FitSetup& setup = flights.setup();
  if (flights.samples() == 0 && !setup.regimes.empty()) {
    std::vector<std::string_view> names;
    for (const Regime regime : setup.regimes) names.push_back(info_of(regime).name);
    throw Error(
        Error::Code::samples,
        fmt::format("--stage: the flights have no {}; fit without the stage, or give the intervals in a file "
                    "with --intervals",
                    fmt::join(names, " or ")));
  }
  if (flights.samples() == 0) {
    throw Error(
        Error::Code::samples,
        fmt::format(
            "{}: no usable sample for the fit: {}; see the variables of the model and --min-airspeed, "
            "--max-flaps, --exclude",
            flights.count() == 1 ? flights.task().flights.name(0) : "the flights",
            mask_text(flights.masks())));
  }
  const std::size_t unknown = free + flights.offsets();
  if (flights.samples() <= unknown) {
    throw Error(
        Error::Code::samples,
        fmt::format("{} samples are too few for {} coefficients (not used: {}); give more flights or fix "
                    "coefficients",
                    flights.samples(), unknown, mask_text(flights.masks())));
  }
  // The noise is found from bins of four seconds; a stage has the noise of all samples.
  const std::size_t fewest = unknown + (is_stage ? 1 : min_free_bins);
  const std::size_t bins = flights.bins();
  if (bins < fewest) {
    throw Error(
        Error::Code::samples,
        fmt::format("{} samples in {} intervals of four seconds are too few for {} coefficients and their "
                    "errors, at least {} intervals required (not used: {}); give more flights or fix "
                    "coefficients",
                    flights.samples(), bins, unknown, fewest, mask_text(flights.masks())));
  }
}

Error not_finite() {
  return {Error::Code::fit,
          "the residuals are not finite at the starting coefficients of the model; give other starting "
          "values"};
}

/// Suppresses Ceres messages about failed trials on standard error; its summary has the relevant information.
class QuietLog {
 public:
  QuietLog() : before_(FLAGS_minloglevel) { FLAGS_minloglevel = google::GLOG_FATAL; }
  ~QuietLog() { FLAGS_minloglevel = before_; }
  QuietLog(const QuietLog&) = delete;
  QuietLog& operator=(const QuietLog&) = delete;

 private:
  int before_;
};

using Reduce = std::function<Reduction(const Eigen::VectorXd& unknowns)>;  // one pass over the flights

/// All flights as one residual block of a few rows: the triangular factor of the weighted derivatives and
/// residuals has the same gradient and the same normal matrix as all samples, and the last row brings the
/// cost to that of the loss.
class ReducedCost final : public ceres::CostFunction {
 public:
  ReducedCost(Reduce reduce, Eigen::Index size) : reduce_(std::move(reduce)), size_(size) {
    set_num_residuals(static_cast<int>(size) + 1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(size));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Reduction reduction = reduce_(Eigen::Map<const Eigen::VectorXd>(blocks[0], size_));
    if (!reduction.valid) return false;
    Eigen::Map<Eigen::VectorXd> all(residuals, size_ + 1);
    all.head(size_) = reduction.factor.col(size_).head(size_);
    const double rest = 2.0 * reduction.cost - all.head(size_).squaredNorm();
    all[size_] = std::sqrt(std::max(rest, 0.0));
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<ceres::Matrix> jacobian(jacobians[0], size_ + 1, size_);
      jacobian.setZero();
      jacobian.topRows(size_) = reduction.factor.topLeftCorner(size_, size_);
    }
    return true;
  }

 private:
  Reduce reduce_;
  Eigen::Index size_;
};

/// Stops at a kink of the loss, as at saturation, which limits the humidity of many samples: there the
/// derivatives no longer predict the decrease of the loss, and the steps become shorter and shorter. At a
/// bound the derivatives do not predict it either, because Ceres projects the steps: there the fit continues.
class StopAtKink final : public ceres::IterationCallback {
 public:
  /// @param x unknowns of the last successful step; x and its bounds must outlive this object
  StopAtKink(const Eigen::VectorXd& x, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
             double deviation)
      : x_(x), lower_(lower), upper_(upper), negligible_(0.5 * 0.01 * 0.01 * deviation * deviation) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    constexpr double min_predicted = 0.25;  // share of the predicted decrease
    const bool is_negligible = step.iteration > 0 && step.step_is_successful &&
                               step.relative_decrease < min_predicted && step.cost_change < negligible_;
    const bool is_inside = (x_.array() > lower_.array() && x_.array() < upper_.array()).all();
    return is_negligible && is_inside ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  const Eigen::VectorXd& x_;
  const Eigen::VectorXd& lower_;
  const Eigen::VectorXd& upper_;
  double negligible_;  ///< decrease by a hundredth of a standard error of one coefficient
};

/// The unknowns are the free parameters.
class Solver {
 public:
  Solver(FitFlights& flights, Solution from, const std::vector<std::size_t>& free, bool is_stage)
      : flights_(flights),
        task_(flights.task()),
        free_(free),
        is_stage_(is_stage),
        solution_(std::move(from)),
        prior_(prior_rows(task_, free_)),
        lower_(task_.lower(free_)),
        upper_(task_.upper(free_)) {
    set(unknowns().cwiseMax(lower_).cwiseMin(upper_));
    solution_.at_bound.resize(task_.parameters.size(), false);
  }

  Solution solve() {
    flights_.prepare(solution_.values);
    // A stage starts at a solution.
    if (!is_stage_) {
      choose_times();
      linear_step({});
      prepare_rows();
      refine();
      // The noise is that of residuals at the solution.
      constexpr int maximum = 5;
      for (int round = 0; round < maximum && flights_.has_parameter_dependent_columns(); ++round) {
        const Eigen::VectorXd before = unknowns();
        flights_.prepare(solution_.values);
        refine();
        if (has_converged(before)) break;
      }
    }
    prepare_rows();
    constexpr int rounds = 10;
    // The weight of each reference is that of its residuals at the solution.
    for (int round = 0; round < rounds && flights_.joint().size() > 1; ++round) {
      const Eigen::VectorXd before = unknowns();
      refine();
      if (has_converged(before)) break;
      prepare_rows();
    }
    for (int round = 0; round < rounds; ++round) {
      const Eigen::VectorXd before = unknowns();
      const bool has_fixed_jacobian = flights_.uses_fixed_jacobian();
      if (refine() && (!has_fixed_jacobian || has_converged(before))) break;
      if (has_fixed_jacobian) flights_.prepare(solution_.values);
    }
    find_bounds();
    return std::move(solution_);
  }

 private:
  Eigen::VectorXd unknowns() const { return solution_.values(free_); }
  void set(const Eigen::VectorXd& values) { solution_.values(free_) = values; }

  /// Chooses the time constants with the least sum of squares from their listed values: the sum may have
  /// several minima, like that of a wave shifted by more than its length.
  void choose_times() {
    for (Eigen::Index k = 0; k < lower_.size(); ++k) {
      std::vector<double> times = task_.parameters[free_[static_cast<std::size_t>(k)]].tried;
      if (times.empty()) continue;
      const Eigen::VectorXd start = unknowns();
      times.insert(times.begin(), start[k]);
      const auto [lower, upper] = std::pair(lower_[k], upper_[k]);
      std::vector<Eigen::VectorXd> solutions;
      double deviation = infinity;  // minimum of all, so that the start does not matter
      const auto put = [&](const Eigen::VectorXd& unknowns) {
        set(unknowns);
        flights_.prepare(solution_.values);
      };
      for (const double time : times) {
        if (time < lower || time > upper) continue;
        Eigen::VectorXd at = start;
        at[k] = lower_[k] = upper_[k] = time;
        put(at);
        linear_step({});
        find_deviation();
        deviation = std::min(deviation, solution_.deviation);
        solutions.push_back(unknowns());
      }
      // Outliers do not matter either.
      const ScaledLoss huber(Loss::huber, deviation);
      Eigen::VectorXd best = start;
      double minimum = infinity;
      for (const Eigen::VectorXd& solution : solutions) {
        put(solution);
        const double cost = flights_.reduce(solution_.values, huber, free_).cost;
        if (cost < minimum) best = solution;
        minimum = std::min(minimum, cost);
      }
      std::tie(lower_[k], upper_[k]) = std::pair(lower, upper);
      put(best);
    }
  }

  void prepare_rows() {
    if (is_stage_) return flights_.prepare(solution_.values);
    flights_.weigh(solution_.values);
    find_deviation();
  }

  /// The deviation of a stage of a few manoeuvres is that of all samples, as its noise is.
  void find_deviation() {
    if (!is_stage_) solution_.deviation = flights_.deviation(solution_.values);
  }

  struct Step {
    double cost = infinity;    ///< before the step, with that of the prior; infinite if it is not a number
    double length = infinity;  ///< change of the weighted residuals by the step
  };

  /// Solution of the weighted linear problem in closed form, with the weights and derivatives at the
  /// unknowns.
  Step linear_step(const ScaledLoss& loss) {
    const Reduction reduction = flights_.reduce(solution_.values, loss, free_);
    task_.report_progress();
    const Eigen::VectorXd before = unknowns();
    const Eigen::Index size = before.size();
    const Eigen::MatrixXd drawn = solution_.deviation * prior_.rows;
    Eigen::MatrixXd rows(size + drawn.rows(), size);
    Eigen::VectorXd right(rows.rows());
    rows << reduction.factor.topLeftCorner(size, size), drawn;
    right << -reduction.factor.col(size).head(size), drawn * (prior_.centre - before);
    if (!reduction.valid || !right.allFinite()) return {};
    set(bounded_least_squares(rows, right + rows * before, lower_, upper_, before));
    return {reduction.cost + 0.5 * right.tail(drawn.rows()).squaredNorm(),
            (rows * (unknowns() - before)).norm()};
  }

  /// True if no unknown moved by a hundredth of its uncertainty from flights and prior.
  bool has_converged(const Eigen::VectorXd& before) {
    const Reduction reduction = flights_.reduce(solution_.values, {}, free_);
    const Eigen::VectorXd step = unknowns() - before;
    const double by_flights = (reduction.factor.leftCols(step.size()) * step).norm();
    const double by_prior = (prior_.rows * step).norm();
    return std::max(by_flights, by_prior) < 0.01 * std::max(solution_.deviation, 1e-300);
  }

  /// Records parameters at a bound.
  void find_bounds() {
    for (Eigen::Index k = 0; k < lower_.size(); ++k) {
      const std::size_t parameter = free_[static_cast<std::size_t>(k)];
      const double value = solution_.values[as_index(parameter)];
      const double near = 1e-9 * std::max(std::abs(value), 1e-12);
      solution_.at_bound[parameter] = value <= lower_[k] + near || value >= upper_[k] - near;
    }
  }

  /// Minimises the loss; true if the deviation that scales it is then unchanged.
  bool refine() {
    const ScaledLoss scaled(task_.options.loss, solution_.deviation);
    if (flights_.rows_are_linear())
      reweight(scaled);
    else
      minimise(scaled);
    const double before = solution_.deviation;
    find_deviation();
    return std::abs(solution_.deviation - before) < 1e-3 * before;
  }

  /// Minimises the loss of linear residuals: least squares with the weights of the step before do not
  /// increase it (Huber and Ronchetti 2009, Robust Statistics, section 7.8); a step that increases it is
  /// halved.
  void reweight(const ScaledLoss& loss) {
    constexpr int max_steps = 200;
    Eigen::VectorXd best = unknowns();
    double minimum = infinity;
    for (int step = 0; step < max_steps; ++step) {
      const Eigen::VectorXd now = unknowns();
      const auto [cost, length] = linear_step(loss);
      if (!std::isfinite(cost) && !std::isfinite(minimum)) throw not_finite();
      if (cost > (1.0 + 1e-12) * minimum) {
        set(0.5 * (now + best));
        continue;
      }
      best = now;
      minimum = cost;
      if (length < 1e-6 * solution_.deviation) break;
    }
  }

  /// Minimises the loss of residuals that are not linear, with Ceres.
  void minimise(const ScaledLoss& loss) {
    Eigen::VectorXd x = unknowns();
    const auto reduce = [&](const Eigen::VectorXd& unknowns) {
      Eigen::VectorXd values = solution_.values;
      values(free_) = unknowns;
      task_.report_progress();
      return flights_.reduce(values, loss, free_);
    };
    ceres::Problem problem;
    problem.AddParameterBlock(x.data(), static_cast<int>(x.size()));
    problem.AddResidualBlock(new ReducedCost(reduce, x.size()), nullptr, x.data());
    if (prior_.rows.rows() > 0) {
      problem.AddResidualBlock(new ceres::NormalPrior(solution_.deviation * prior_.rows, prior_.centre),
                               nullptr, x.data());
    }
    for (Eigen::Index k = 0; k < x.size(); ++k) {
      const int position = static_cast<int>(k);
      if (std::isfinite(lower_[k])) problem.SetParameterLowerBound(x.data(), position, lower_[k]);
      if (std::isfinite(upper_[k])) problem.SetParameterUpperBound(x.data(), position, upper_[k]);
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    // The problem is nearly linear: the first step may reach the solution.
    options.initial_trust_region_radius = 1e12;
    options.max_num_iterations = 200;
    options.function_tolerance = 1e-12;
    options.parameter_tolerance = 1e-9;
    options.gradient_tolerance = 1e-14;
    options.logging_type = ceres::SILENT;
    StopAtKink stop(x, lower_, upper_, solution_.deviation);
    options.callbacks.push_back(&stop);
    options.update_state_every_iteration = true;
    ceres::Solver::Summary summary;
    {
      const QuietLog quiet;
      ceres::Solve(options, &problem, &summary);
    }
    if (!summary.IsSolutionUsable() || !x.allFinite()) throw not_finite();
    set(x);
  }

  FitFlights& flights_;
  const FitTask& task_;
  const std::vector<std::size_t>& free_;
  const bool is_stage_;
  Solution solution_;
  const PriorRows prior_;
  Eigen::VectorXd lower_;
  Eigen::VectorXd upper_;
};

}  // namespace

Solution solve(FitFlights& flights, Solution from, const std::vector<std::size_t>& free, bool is_stage) {
  require_samples(flights, free.size(), is_stage);
  return Solver(flights, std::move(from), free, is_stage).solve();
}

}  // namespace pcor::internal
