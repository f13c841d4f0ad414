#include "campaign/gps_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <pcor/physics/constants.hpp>
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

// Median and standard deviation of the logarithm of a size.
struct Size {
  double median;
  double deviation;
};

enum WindSize : Eigen::Index { gusts, white, drift, drift_time, with_height, wander };
constexpr std::array<Size, 6> wind_sizes{
    {{1.0, 0.7}, {0.05, 0.7}, {0.5, 1.0}, {600.0, 0.7}, {0.03, 1.0}, {0.05, 0.5}}};

enum HeightSize : Eigen::Index { value, value_with_height, gps, warmth, pressure };
constexpr std::array<Size, 5> height_sizes{{{0.05, 1.0}, {0.02, 1.0}, {0.2, 0.7}, {0.3, 0.7}, {0.02, 0.7}}};

constexpr std::array<double, 3> gust_times{2.0, 8.0, 32.0};  // s

const Size& size_of(GpsKind kind, Eigen::Index k) {
  const auto position = static_cast<std::size_t>(k);
  return kind == GpsKind::wind ? wind_sizes[position] : height_sizes[position];
}

double stays_for(double seconds, double time) { return std::exp(-seconds / time); }

WhiteRows white_wind(const Eigen::VectorXd& sizes, const GpsRows& rows, const Eigen::VectorXd& more) {
  // gusts, drift and height walk of the east wind, then of the north wind, and the heading
  constexpr int of_each = 5;
  constexpr int count = 2 * of_each + 1;
  using States = LatentFilter<count>::States;
  constexpr double wander_time = 120.0;  // s
  constexpr double wind = 20.0;          // m/s
  States variance = States::Ones();
  for (int component = 0; component < 2; ++component) {
    variance[component * of_each + 3] = sizes[drift] * sizes[drift];
    variance[component * of_each + 4] = wind * wind;
  }
  variance[count - 1] = sizes[wander] * sizes[wander];
  const Eigen::Index size = as_index(rows.time.size());
  LatentFilter<count> filter(variance, rows.rows.cols(), 2 * size);
  const double noise = sizes[white] * sizes[white];
  const double walk = sizes[with_height] * sizes[with_height];
  std::array<double, 3> gust_sizes{};  // deviation of each process for gusts of 1 m/s in one second
  for (std::size_t g = 0; g < gust_times.size(); ++g)
    gust_sizes[g] = sizes[gusts] * std::pow(gust_times[g], 1.0 / 3.0);
  States stays = States::Ones();
  States added = States::Zero();
  double passed_before = 0.0;
  double before = rows.time.empty() ? 0.0 : rows.time.front();
  double risen = 0.0;
  const auto last = rows.rows.cols() - 1;
  for (Eigen::Index i = 0; i < size; ++i) {
    const auto sample = static_cast<std::size_t>(i);
    risen += std::abs(rows.rise[sample]);
    if (std::isnan(rows.rows(i, last))) continue;
    const double passed = rows.time[sample] - before;
    before = rows.time[sample];
    if (passed > 0.0) {
      // Most steps are of one length.
      if (passed != passed_before) {
        passed_before = passed;
        for (int component = 0; component < 2; ++component) {
          const int first = component * of_each;
          for (int g = 0; g < 3; ++g)
            stays[first + g] = stays_for(passed, gust_times[static_cast<std::size_t>(g)]);
          stays[first + 3] = stays_for(passed, sizes[drift_time]);
          stays[first + 4] = 1.0;
        }
        stays[count - 1] = stays_for(passed, wander_time);
        added = variance.cwiseProduct(States::Ones() - stays.cwiseAbs2());
      }
      added[4] = added[of_each + 4] = walk * risen;
      filter.pass(stays, added);
      risen = 0.0;
    }
    const double gust = std::sqrt(rows.level[sample]);
    for (int component = 0; component < 2; ++component) {
      const int first = component * of_each;
      States by = States::Zero();
      for (int g = 0; g < 3; ++g) by[first + g] = gust * gust_sizes[static_cast<std::size_t>(g)];
      by[first + 3] = by[first + 4] = 1.0;
      const double across = component == 0 ? rows.north[sample] : -rows.east[sample];
      by[count - 1] = rows.airspeed[sample] * across * constants::radians_per_degree;
      const Eigen::Index row = component * size + i;
      filter.read(row, rows.rows.row(row), by, noise + more[row]);
    }
  }
  return std::move(filter.white());
}

