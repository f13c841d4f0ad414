#include "fit/solver.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include "fit/global_search.hpp"
#include "fit/minimise.hpp"
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
        lower_(as_index(free_.size())),
        upper_(lower_.size()) {
    for (Eigen::Index k = 0; k < lower_.size(); ++k) {
      const Bounds& bounds = task_.parameters[free_[static_cast<std::size_t>(k)]].bounds;
      lower_[k] = bounds.lower;
      upper_[k] = bounds.upper;
    }
    unknowns_ = solution_.values(free_).cwiseMax(lower_).cwiseMin(upper_);
    solution_.at_bound.resize(task_.parameters.size(), false);
    spread();
  }

  Solution solve() {
    if (task_.options.search) {
      unknowns_ = global_search(flights_, solution_.values, free_);
      spread();
    }
    flights_.prepare(solution_.values);
    // A stage starts at a solution.
    if (!is_stage_) {
      choose_times();
      linear_step({});
      measure();
      settles();
      // The noise is that of residuals at the solution.
      constexpr int maximum = 5;
      for (int round = 0; round < maximum && flights_.has_moving_columns(); ++round) {
        const Eigen::VectorXd before = unknowns_;
        flights_.prepare(solution_.values);
        settles();
        if (has_converged(before)) break;
      }
    }
    measure();
    constexpr int rounds = 10;
    // The weight of each reference is that of its residuals at the solution.
    for (int round = 0; round < rounds && flights_.joint().size() > 1; ++round) {
      const Eigen::VectorXd before = unknowns_;
      settles();
      if (has_converged(before)) break;
      measure();
    }
    for (int round = 0; round < rounds; ++round) {
      const Eigen::VectorXd before = unknowns_;
      const bool settled = settles();
      if (!flights_.uses_fixed_jacobian()) {
        if (settled) break;
        continue;
      }
      if (settled && has_converged(before)) break;
      flights_.prepare(solution_.values);
    }
    find_bounds();
    return std::move(solution_);
  }

 private:
  /// Writes the unknowns to their positions in the solution.
  void spread() { solution_.values(free_) = unknowns_; }

  /// Start with the least squares for each time over which a need is estimated: the sum of squares may have
  /// several minima, like a wave shifted by more than its length.
  void choose_times() {
    for (Eigen::Index k = 0; k < unknowns_.size(); ++k) {
      std::vector<double> times = task_.parameters[free_[static_cast<std::size_t>(k)]].tried;
      if (times.empty()) continue;
      times.insert(times.begin(), unknowns_[k]);
      const auto [lower, upper] = std::pair(lower_[k], upper_[k]);
      std::vector<Eigen::VectorXd> solutions;
      double deviation = infinity;  // minimum of all, so that the start does not matter
      const Eigen::VectorXd start = unknowns_;
      const auto put = [&](const Eigen::VectorXd& unknowns) {
        unknowns_ = unknowns;
        spread();
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
        solutions.push_back(unknowns_);
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

  void measure() {
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
    task_.tell();
    const Eigen::Index size = unknowns_.size();
    const Eigen::MatrixXd drawn = solution_.deviation * prior_.rows;
    Eigen::MatrixXd rows(size + drawn.rows(), size);
    Eigen::VectorXd right(rows.rows());
    rows << reduction.factor.topLeftCorner(size, size), drawn;
    right << -reduction.factor.col(size).head(size), drawn * (prior_.centre - unknowns_);
    if (!reduction.valid || !right.allFinite()) return {};
    const Eigen::VectorXd before = unknowns_;
    unknowns_ = bounded_least_squares(rows, right + rows * unknowns_, lower_, upper_, unknowns_);
    spread();
    return {reduction.cost + 0.5 * right.tail(drawn.rows()).squaredNorm(),
            (rows * (unknowns_ - before)).norm()};
  }

  /// True if no unknown moved by a hundredth of its uncertainty from flights and prior.
  bool has_converged(const Eigen::VectorXd& before) {
    const Reduction reduction = flights_.reduce(solution_.values, {}, free_);
    const Eigen::VectorXd step = unknowns_ - before;
    const double by_flights = (reduction.factor.leftCols(step.size()) * step).norm();
    const double by_prior = (prior_.rows * step).norm();
    return std::max(by_flights, by_prior) < 0.01 * std::max(solution_.deviation, 1e-300);
  }

  /// Records parameters at a bound.
  void find_bounds() {
    for (Eigen::Index k = 0; k < unknowns_.size(); ++k) {
      const double near = 1e-9 * std::max(std::abs(unknowns_[k]), 1e-12);
      solution_.at_bound[free_[static_cast<std::size_t>(k)]] =
          unknowns_[k] <= lower_[k] + near || unknowns_[k] >= upper_[k] - near;
    }
  }

  /// Minimises the loss; true if the deviation that scales it is then unchanged.
  bool settles() {
    const ScaledLoss scaled(task_.options.loss, solution_.deviation);
    if (flights_.rows_are_linear()) {
      reweight(scaled);
    } else {
      const auto reduce = [&](const Eigen::VectorXd& unknowns) {
        Eigen::VectorXd values = solution_.values;
        values(free_) = unknowns;
        task_.tell();
        return flights_.reduce(values, scaled, free_);
      };
      minimise({reduce, solution_.deviation * prior_.rows, prior_.centre, lower_, upper_}, unknowns_);
      spread();
    }
    const double before = solution_.deviation;
    find_deviation();
    return std::abs(solution_.deviation - before) < 1e-3 * before;
  }

  /// Minimises the loss of linear residuals: least squares with the weights of the step before do not
  /// increase it (Huber and Ronchetti 2009, Robust Statistics, section 7.8); a step that increases it is
  /// halved.
  void reweight(const ScaledLoss& loss) {
    constexpr int max_steps = 200;
    Eigen::VectorXd best = unknowns_;
    double minimum = infinity;
    for (int step = 0; step < max_steps; ++step) {
      const Eigen::VectorXd now = unknowns_;
      const auto [cost, length] = linear_step(loss);
      if (!std::isfinite(cost) && !std::isfinite(minimum)) {
        throw Error(Error::Code::fit,
                    "the residuals are not finite at the starting coefficients of the model; give other "
                    "starting values, "
                    "or use --search");
      }
      if (cost > (1.0 + 1e-12) * minimum) {
        unknowns_ = 0.5 * (now + best);
        spread();
        continue;
      }
      best = now;
      minimum = cost;
      if (length < 1e-6 * solution_.deviation) break;
    }
  }

  FitFlights& flights_;
  const FitTask& task_;
  const std::vector<std::size_t>& free_;
  const bool is_stage_;
  Solution solution_;
  const PriorRows prior_;
  Eigen::VectorXd unknowns_;
  Eigen::VectorXd lower_;
  Eigen::VectorXd upper_;
};

}  // namespace

Solution solve(FitFlights& flights, Solution from, const std::vector<std::size_t>& free, bool is_stage) {
  require_samples(flights, free.size(), is_stage);
  return Solver(flights, std::move(from), free, is_stage).solve();
}

}  // namespace pcor::internal
