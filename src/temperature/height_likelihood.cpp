#include "temperature/height_likelihood.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "numerics/decompositions.hpp"
#include "numerics/least_cost.hpp"
#include "numerics/missing.hpp"
#include "numerics/parallel_for.hpp"
#include "numerics/triangular_factor.hpp"
#include "parallel/flight_partition.hpp"
#include "temperature/height_least_squares.hpp"

namespace pcor::internal {
namespace {

// The states, in their order.
enum HeightState : Eigen::Index { drift, wander, slope_east, slope_north, state_count };

// Columns of the filter: the height, and the columns of the unknowns.
constexpr Eigen::Index filtered = 1 + height_unknowns;
using Covariance = Eigen::Matrix<double, state_count, state_count>;
using Vector = Eigen::Matrix<double, state_count, 1>;
using Means = Eigen::Matrix<double, state_count, filtered>;
using Row = Eigen::Matrix<double, 1, filtered>;

constexpr double unknown_height = 1e8;  // m2: the variance of a height that is not known

/// Means over a block of correlated noise, given its value at the start: exact for a block of any length.
/// From the start on the noise decays, and its mean contains a part of the start.
struct BlockMean {
  double fading;      // decay over the block
  double kept;        // part of the start in the mean
  double variance;    // variance of the noise at the end, given its start
  double of_mean;     // variance of the mean, given the start
  double covariance;  // covariance of the noise at the end and the mean

