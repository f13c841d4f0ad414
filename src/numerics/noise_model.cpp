#include "numerics/noise_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "numerics/decompositions.hpp"
#include "numerics/least_cost.hpp"
#include "numerics/local_noise.hpp"
#include "numerics/parallel_for.hpp"
#include "numerics/triangular_factor.hpp"
#include "numerics/whitening.hpp"

namespace pcor::internal {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr std::size_t max_shapes = 48;
constexpr double min_period = 300.0;  // s
constexpr std::size_t min_innovations = 20;
static_assert(Binning::max_width * static_cast<double>(min_innovations) <= local_noise_time);
constexpr std::size_t min_flights = 4, max_bins = 50000;  // flights that determine the noise, and their bins
/// More bins determine the drift as well if three together are one bin, in less than a third of the time.
constexpr std::size_t many_bins = 6000;
constexpr std::size_t bins_together = 3;
constexpr double min_kept = 0.95;  // share of the bins that are in wide ones
/// Twice the logarithm of the likelihood that a slow part has to be worth.
constexpr double worth_of_a_part = 2.0;

/// The shapes of slow drift over a flight, cos(pi k t/T)/k: periods down to five minutes, at most 48.
struct DriftShapes {
  Eigen::MatrixXd columns{};
  Eigen::MatrixXd squares{};  ///< the columns' products with each other
};

DriftShapes drift_shapes(const Binning& bins) {
  DriftShapes shapes;
  if (bins.size() < 2) return shapes;
  const double begin = bins.time().front();
  const double length = bins.time().back() - begin;
  const auto by_period = static_cast<std::size_t>(2.0 * length / min_period);
  const Eigen::Index count = as_index(std::min({max_shapes, by_period, bins.size() / 15}));
  if (count == 0) return shapes;
  const Eigen::Map<const Eigen::ArrayXd> time(bins.time().data(), as_index(bins.size()));
  const Eigen::ArrayXd first = (pi * (time - begin) / length).cos();
  // Chebyshev's recursion from one cosine to the next, exact to 1e-12 up to the last.
  Eigen::ArrayXd before = first;
  Eigen::ArrayXd now = Eigen::ArrayXd::Ones(first.size());
  Eigen::VectorXd sums(2 * count + 1);
  shapes.columns.resize(first.size(), count);
  for (Eigen::Index k = 0; k < sums.size(); ++k) {
    sums[k] = now.sum();
    if (k > 0 && k <= count) shapes.columns.col(k - 1) = now / static_cast<double>(k);
    const Eigen::ArrayXd next = 2.0 * first * now - before;
    before = now;
    now = next;
  }
  // 2 cos(a) cos(b) = cos(a + b) + cos(a - b).
  shapes.squares.resize(count, count);
  for (Eigen::Index j = 1; j <= count; ++j) {
    for (Eigen::Index k = 1; k <= count; ++k) {
      shapes.squares(j - 1, k - 1) =
          (sums[j + k] + sums[std::abs(j - k)]) / (2.0 * static_cast<double>(j) * static_cast<double>(k));
    }
  }
  return shapes;
}

Eigen::VectorXd without_drift(const Binning& bins, const Eigen::VectorXd& residual) {
  auto [shapes, normal] = drift_shapes(bins);
  if (shapes.cols() == 0) return residual;
  normal.diagonal().array() += 1e-9 * normal.trace();
  const Eigen::VectorXd projected = shapes.transpose() * residual;
  return residual - shapes * symmetric_solution(normal, projected);
}

/// The residual of one of several flights, moved to the mean of all.
Eigen::VectorXd at_common_mean(const Eigen::VectorXd& residual, const NoiseModel& noise) {
  if (!noise.mean || residual.size() == 0) return residual;
  return residual.array() - (residual.mean() - *noise.mean);
}

/// Maximum order of the autoregression: the drift components describe a memory of 50 s and more.
std::size_t max_order(const std::vector<Binning>& bins) {
  double width = Binning::usual_width;
  for (const Binning& flight : bins) width = std::max(width, flight.width());
  return std::max(static_cast<std::size_t>(drift_time_constants.front() / width), std::size_t{1});
}

std::vector<double> concatenated(const std::vector<Eigen::VectorXd>& flights) {
  std::vector<double> all;
  for (const Eigen::VectorXd& flight : flights) all.insert(all.end(), flight.begin(), flight.end());
  return all;
}

/// Duration of the longest flight, s.
double longest_duration(const std::vector<Binning>& bins) {
  double longest = 0.0;
  for (const Binning& flight : bins) {
    if (flight.size() > 0) longest = std::max(longest, flight.time().back() - flight.time().front());
  }
  return longest;
}

/// The innovations of the autoregression of that noise, all at one level.
Eigen::VectorXd at_one_level(const Eigen::VectorXd& fast, const Binning& bins, const NoiseModel& noise) {
  NoiseModel even;
  even.coefficients = noise.coefficients;
  even.level = {Eigen::VectorXd::Ones(fast.size())};
  return whitened(fast, bins, even, 0);
}

Eigen::VectorXd levels_of(const Eigen::VectorXd& innovations, const Binning& bins, const NoiseModel& noise) {
  const std::vector<double>& time = bins.time();
  Eigen::VectorXd levels(innovations.size());
  for (std::size_t first = 0; first < time.size();) {
    std::size_t last = first;
    while (last < time.size() && time[last] < time[first] + local_noise_time) ++last;
    double here = noise.common_level;
    if (last - first >= min_innovations)
      here = robust_standard_deviation({innovations.data() + first, innovations.data() + last});
    const double level = local_noise_level(here, noise.common_level);
    levels.segment(as_index(first), as_index(last - first))
        .setConstant(noise.scale * (level > 0.0 ? level : 1.0));
    first = last;
  }
  return levels;
}

/// The bins of many flights in bins several times as wide; empty for few bins, or if wide bins would be too
/// wide or lose some.
std::vector<Binning> wide_bins(const std::vector<Binning>& bins) {
  std::vector<Binning> wide;
  std::size_t count = 0;
  std::size_t kept = 0;
  for (const Binning& flight : bins) {
    const double width = static_cast<double>(bins_together) * flight.width();
    if (width > Binning::max_width) return {};
    std::vector<double> time = flight.time();
    if (!time.empty()) time.front() -= 0.5 * flight.width();  // a wide bin begins where the first one begins
    wide.emplace_back(std::vector<double>(time.size()), time, flight.width(), width);
    count += flight.size();
    kept += wide.back().records().size();
  }
  if (count <= many_bins || static_cast<double>(kept) < min_kept * static_cast<double>(count)) return {};
  return wide;
}

/// The same noise in wide bins: an autoregression with the first autocovariances of means of the bins that
/// are together. The drift is taken as constant in a wide bin: its variance is too large by 7 % for 50 s, 2 %
/// for 200 s.
NoiseModel in_wide_bins(NoiseModel noise, const std::vector<Binning>& wide) {
  const std::size_t order = max_order(wide);
  const std::vector<double> fine = autocovariance(noise.coefficients, bins_together * (order + 1));
  Eigen::VectorXd means = Eigen::VectorXd::Zero(as_index(order + 1));  // autocovariance of means
  for (std::size_t lag = 0; lag <= order; ++lag) {
    for (std::size_t i = 0; i < bins_together; ++i) {
      for (std::size_t j = 0; j < bins_together; ++j) {
        const std::size_t later = bins_together * lag + j;
        means[as_index(lag)] += fine[later > i ? later - i : i - later];
      }
    }
  }
  means /= static_cast<double>(bins_together * bins_together);
  Eigen::MatrixXd covariance(as_index(order), as_index(order));
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < covariance.cols(); ++j) covariance(i, j) = means[std::abs(i - j)];
  }
  const Eigen::VectorXd later = means.tail(as_index(order));
  const Eigen::VectorXd coefficients = symmetric_solution(covariance, later);
  noise.coefficients.assign(coefficients.begin(), coefficients.end());
  const double innovation = std::sqrt(means[0] - coefficients.dot(later));
  for (std::size_t f = 0; f < wide.size(); ++f) noise.level[f] = innovation * wide[f].means(noise.level[f]);
  return noise;
}