WhiteRows white_height(const Eigen::VectorXd& sizes, const GpsRows& rows, const Eigen::VectorXd& more) {
  constexpr int count = 3;
  using States = LatentFilter<count>::States;
  constexpr double gps_time = 60.0;      // s
  constexpr double warmth_time = 900.0;  // s
  constexpr double unknown = 1e6;        // m2
  constexpr double noise = 0.01;         // m2
  const States variance(unknown, sizes[gps] * sizes[gps], sizes[warmth] * sizes[warmth]);
  LatentFilter<count> filter(variance, rows.rows.cols(), rows.rows.rows());
  const auto last = rows.rows.cols() - 1;
  double before = rows.time.empty() ? 0.0 : rows.time.front();
  double walked = 0.0;
  for (Eigen::Index i = 0; i < rows.rows.rows(); ++i) {
    const auto sample = static_cast<std::size_t>(i);
    const double passed = rows.time[sample] - before;
    before = rows.time[sample];
    if (rows.is_break[sample]) walked += unknown;
    const double rise = rows.rise[sample];
    if (passed > 0.0) {
      const double gps_stays = stays_for(passed, gps_time);
      const double warmth_stays = stays_for(passed, warmth_time);
      const double walk = sizes[value] * sizes[value] * passed +
                          sizes[value_with_height] * sizes[value_with_height] * std::abs(rise) + walked;
      walked = 0.0;
      filter.couple(0, 2, rise * rows.warmth[sample]);
      filter.pass({1.0, gps_stays, warmth_stays}, {walk, variance[1] * (1.0 - gps_stays * gps_stays),
                                                   variance[2] * (1.0 - warmth_stays * warmth_stays)});
    }
    if (std::isnan(rows.rows(i, last))) continue;
    const double by_pressure = sizes[pressure] * rows.thickness[sample];
    filter.read(i, rows.rows.row(i), States(1.0, 1.0, 0.0), noise + by_pressure * by_pressure + more[i]);
  }
  return std::move(filter.white());
}

WhiteRows white_at(const Eigen::VectorXd& logarithms, const GpsRows& rows, const Eigen::VectorXd& more) {
  const Eigen::VectorXd sizes = logarithms.array().exp();
  return rows.kind == GpsKind::wind ? white_wind(sizes, rows, more) : white_height(sizes, rows, more);
}

/// Fit of the columns of whitened rows, with their prior.
struct ColumnFit {
  Eigen::VectorXd coefficients{};  // most likely ones
  double deviance = 0.0;           // minus twice the log likelihood, up to a constant
};

ColumnFit fit_of(const WhiteRows& white, const GpsPrior& prior) {
  const Eigen::Index count = white.rows.cols() - 1;
  const Eigen::MatrixXd products = products_of(white.rows);
  // In units of the prior the matrix does not depend on the units of the columns.
  const Eigen::VectorXd& unit = prior.deviation;
  Eigen::MatrixXd matrix = unit.asDiagonal() * products.topLeftCorner(count, count) * unit.asDiagonal();
  matrix.diagonal().array() += 1.0;
  const Eigen::VectorXd mean = prior.mean.cwiseQuotient(unit);
  const Eigen::VectorXd right = unit.cwiseProduct(products.col(count).head(count)) + mean;
  const Cholesky factor(matrix);
  const Eigen::VectorXd best = factor.solve(right);
  return {unit.cwiseProduct(best), white.log_determinant + products(count, count) + mean.squaredNorm() -
                                       right.dot(best) + factor.log_determinant()};
}

/// Whitened residual after the fit of columns with these coefficients.
Eigen::VectorXd residuals_of(const WhiteRows& white, const Eigen::VectorXd& coefficients) {
  const Eigen::Index count = coefficients.size();
  return white.rows.col(count) - white.rows.leftCols(count) * coefficients;
}

/// Minus the log likelihood of the sizes, with the priors, and what it follows from.
struct Trial {
  Eigen::VectorXd logarithms{};
  WhiteRows white{};
  Eigen::VectorXd coefficients{};  // most likely ones at these sizes
  double cost = 0.0;               // up to a constant

  /// Logarithms of the variances of the innovations; zero where a row has no value.
  Eigen::ArrayXd log_variances() const {
    return (white.variance.array() > 0.0).select(white.variance.array(), 1.0).log();
  }
};

Trial trial_at(const Eigen::VectorXd& logarithms, const GpsRows& rows, const Eigen::VectorXd& more,
               const GpsPrior& prior) {
  Trial trial{logarithms, white_at(logarithms, rows, more)};
  const ColumnFit fit = fit_of(trial.white, prior);
  trial.coefficients = fit.coefficients;
  trial.cost = fit.deviance;
  for (Eigen::Index k = 0; k < logarithms.size(); ++k) {
    const Size& size = size_of(rows.kind, k);
    const double off = (logarithms[k] - std::log(size.median)) / size.deviation;
    trial.cost += off * off;
  }
  trial.cost *= 0.5;
  return trial;
}