  BlockMean(double sigma, double memory, double length) {
    const double ratio = memory / length;
    const double square = sigma * sigma;
    fading = std::exp(-1.0 / ratio);
    kept = ratio * (1.0 - fading);
    variance = square * (1.0 - fading * fading);
    of_mean = square * ratio * (2.0 - ratio * (3.0 - fading * (4.0 - fading)));
    covariance = square * ratio * (1.0 - fading) * (1.0 - fading);
  }
};

/// Filter over one flight; passes the innovations of every block and their variance to `see`. Heights are
/// means over blocks, so changes of the states within a block affect its height too.
template <class See>
void filter(const HeightRecord& record, const HeightNoise& noise, const HeightPrior& prior, const See& see) {
  Covariance p = Covariance::Zero();
  Means x = Means::Zero();
  p(wander, wander) = noise.wander * noise.wander;
  const double slope = prior.slope * record.slope_fraction;
  p(slope_east, slope_east) = p(slope_north, slope_north) = slope * slope;
  const bool has_slopes = slope > 0.0;
  const double walk = noise.walk * noise.walk;
  const auto fade = [&](double fading, double variance) {
    x.row(wander) *= fading;
    p.row(wander) *= fading;
    p.col(wander) *= fading;
    p(wander, wander) += variance;
  };
  const HeightBlock* before = nullptr;
  for (const HeightBlock& block : record.blocks) {
    if (before != nullptr) {
      const double gap = block.time - before->time - 0.5 * (block.length + before->length);
      if (gap > 0.0) {
        const double fading = std::exp(-gap / noise.wander_time);
        fade(fading, noise.wander * noise.wander * (1.0 - fading * fading));
        p(drift, drift) += walk * gap;
      }
    }
    if (before != nullptr && has_slopes) {
      // The drift moves by slope times way; first the slopes' uncertainty reaches it.
      const double to_east = block.east - before->east;
      const double to_north = block.north - before->north;
      x.row(drift) += to_east * x.row(slope_east) + to_north * x.row(slope_north);
      p.row(drift) += to_east * p.row(slope_east) + to_north * p.row(slope_north);
      p.col(drift) += to_east * p.col(slope_east) + to_north * p.col(slope_north);
      const double change = noise.slope_change * noise.slope_change * (block.time - before->time);
      p(slope_east, slope_east) += change;
      p(slope_north, slope_north) += change;
    }
    if (block.starts_segment) {
      p.row(drift).setZero();
      p.col(drift).setZero();
      p(drift, drift) = unknown_height;
      x.row(drift).setZero();
    }
    before = &block;

    const BlockMean slow(noise.wander, noise.wander_time, block.length);
    Vector seen = Vector::Zero();
    seen(drift) = 1.0;
    seen(wander) = slow.kept;
    Vector reached = p * seen;
    const double variance = seen.dot(reached) + slow.of_mean + walk * block.length / 3.0 +
                            noise.white * noise.white / static_cast<double>(block.samples);
    Row measured;
    measured << block.excess, block.columns.transpose();
    const Row innovation = measured - seen.transpose() * x;
    see(block, innovation, variance);

    // Propagated to the end of the block, including correlations with the measured mean.
    fade(slow.fading, slow.variance);
    p(drift, drift) += walk * block.length;
    reached(wander) = reached(wander) * slow.fading + slow.covariance;
    reached(drift) += 0.5 * walk * block.length;
    const Vector gain = reached / variance;
    x.noalias() += gain * innovation;
    p.noalias() -= gain * reached.transpose();
  }
}

/// Parameters of the noise as the search sees them: logarithms, within bounds. Noise below the least does not
/// matter: over a flight it moves heights by centimetres.
constexpr std::array searched{&HeightNoise::white, &HeightNoise::wander, &HeightNoise::wander_time,
                              &HeightNoise::walk, &HeightNoise::slope_change};
constexpr HeightNoise lower_noise{1e-2, 1e-3, 15.0, 1e-4, 1e-9};
constexpr HeightNoise upper_noise{100.0, 30.0, 1200.0, 3.0, 1e-5};

std::vector<double> as_logarithms(const HeightNoise& noise) {
  std::vector<double> x;
  for (const auto value : searched)
    x.push_back(std::log(std::clamp(noise.*value, lower_noise.*value, upper_noise.*value)));
  return x;
}

HeightNoise as_noise(const std::vector<double>& x) {
  HeightNoise noise;
  for (std::size_t i = 0; i < searched.size(); ++i) noise.*searched[i] = std::exp(x[i]);
  return noise;
}

/// -2 ln of the restricted likelihood, the coefficients at their best.
double restricted_deviance(const HeightEquations& equations, Eigen::Index terms) {
  return equations.deviance(terms) + equations.log_information(terms);
}

using Logarithms = Eigen::Matrix<double, searched.size(), 1>;

/// The restricted likelihood at some noise.
struct NoisePoint {
  Logarithms x;
  HeightEquations equations;
  double rise = 0.0;  // increase of -2 ln L from its minimum, including the prior
};

/// One standard deviation of the noise to both sides along each principal axis of -2 ln L.
std::vector<std::array<NoisePoint, 2>> standard_deviations_of_noise(const std::vector<HeightRecord>& records,
                                                                    Eigen::Index terms,
                                                                    const HeightPrior& prior,
                                                                    const MostLikely& likely,
                                                                    const Workers& workers) {
  const Logarithms centre = Eigen::Map<const Logarithms>(as_logarithms(likely.noise).data());
  const Logarithms lower = Eigen::Map<const Logarithms>(as_logarithms(lower_noise).data());
  const Logarithms upper = Eigen::Map<const Logarithms>(as_logarithms(upper_noise).data());
  const auto at = [&](const Logarithms& x) {
    NoisePoint point;
    point.x = x.cwiseMax(lower).cwiseMin(upper);
    point.equations = height_equations(records, as_noise({point.x.begin(), point.x.end()}), prior, workers);
    // Irrelevant noise components have no lower limit: all have a prior of a factor of 4.5.
    constexpr double known_to = 1.5;
    point.rise = restricted_deviance(point.equations, terms) - likely.deviance +
                 (point.x - centre).squaredNorm() / (known_to * known_to);
    if (!std::isfinite(point.rise)) point.rise = std::numeric_limits<double>::max();
    return point;
  };
  // Distance along `direction` at which -2 ln L is 1 above its minimum, to 20 %, in `trials`; or the distance
  // to a bound.
  const auto rise_by_one = [&](const Logarithms& direction, double distance, int trials) {
    constexpr double min_rise = 1e-3;
    NoisePoint point = at(centre + distance * direction);
    for (int trial = 1; trial < trials && std::abs(point.rise - 1.0) > 0.2; ++trial) {
      distance *= std::clamp(1.0 / std::sqrt(std::max(point.rise, min_rise)), 0.25, 4.0);
      point = at(centre + distance * direction);
    }
    return point;
  };
  // Along one parameter each, towards the middle of its bounds, to a rise of about 1.
  constexpr double first_step = 0.2;
  Logarithms step;
  Eigen::Matrix<double, searched.size(), searched.size()> rises;
  for (Eigen::Index i = 0; i < step.size(); ++i) {
    const double inwards = 2.0 * centre[i] < lower[i] + upper[i] ? 1.0 : -1.0;
    const NoisePoint point = rise_by_one(Logarithms::Unit(i) * inwards, first_step, 3);
    step[i] = point.x[i] - centre[i];
    rises(i, i) = point.rise;
  }
  // The rise as a quadratic form of these steps, with no curvature that differences made too small.
  constexpr double min_curvature = 0.05;
  for (Eigen::Index i = 0; i < step.size(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      Logarithms both = centre;
      both[i] += step[i];
      both[j] += step[j];
      rises(i, j) = rises(j, i) = 0.5 * (at(both).rise - rises(i, i) - rises(j, j));
    }
  }
  const SymmetricEigen axes(rises);
  std::vector<std::array<NoisePoint, 2>> result;
  for (Eigen::Index k = 0; k < step.size(); ++k) {
    const double curvature = std::max(axes.eigenvalues()[k], min_curvature);
    const Logarithms axis = step.cwiseProduct(axes.eigenvectors().col(k)) / std::sqrt(curvature);
    result.push_back({rise_by_one(axis, 1.0, 2), rise_by_one(-axis, 1.0, 2)});
  }
  return result;
}

/// Which unknowns there are: the coefficients of the first `terms` powers, and errors that have a size.
std::vector<Eigen::Index> free_unknowns(const HeightUnknowns& sizes, Eigen::Index terms) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < height_unknowns; ++k) {
    if (k < terms || sizes[k] > 0.0) free.push_back(k);
  }
  return free;
}