/// The restricted likelihood of residuals after columns, as the noise model changes.
class RestrictedLikelihood {
 public:
  /// @param wide if not empty, the likelihood of the means in these bins, for the sizes of the drift: the
  /// scale of the noise is given, because the bins themselves determine it better. Bins are not copied.
  RestrictedLikelihood(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                       const std::vector<Eigen::VectorXd>& residuals, std::size_t threads,
                       const std::vector<Binning>& wide = {})
      : threads_(threads), is_wide_(!wide.empty()), bins_(is_wide_ ? wide : bins) {
    for (std::size_t f = 0; f < bins.size(); ++f) {
      Eigen::MatrixXd& all = rows_.emplace_back(as_index(bins_[f].size()), columns[f].cols() + 1);
      const auto in_bins = [&](const auto& values) -> Eigen::VectorXd {
        return is_wide_ ? bins_[f].means(values) : Eigen::VectorXd(values);
      };
      for (Eigen::Index c = 0; c < columns[f].cols(); ++c) all.col(c) = in_bins(columns[f].col(c));
      all.rightCols(1) = in_bins(residuals[f]);
      first_.push_back(count_);
      count_ += all.rows();
    }
    white_.resize(count_, rows_.front().cols());
  }

  /// Value of a noise model.
  struct Value {
    double restricted = 0.0;  ///< minus twice the logarithm of the restricted likelihood, without constants
    double plain = 0.0;  ///< the same of the likelihood with the columns at their best; unused in wide bins
    double variance = 1.0;  ///< robust variance of the innovations; in wide bins one, the given scale
  };