/// Gradient of the cost and Fisher information of the sizes, with the priors, by forward differences (Harvey
/// 1989, section 3.4.5). The information is that with known coefficients.
struct Slope {
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
};

Slope slope_at(const Trial& trial, const GpsRows& rows, const Eigen::VectorXd& more, const GpsPrior& prior) {
  constexpr double step = 1e-3;
  const Eigen::Index count = trial.logarithms.size();
  const Eigen::ArrayXd variances = trial.log_variances();
  const Eigen::VectorXd residuals = residuals_of(trial.white, trial.coefficients);
  Slope slope{Eigen::VectorXd(count), {}};
  Eigen::MatrixXd by_variance(residuals.size(), count);
  Eigen::MatrixXd by_mean(residuals.size(), count);  // innovations in units of their deviation
  for (Eigen::Index k = 0; k < count; ++k) {
    Eigen::VectorXd moved = trial.logarithms;
    moved[k] += step;
    const Trial beside = trial_at(moved, rows, more, prior);
    slope.gradient[k] = (beside.cost - trial.cost) / step;
    by_variance.col(k) = (beside.log_variances() - variances) / step;
    by_mean.col(k) = (residuals_of(beside.white, trial.coefficients) - residuals) / step +
                     0.5 * residuals.cwiseProduct(by_variance.col(k));
  }
  slope.information = 0.5 * by_variance.transpose() * by_variance + by_mean.transpose() * by_mean;
  for (Eigen::Index k = 0; k < count; ++k)
    slope.information(k, k) += std::pow(size_of(rows.kind, k).deviation, -2.0);
  return slope;
}

}  // namespace

GpsNoise::GpsNoise(GpsKind kind)
    : logarithms_(as_index(kind == GpsKind::wind ? wind_sizes.size() : height_sizes.size())) {
  for (Eigen::Index k = 0; k < logarithms_.size(); ++k) logarithms_[k] = std::log(size_of(kind, k).median);
}

WhiteRows GpsNoise::white(const GpsRows& rows, const Eigen::VectorXd& more) const {
  return white_at(logarithms_, rows, more);
}

void GpsNoise::maximise(const GpsRows& rows, const Eigen::VectorXd& more, const GpsPrior& prior) {
  constexpr int max_steps = 15;
  // Half a unit of the logarithm of the likelihood is one standard deviation of a size.
  constexpr double enough = 0.02;
  Trial trial = trial_at(logarithms_, rows, more, prior);
  if (!std::isfinite(trial.cost)) return;
  for (int number = 0; number < max_steps; ++number) {
    const Slope slope = slope_at(trial, rows, more, prior);
    Eigen::VectorXd step = symmetric_solution(slope.information, Eigen::VectorXd(-slope.gradient));
    const double expected = -0.5 * slope.gradient.dot(step);
    if (!(expected > enough)) break;
    // The information is that of small steps: no size changes by more than a factor of e.
    step /= std::max(1.0, step.cwiseAbs().maxCoeff());
    constexpr int max_halvings = 5;
    Trial next = trial_at(trial.logarithms + step, rows, more, prior);
    for (int halving = 0; halving < max_halvings && !(next.cost < trial.cost); ++halving) {
      step *= 0.5;
      next = trial_at(trial.logarithms + step, rows, more, prior);
    }
    if (!(next.cost < trial.cost)) break;
    trial = std::move(next);
  }
  logarithms_ = trial.logarithms;
}

void widen(GpsPrior& prior, const WhiteRows& white) {
  for (Eigen::Index k = 0; k < prior.deviation.size(); ++k) {
    if (prior.deviation[k] > 0.0) continue;
    const double length = white.rows.col(k).norm();
    prior.deviation[k] = length > 0.0 ? 100.0 / length : 1.0;
  }
}

bool find_outliers(const WhiteRows& white, const GpsPrior& prior, Eigen::VectorXd& more) {
  constexpr double limit = 4.5;
  constexpr double wider = 100.0;
  const Eigen::VectorXd news = residuals_of(white, fit_of(white, prior).coefficients);
  bool any = false;
  for (Eigen::Index i = 0; i < news.size(); ++i) {
    if (!(std::abs(news[i]) > limit)) continue;
    more[i] = wider * news[i] * news[i] * white.variance[i];
    any = true;
  }
  return any;
}

}  // namespace pcor::internal