/// Covariance of the free unknowns, which have different units.
Eigen::MatrixXd free_covariance(HeightEquations::Matrix information, const HeightUnknowns& sizes,
                                const std::vector<Eigen::Index>& free) {
  if (free.empty()) return {};
  for (Eigen::Index k = 0; k < height_unknowns; ++k) {
    if (sizes[k] > 0.0) information(k, k) += 1.0 / (sizes[k] * sizes[k]);
  }
  const Eigen::MatrixXd inverse = scaled_inverse(information(free, free));
  return 0.5 * (inverse + inverse.transpose());
}

}  // namespace

HeightEquations& HeightEquations::operator+=(const HeightEquations& other) {
  information += other.information;
  right += other.right;
  sizes = other.sizes;
  squares += other.squares;
  log_determinant += other.log_determinant;
  return *this;
}

HeightEquations::Matrix HeightEquations::covariance_of_unknowns(Eigen::Index terms) const {
  const std::vector<Eigen::Index> free = free_unknowns(sizes, terms);
  Matrix result = Matrix::Zero();
  result(free, free) = free_covariance(information, sizes, free);
  return result;
}

HeightUnknowns HeightEquations::best_unknowns(Eigen::Index terms) const {
  return covariance_of_unknowns(terms) * right;
}

Eigen::MatrixXd HeightEquations::covariance(Eigen::Index terms) const {
  return covariance_of_unknowns(terms).topLeftCorner(terms, terms);
}

Eigen::VectorXd HeightEquations::best(Eigen::Index terms) const { return best_unknowns(terms).head(terms); }

double HeightEquations::log_information(Eigen::Index terms) const {
  const std::vector<Eigen::Index> free = free_unknowns(sizes, terms);
  if (free.empty()) return 0.0;
  return -Cholesky(free_covariance(information, sizes, free)).log_determinant();
}

double HeightEquations::deviance_of_heights(const HeightUnknowns& all) const {
  return log_determinant + squares - 2.0 * all.dot(right) + all.dot(information * all);
}

double HeightEquations::deviance_at(const Eigen::VectorXd& a) const {
  // The other errors are optimised for these coefficients.
  HeightUnknowns all = HeightUnknowns::Zero();
  all.head(a.size()) = a;
  HeightEquations conditional = *this;
  conditional.right -= information * all;
  const HeightUnknowns errors = conditional.best_unknowns(0);
  all += errors;
  double of_prior = 0.0;
  for (Eigen::Index k = 0; k < height_unknowns; ++k) {
    if (sizes[k] > 0.0) of_prior += errors[k] * errors[k] / (sizes[k] * sizes[k]);
  }
  return deviance_of_heights(all) + of_prior;
}

double HeightEquations::deviance(Eigen::Index terms) const { return deviance_at(best(terms)); }

HeightEquations height_equations(const HeightRecord& record, const HeightNoise& noise,
                                 const HeightPrior& prior) {
  HeightEquations result;
  result.sizes = prior.sizes;
  filter(record, noise, prior, [&](const HeightBlock& block, const Row& innovation, double variance) {
    if (block.starts_segment) return;  // this block only determines the unknown initial height
    const double weight = 1.0 / variance;
    const HeightUnknowns columns = innovation.tail<height_unknowns>().transpose();
    result.information.noalias() += weight * columns * columns.transpose();
    result.right += weight * innovation(0) * columns;
    result.squares += weight * innovation(0) * innovation(0);
    result.log_determinant += std::log(variance);
  });
  return result;
}