  Value operator()(const NoiseModel& given) {
    const NoiseModel wide = is_wide_ ? in_wide_bins(given, bins_) : NoiseModel();
    const NoiseModel& noise = is_wide_ ? wide : given;
    std::vector<double> determinants(bins_.size());
    parallel_for(bins_.size(), threads_, [&](std::size_t f) {
      const Whitening whitening(bins_[f], noise, f);
      white_.middleRows(first_[f], rows_[f].rows()) = whitening(rows_[f]);
      determinants[f] = whitening.log_determinant();
    });
    const double determinant = std::accumulate(determinants.begin(), determinants.end(), 0.0);
    const Eigen::Index width = white_.cols() - 1;
    Eigen::VectorXd innovation = white_.col(width);
    double columns = 0.0;  // the determinant of their information
    if (width > 0) {
      const Eigen::MatrixXd information = products_of(white_.leftCols(width));
      innovation -= white_.leftCols(width) *
                    pseudo_solution(information, white_.leftCols(width).transpose() * innovation);
      const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt();
      const Eigen::VectorXd inverse = scale.cwiseInverse();
      columns = 2.0 * scale.array().log().sum() +
                symmetric_eigenvalues(inverse.asDiagonal() * information * inverse.asDiagonal())
                    .cwiseMax(rank_limit)
                    .array()
                    .log()
                    .sum();
    }
    const double deviation =
        robust_standard_deviation({innovation.data(), innovation.data() + innovation.size()});
    const double limit = 9.0 * deviation * deviation;
    const double squares = innovation.array().square().min(limit).sum() / clipped_variance;
    const auto count = static_cast<double>(count_);
    const auto degrees_of_freedom = static_cast<double>(count_ - width);
    Value value;
    value.variance = is_wide_ ? 1.0 : squares / degrees_of_freedom;
    value.restricted =
        determinant + columns + (is_wide_ ? squares : degrees_of_freedom * std::log(value.variance));
    value.plain = determinant + count * std::log(squares / count);
    return value;
  }

 private:
  static constexpr double clipped_variance = 0.9950;  // variance of a standard normal variable with squares
                                                      // limited to nine

  std::size_t threads_;
  bool is_wide_;
  const std::vector<Binning>& bins_;
  std::vector<Eigen::MatrixXd> rows_;
  std::vector<Eigen::Index> first_;  // row of each flight in `white_`
  Eigen::Index count_ = 0;
  Eigen::MatrixXd white_;
};

/// The sizes of the first `parts` slow parts, of the rms of the residuals, with the least cost.
std::vector<double> least_of(const Cost& cost, std::size_t parts) {
  constexpr double maximum = 5.0;
  std::vector<double> sizes(parts, 0.0);
  if (parts < 2) return sizes;  // minutes are too short to show a drift
  std::fill(sizes.begin(), sizes.end(), 0.25);
  nlopt::opt search(nlopt::LN_BOBYQA, static_cast<unsigned>(parts));
  search.set_lower_bounds(0.0);
  search.set_upper_bounds(maximum);
  search.set_initial_step(0.2);
  search.set_xtol_abs(0.03);
  search.set_maxeval(120);
  minimize_objective(search, cost, sizes);
  return sizes;
}

/// Sizes of the drift components, relative to the rms of the residuals, and their prior probability. The two
/// components that a flight determines poorly have any of five sizes, or are absent, which is four times as
/// probable; in addition to the slower one, the next slower component has the same size or, three times as
/// probable, is absent.
struct SlowSizes {
  std::array<double, 3> slowest{};
  double prior = 1.0;
};

constexpr std::size_t first_uncertain = 2;  // index among the drift components

std::vector<SlowSizes> possible_sizes() {
  constexpr std::array<double, 6> sizes{0.0, 0.1, 0.2, 0.4, 0.8, 1.6};
  constexpr double absent = 4.0;
  constexpr double beyond = 0.3;
  std::vector<SlowSizes> possible;
  for (const double one : sizes) {
    for (const double next : sizes) {
      const double prior = one > 0.0 ? 1.0 : absent;
      possible.push_back({{one, next, 0.0}, next > 0.0 ? prior : prior * absent});
      if (next > 0.0) possible.push_back({{one, next, next}, prior * beyond});
    }
  }
  return possible;
}

}  // namespace

bool NoiseModel::has_drift() const {
  return std::any_of(drift_component_rms.begin(), drift_component_rms.end(),
                     [](double size) { return size > 0.0; });
}

NoiseModel estimate_noise(const std::vector<Binning>& bins, const std::vector<Eigen::VectorXd>& residuals) {
  NoiseModel noise;
  std::size_t count = 0;
  std::vector<Segment> segments;
  std::vector<Eigen::VectorXd> fast;
  if (bins.size() > 1) {
    const std::vector<double> all = concatenated(residuals);
    noise.mean =
        std::accumulate(all.begin(), all.end(), 0.0) / std::max(1.0, static_cast<double>(all.size()));
  }
  for (std::size_t f = 0; f < bins.size(); ++f) {
    fast.push_back(without_drift(bins[f], at_common_mean(residuals[f], noise)));
    for (const Segment& segment : bins[f].segments())
      segments.push_back({count + segment.first, segment.count});
    count += bins[f].size();
    noise.level.emplace_back(Eigen::VectorXd::Ones(fast[f].size()));
  }
  constexpr int rounds = 2;
  for (int round = 0; round < rounds; ++round) {
    std::vector<Eigen::VectorXd> scaled;
    for (std::size_t f = 0; f < bins.size(); ++f) scaled.emplace_back(fast[f].cwiseQuotient(noise.level[f]));
    noise.coefficients = autoregression(concatenated(scaled), segments, max_order(bins));
    std::vector<Eigen::VectorXd> innovations;
    for (std::size_t f = 0; f < bins.size(); ++f)
      innovations.push_back(at_one_level(fast[f], bins[f], noise));
    noise.common_level = robust_standard_deviation(concatenated(innovations));
    for (std::size_t f = 0; f < bins.size(); ++f) noise.level[f] = levels_of(innovations[f], bins[f], noise);
  }
  return noise;
}

Eigen::VectorXd noise_levels(const Binning& bins, const Eigen::VectorXd& residual, const NoiseModel& noise) {
  const Eigen::VectorXd fast = without_drift(bins, at_common_mean(residual, noise));
  return levels_of(at_one_level(fast, bins, noise), bins, noise);
}