std::vector<double> height_innovations(const HeightRecord& record, const HeightNoise& noise,
                                       const HeightPrior& prior, const HeightUnknowns& all) {
  std::vector<double> result;
  filter(record, noise, prior, [&](const HeightBlock& block, const Row& innovation, double variance) {
    const double residual = innovation(0) - innovation.tail<height_unknowns>().dot(all);
    result.push_back(block.starts_segment ? nan : residual / std::sqrt(variance));
  });
  return result;
}

HeightRecord without_unknowns(HeightRecord record, const HeightUnknowns& all) {
  for (HeightBlock& block : record.blocks) {
    for (Eigen::Index k = 0; k < height_unknowns; ++k) block.excess -= all[k] * block.columns[k];
  }
  return record;
}

HeightEquations height_equations(const std::vector<HeightRecord>& records, const HeightNoise& noise,
                                 const HeightPrior& prior, const Workers& workers) {
  std::vector<std::uint64_t> sizes;
  for (const HeightRecord& record : records) sizes.push_back(record.blocks.size());
  const FlightPartition partition(workers.comm, sizes);
  const auto each = partition.all_gather_parts<HeightEquations>([&](std::vector<HeightEquations>& parts) {
    parallel_for(records.size(), workers.threads, [&](std::size_t i) {
      if (partition.is_local(i)) parts[i] = height_equations(records[i], noise, prior);
    });
  });
  HeightEquations sum;
  sum.sizes = prior.sizes;
  for (const HeightEquations& one : each) sum += one;
  return sum;
}

MostLikely maximise_likelihood(const std::vector<HeightRecord>& records, Eigen::Index terms,
                               const HeightPrior& prior, const HeightNoise& start, const Workers& workers) {
  MostLikely best;
  best.deviance = std::numeric_limits<double>::infinity();
  const Cost deviance = [&](const std::vector<double>& x) {
    const HeightNoise noise = as_noise(x);
    const HeightEquations equations = height_equations(records, noise, prior, workers);
    const double value = restricted_deviance(equations, terms);
    if (!std::isfinite(value)) return std::numeric_limits<double>::max();
    if (value < best.deviance) {
      best.deviance = value;
      best.noise = noise;
      best.equations = equations;
    }
    return value;
  };
  std::vector<double> x = as_logarithms(start);
  // BOBYQA finds the valley; a restart from its end corrects steps that stopped at a bound.
  constexpr int rounds = 2;
  for (int round = 0; round < rounds; ++round) {
    nlopt::opt search(nlopt::LN_BOBYQA, static_cast<unsigned>(x.size()));
    search.set_lower_bounds(as_logarithms(lower_noise));
    search.set_upper_bounds(as_logarithms(upper_noise));
    search.set_initial_step(1.0);
    // If the slope of isobars and the walk are nearly confounded the valley is flat: a small gain of one
    // trial does not indicate its minimum, but trials that are close together do.
    search.set_xtol_abs(1e-3);
    search.set_maxeval(1000);
    minimize_objective(search, deviance, x);
    x = as_logarithms(best.noise);
  }
  return best;
}

Eigen::MatrixXd covariance_over_noise(const std::vector<HeightRecord>& records, Eigen::Index terms,
                                      const HeightPrior& prior, const MostLikely& likely,
                                      const Workers& workers) {
  Eigen::MatrixXd covariance = likely.equations.covariance(terms);
  Eigen::MatrixXd more = Eigen::MatrixXd::Zero(terms, terms);
  for (const auto& [above, below] : standard_deviations_of_noise(records, terms, prior, likely, workers)) {
    more += 0.5 * (above.equations.covariance(terms) + below.equations.covariance(terms)) - covariance;
    const Eigen::VectorXd moved = above.equations.best(terms) - below.equations.best(terms);
    more += 0.25 * moved * moved.transpose();
  }
  const Cholesky factor(covariance);
  if (!factor.is_positive_definite() || !more.allFinite()) return covariance;
  // In standard errors, without what would make any smaller.
  const Eigen::MatrixXd scaled = factor.whiten(Eigen::MatrixXd(factor.whiten(more).transpose()));
  const SymmetricEigen axes(0.5 * (scaled + scaled.transpose()));
  const Eigen::MatrixXd larger =
      factor.lower() * (axes.eigenvectors() * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal());
  return covariance + larger * larger.transpose();
}

}  // namespace pcor::internal