FoundNoise find_noise(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                      const std::vector<Eigen::VectorXd>& residuals, std::size_t threads) {
  FoundNoise found{estimate_noise(bins, residuals)};
  NoiseModel& noise = found.model;
  const double rms = robust_standard_deviation(concatenated(residuals));
  if (!(rms > 0.0)) return found;
  const double longest = longest_duration(bins);
  // Drift slower than half a flight is indistinguishable from the mean of the flight.
  const auto parts =
      static_cast<std::size_t>(std::count_if(drift_time_constants.begin(), drift_time_constants.end(),
                                             [&](double time) { return time < 0.5 * longest; }));
  std::map<std::vector<double>, RestrictedLikelihood::Value> known;
  const auto value_of = [&](const std::vector<double>& sizes, RestrictedLikelihood& likelihood) {
    for (std::size_t k = 0; k < sizes.size(); ++k) noise.drift_component_rms[k] = sizes[k] * rms;
    const auto [value, is_new] = known.try_emplace(sizes);
    if (is_new) value->second = likelihood(noise);
    return value->second;
  };
  const auto sizes_by = [&](RestrictedLikelihood& likelihood) {
    known.clear();
    const auto cost = [&](const std::vector<double>& sizes) {
      return value_of(sizes, likelihood).restricted;
    };
    std::vector<double> sizes = least_of(cost, parts);
    // Parts that do not reduce the cost are removed, slowest first: flights determine the slowest part least.
    double minimum = cost(sizes);
    for (std::size_t k = sizes.size(); k-- > 0;) {
      if (sizes[k] == 0.0) continue;
      std::vector<double> without = sizes;
      without[k] = 0.0;
      const double cost_without = cost(without);
      if (!(cost_without < minimum + worth_of_a_part)) continue;
      sizes = without;
      minimum = cost_without;
    }
    return sizes;
  };
  const auto scale_levels = [&noise](double scale) {
    noise.scale *= scale;
    for (Eigen::VectorXd& level : noise.level) level *= scale;
  };
  RestrictedLikelihood likelihood(bins, columns, residuals, threads);
  const std::vector<Binning> wide = wide_bins(bins);
  std::vector<double> sizes;
  if (wide.empty()) {
    sizes = sizes_by(likelihood);
  } else {
    constexpr int max_rounds = 3;
    constexpr double notable = 0.03;  // relative change of the scale
    RestrictedLikelihood of_means(bins, columns, residuals, threads, wide);
    double scale = std::numeric_limits<double>::infinity();
    for (int round = 0; round < max_rounds && std::abs(std::log(scale)) > notable; ++round) {
      sizes = sizes_by(of_means);
      known.clear();
      scale = std::sqrt(value_of(sizes, likelihood).variance);
      scale_levels(scale);
    }
    known.clear();
  }
  found.drift_gain = value_of(std::vector<double>(sizes.size(), 0.0), likelihood).restricted;
  const RestrictedLikelihood::Value best = value_of(sizes, likelihood);
  found.drift_gain -= best.restricted;
  found.likelihood = -best.plain;
  if (wide.empty()) {
    scale_levels(std::sqrt(best.variance));
    for (double& slow : noise.drift_component_rms) slow *= noise.scale;
  }
  return found;
}

NoiseModel expected_noise(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                          const std::vector<Eigen::VectorXd>& residuals, std::size_t threads) {
  NoiseModel noise = find_noise(bins, columns, residuals, threads).model;
  const std::vector<double> all = concatenated(residuals);
  const double rms = robust_standard_deviation(all);
  if (rms == 0.0) {  // most are the same: what differs is white
    noise.scale = std::sqrt(std::inner_product(all.begin(), all.end(), all.begin(), 0.0) /
                            static_cast<double>(all.size()));
    for (Eigen::VectorXd& level : noise.level) level.setConstant(noise.scale);
  }
  // The means of several flights show drift that is slower than each of them.
  const bool shows_slower_drift = noise.mean && rms > 0.0;
  if (!noise.has_drift() && !shows_slower_drift) return noise;
  const std::vector<Binning> wide = wide_bins(bins);
  RestrictedLikelihood likelihood(bins, columns, residuals, threads, wide);
  NoiseModel tried = noise;
  std::array<double, drift_time_constants.size()> squares{};
  double variance = 0.0;
  double sum = 0.0;
  double maximum = -std::numeric_limits<double>::infinity();
  const double longest = longest_duration(bins);
  for (const SlowSizes& sizes : possible_sizes()) {
    // A drift slower than a single flight is a constant: the flight does not determine its size.
    bool is_seen = true;
    for (std::size_t k = 0; k < sizes.slowest.size(); ++k) {
      is_seen = is_seen && (shows_slower_drift || sizes.slowest[k] == 0.0 ||
                            drift_time_constants[first_uncertain + k] <= longest);
    }
    if (!is_seen) continue;
    for (std::size_t k = 0; k < sizes.slowest.size(); ++k)
      tried.drift_component_rms[first_uncertain + k] = sizes.slowest[k] * rms;
    const RestrictedLikelihood::Value value = likelihood(tried);
    const double logarithm = std::log(sizes.prior) - 0.5 * value.restricted;
    const double before = logarithm > maximum ? std::exp(maximum - logarithm) : 1.0;  // relative to the most
                                                                                      // likely one
    maximum = std::max(maximum, logarithm);
    const double weight = std::exp(logarithm - maximum);
    sum = before * sum + weight;
    variance = before * variance + weight * value.variance;
    for (std::size_t k = 0; k < squares.size(); ++k)
      squares[k] = before * squares[k] +
                   weight * value.variance * tried.drift_component_rms[k] * tried.drift_component_rms[k];
  }
  const double scale = std::sqrt(variance / sum);
  noise.scale *= scale;
  for (Eigen::VectorXd& level : noise.level) level *= scale;
  for (std::size_t k = 0; k < squares.size(); ++k) noise.drift_component_rms[k] = std::sqrt(squares[k] / sum);
  return noise;
}

std::vector<std::size_t> flights_for_noise(const std::vector<NoiseFlight>& flights, std::size_t maximum) {
  std::vector<std::size_t> all(flights.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  all.erase(std::remove_if(all.begin(), all.end(), [&](std::size_t f) { return flights[f].bins == 0; }),
            all.end());
  if (all.empty()) return flights.empty() ? all : std::vector<std::size_t>{0};
  const auto sum_of_bins = [&] {
    return std::accumulate(all.begin(), all.end(), std::size_t{0},
                           [&](std::size_t sum, std::size_t f) { return sum + flights[f].bins; });
  };
  if (all.size() > maximum || (all.size() > min_flights && sum_of_bins() > max_bins)) {
    const std::size_t bins = sum_of_bins();
    const std::size_t count = all.size();
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](std::size_t f) { return 4 * flights[f].bins * count < bins; }),
              all.end());
    maximum = std::min(maximum, std::max(min_flights, max_bins * all.size() / sum_of_bins()));
  }
  if (all.size() <= maximum) return all;
  std::stable_sort(all.begin(), all.end(),
                   [&](std::size_t a, std::size_t b) { return flights[a].begin < flights[b].begin; });
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < maximum; ++k) chosen.push_back(all[(2 * k + 1) * all.size() / (2 * maximum)]);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

NoiseModel extrapolate_drift(NoiseModel noise) {
  for (std::size_t k = 2; k < noise.drift_component_rms.size(); ++k) {
    const double before = noise.drift_component_rms[k - 1] * noise.drift_component_rms[k - 1] +
                          noise.drift_component_rms[k - 2] * noise.drift_component_rms[k - 2];
    noise.drift_component_rms[k] = std::max(noise.drift_component_rms[k], std::sqrt(0.5 * before));
  }
  return noise;
}

Eigen::MatrixXd whitened(const Eigen::Ref<const Eigen::MatrixXd>& columns, const Binning& bins,
                         const NoiseModel& noise, std::size_t flight) {
  return Whitening(bins, noise, flight)(columns);
}

}  // namespace pcor::internal
