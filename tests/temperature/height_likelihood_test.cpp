#include "temperature/height_likelihood.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "temperature/height_least_squares.hpp"
#include "temperature/synthetic_records.hpp"

using namespace pcor::internal;
using made::record_of;

namespace {

const Workers one_thread(pcor::serial_communicator(), 1);
const Workers three_threads(pcor::serial_communicator(), 3);

HeightRecord short_record() {
  made::AirPlan plan;
  plan.seconds = 1200;
  plan.gps = 0.5;
  plan.offset = 0.5;
  return record_of(plan);
}

/// Flights through noise of the GPS.
std::vector<HeightRecord> noisy_records(std::size_t flights, std::size_t seconds, double memory = 60.0) {
  std::vector<HeightRecord> records;
  for (std::size_t flight = 0; flight < flights; ++flight) {
    made::AirPlan plan;
    plan.seed = static_cast<unsigned>(flight + 1);
    plan.seconds = seconds;
    plan.gps = 0.5;
    plan.gps_memory = memory;
    plan.offset = 0.4;
    records.push_back(record_of(plan));
  }
  return records;
}

/// The covariance of the heights of a record written out: every kind of noise by its definition.
Eigen::MatrixXd dense_covariance(const HeightRecord& record, const HeightNoise& noise,
                                 const HeightPrior& prior) {
  const auto n = static_cast<Eigen::Index>(record.blocks.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  const auto at = [&](Eigen::Index i) -> const HeightBlock& {
    return record.blocks[static_cast<std::size_t>(i)];
  };
  const double start = at(0).time;
  // Means over blocks: of exp(-t/memory) over both, and of the lesser of two times for a random walk.
  const auto part = [&](Eigen::Index i) {
    const double ratio = noise.wander_time / at(i).length;
    return ratio * (1.0 - std::exp(-1.0 / ratio));
  };
  const double begin = start - 0.5 * at(0).length;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const double ratio = noise.wander_time / at(i).length;
      const double between = std::abs(at(i).time - at(j).time) - 0.5 * (at(i).length + at(j).length);
      double sum = noise.wander * noise.wander *
                   (i == j ? 2.0 * ratio * (1.0 - part(i))
                           : part(i) * part(j) * std::exp(-between / noise.wander_time));
      const double walked = std::min(at(i).time, at(j).time) - begin - (i == j ? at(i).length / 6.0 : 0.0);
      sum += noise.walk * noise.walk * walked;
      if (i == j) sum += noise.white * noise.white / static_cast<double>(at(i).samples);
      // The drift is a sum over steps of slope times way; the slope is a start and a sum of changes.
      for (Eigen::Index k = 0; k < std::min(i, j); ++k) {
        const double across = k == 0 ? 0.0 : at(k).time - at(k - 1).time;
        const double variance =
            (k == 0 ? prior.slope * prior.slope : 0.0) + noise.slope_change * noise.slope_change * across;
        sum += variance * ((at(i).east - at(k).east) * (at(j).east - at(k).east) +
                           (at(i).north - at(k).north) * (at(j).north - at(k).north));
      }
      covariance(i, j) = sum;
    }
  }
  return covariance;
}

TEST(HeightLikelihood, FilterEqualsDenseGeneralisedLeastSquares) {
  const HeightRecord record = short_record();
  HeightNoise noise;
  noise.white = 0.8;
  noise.wander = 0.4;
  noise.wander_time = 90.0;
  noise.walk = 0.02;
  noise.slope_change = 3e-7;
  const HeightPrior prior;
  const HeightEquations found = height_equations(record, noise, prior);

  const Eigen::MatrixXd covariance = dense_covariance(record, noise, prior);
  const auto n = covariance.rows();
  constexpr Eigen::Index unknowns = height_unknowns;
  Eigen::MatrixXd rows(n, unknowns + 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    const HeightBlock& block = record.blocks[static_cast<std::size_t>(i)];
    rows.row(i) << block.columns.transpose(), block.excess;
  }
  // The unknown height at the start: project a constant off.
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(n, n));
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(n);
  const double weight = ones.dot(inverse * ones);
  const Eigen::MatrixXd projected = inverse - inverse * ones * ones.transpose() * inverse / weight;
  const Eigen::MatrixXd requested = rows.transpose() * projected * rows;
  // The unknown height has a variance of 1e8 m2 in the filter: relative errors of 1e-8 times the condition.
  for (Eigen::Index i = 0; i < unknowns; ++i) {
    for (Eigen::Index j = 0; j < unknowns; ++j)
      EXPECT_NEAR(found.information(i, j), requested(i, j),
                  1e-5 * std::sqrt(requested(i, i) * requested(j, j)))
          << i << " " << j;
    EXPECT_NEAR(found.right(i), requested(i, unknowns),
                1e-5 * std::sqrt(requested(i, i) * requested(unknowns, unknowns)));
  }
  EXPECT_NEAR(found.squares / requested(unknowns, unknowns), 1.0, 1e-5);
  // ln det of the contrasts: ln det of the whole plus ln of the weight of a constant.
  const double determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum() + std::log(weight);
  EXPECT_NEAR(found.log_determinant, determinant, 1e-4);
}

TEST(HeightLikelihood, BestCoefficientsMinimiseTheDeviance) {
  const HeightEquations equations = height_equations(short_record(), {}, {});
  const Eigen::VectorXd best = equations.best(2);
  const double minimum = equations.deviance(2);
  for (const double side : {-1.0, 1.0}) {
    for (Eigen::Index k = 0; k < 2; ++k) {
      Eigen::VectorXd moved = best;
      moved[k] += side * std::sqrt(equations.covariance(2)(k, k));
      // A coefficient moved alone by its standard error raises the deviance by 1 or more (more where others
      // would follow).
      EXPECT_GE(equations.deviance_at(moved), minimum + 1.0 - 1e-6);
    }
  }
  EXPECT_LE(equations.deviance(2), equations.deviance(1));
  EXPECT_LE(equations.deviance(1), equations.deviance(0));
}

TEST(HeightLikelihood, SumIsIndependentOfTheThreads) {
  std::vector<HeightRecord> records;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    made::AirPlan plan;
    plan.seconds = 2000;
    plan.seed = seed;
    plan.gps = 0.5;
    records.push_back(record_of(plan));
  }
  const HeightEquations one = height_equations(records, HeightNoise{}, HeightPrior{}, one_thread);
  const HeightEquations three = height_equations(records, HeightNoise{}, HeightPrior{}, three_threads);
  EXPECT_EQ(one.squares, three.squares);
  EXPECT_EQ(one.information, three.information);
  HeightEquations sum;
  for (const HeightRecord& record : records) sum += height_equations(record, {}, {});
  EXPECT_NEAR(sum.deviance(2), one.deviance(2), 1e-6);
}

TEST(HeightLikelihood, EstimatesTheTrueNoise) {
  const std::vector<HeightRecord> records = noisy_records(4, 7200, 80.0);
  const MostLikely found = maximise_likelihood(records, 2, HeightPrior{}, HeightNoise{}, one_thread);
  // 8 hours hold 360 memories of the noise: its variance is known to 10 %, its memory to about as much.
  EXPECT_NEAR(found.noise.wander, 0.5, 0.05);
  EXPECT_NEAR(found.noise.wander_time, 80.0, 16.0);
  EXPECT_LT(found.noise.walk * std::sqrt(3600.0), 0.3);
  EXPECT_NEAR(found.equations.best(2)[0], -0.4, 3.0 * std::sqrt(found.equations.covariance(2)(0, 0)));
  // The innovations are white and of variance one: 2880 blocks determine it to 0.03 and 0.02.
  double squares = 0.0;
  double products = 0.0;
  double count = 0.0;
  for (const HeightRecord& record : records) {
    const HeightUnknowns a = found.equations.best_unknowns(2);
    const std::vector<double> innovations = height_innovations(record, found.noise, HeightPrior{}, a);
    for (std::size_t i = 2; i < innovations.size(); ++i) {
      squares += innovations[i] * innovations[i];
      products += innovations[i] * innovations[i - 1];
      count += 1.0;
    }
  }
  EXPECT_NEAR(squares / count, 1.0, 0.08);
  EXPECT_NEAR(products / squares, 0.0, 0.08);
}

/// The covariance with the noise's uncertainty, by a random walk through the noise (Metropolis) instead of a
/// few points; its logarithms are known to 1.5 beforehand.
Eigen::MatrixXd sampled_covariance(const std::vector<HeightRecord>& records, Eigen::Index terms,
                                   const MostLikely& likely, int samples) {
  const std::array<double HeightNoise::*, 5> moved{&HeightNoise::white, &HeightNoise::wander,
                                                   &HeightNoise::wander_time, &HeightNoise::walk,
                                                   &HeightNoise::slope_change};
  const std::array<double, 5> steps{0.05, 0.1, 0.2, 0.5, 0.5};
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  HeightNoise here = likely.noise;
  HeightEquations equations = likely.equations;
  double deviance = likely.deviance;
  Eigen::MatrixXd covariances = Eigen::MatrixXd::Zero(terms, terms);
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(terms, terms);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(terms);
  for (int sample = 0; sample < samples; ++sample) {
    HeightNoise next = here;
    double there = 0.0;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      next.*moved[i] *= std::exp(steps[i] * normal(engine));
      there += std::pow(std::log(next.*moved[i] / likely.noise.*moved[i]) / 1.5, 2);
    }
    const HeightEquations tried = height_equations(records, next, HeightPrior{}, one_thread);
    there += tried.deviance(terms) + tried.log_information(terms);
    if (std::log(uniform(engine)) < 0.5 * (deviance - there)) {
      here = next;
      equations = tried;
      deviance = there;
    }
    const Eigen::VectorXd from_likeliest = equations.best(terms) - likely.equations.best(terms);
    covariances += equations.covariance(terms);
    squares += from_likeliest * from_likeliest.transpose();
    sum += from_likeliest;
  }
  return (covariances + squares - sum * sum.transpose() / samples) / samples;
}

TEST(HeightLikelihoodStudy, ErrorsIncludeNoiseUncertainty) {
  constexpr std::size_t flights = 4;
  std::array<double, 2> apart{};
  for (const HeightRecord& record : noisy_records(flights, 7200)) {
    const std::vector<HeightRecord> records{record};
    const MostLikely likely = maximise_likelihood(records, 2, HeightPrior{}, HeightNoise{}, one_thread);
    const Eigen::MatrixXd stated = covariance_over_noise(records, 2, HeightPrior{}, likely, one_thread);
    const Eigen::MatrixXd sampled = sampled_covariance(records, 2, likely, 8000);
    for (Eigen::Index k = 0; k < 2; ++k) {
      const double as_if_known = std::sqrt(likely.equations.covariance(2)(k, k));
      EXPECT_GT(std::sqrt(stated(k, k)), 1.01 * as_if_known) << record.name << " a" << k;
      const double one = (std::sqrt(stated(k, k)) - std::sqrt(sampled(k, k))) / as_if_known;
      // Ten points in five dimensions, where the likelihood is not quite normal.
      EXPECT_NEAR(one, 0.0, 0.08) << record.name << " a" << k;
      apart[static_cast<std::size_t>(k)] += one / flights;
    }
  }
  // The noise adds 5 % to the errors of two hours. Over some flights the points are within 3 % of the walk,
  // of which 1 % is the sampling error of 8000 steps, about 200 of them independent.
  for (const double part : apart) EXPECT_NEAR(part, 0.0, 0.03);
}

TEST(HeightLikelihood, NoiseUncertaintyDecreasesWithMoreFlights) {
  double before = std::numeric_limits<double>::infinity();
  for (const std::size_t flights : {1U, 4U, 16U}) {
    const std::vector<HeightRecord> records = noisy_records(flights, 3600);
    const MostLikely likely = maximise_likelihood(records, 2, HeightPrior{}, HeightNoise{}, one_thread);
    const Eigen::MatrixXd stated = covariance_over_noise(records, 2, HeightPrior{}, likely, one_thread);
    const Eigen::MatrixXd more = stated - likely.equations.covariance(2);
    // No combination of coefficients becomes more certain, except for rounding.
    EXPECT_GT(more.trace(), 0.0);
    EXPECT_GT(more.determinant(), -1e-9 * stated.determinant());
    const double part = more(0, 0) / stated(0, 0);
    EXPECT_LT(part, before) << flights;
    before = part;
    EXPECT_EQ(covariance_over_noise(records, 2, HeightPrior{}, likely, three_threads), stated) << flights;
  }
}

TEST(HeightLikelihood, EstimatesAnUnknownIsobarSlope) {
  made::AirPlan plan;
  plan.seconds = 7200;
  plan.turning = 7200.0;  // a wide circle: the way varies with the climbs
  plan.gps = 0.3;
  plan.gps_memory = 60.0;
  plan.slope_east = 1e-4;
  plan.offset = 0.5;
  HeightNoise noise;
  noise.white = 0.01;
  noise.wander = 0.3;
  noise.walk = 1e-4;
  noise.slope_change = 1e-9;
  const HeightEquations fitted = height_equations(record_of(plan), noise, {1e-4});
  const HeightEquations level = height_equations(record_of(plan), noise, {0.0});
  EXPECT_NEAR(fitted.best(1)[0], -0.5, 3.0 * std::sqrt(fitted.covariance(1)(0, 0)));
  // If the isobars are assumed level, the slope changes the temperature, and by more than the noise.
  EXPECT_GT(std::abs(level.best(1)[0] + 0.5), 5.0 * std::sqrt(level.covariance(1)(0, 0)));
}

TEST(HeightLeastSquares, RecoversTheLineWithoutNoise) {
  made::AirPlan plan;
  plan.offset = 0.5;
  plan.gain = 0.01;
  const pcor::TemperatureFit fit = fit_height_by_least_squares({record_of(plan)}, 2);
  EXPECT_NEAR(fit.coefficients[0], -0.5 / 1.01, 1e-6);  // no noise: exact except for the trapezium rule
  EXPECT_NEAR(fit.coefficients[1], -0.01 / 1.01, 1e-7);
  EXPECT_LT(fit.sigma, 1e-3);
}

TEST(HeightLeastSquares, ErrorsAreTooSmallForCorrelatedNoise) {
  double squares_likely = 0.0;
  double squares_least = 0.0;
  constexpr unsigned seeds = 40;
  HeightNoise noise;
  noise.white = 0.01;
  noise.wander = 1.0;
  noise.wander_time = 120.0;
  noise.walk = 1e-5;
  noise.slope_change = 1e-10;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    made::AirPlan plan;
    plan.seed = seed;
    plan.gps = 1.0;
    plan.gps_memory = 120.0;
    const HeightRecord record = record_of(plan);
    const pcor::TemperatureFit minimum = fit_height_by_least_squares({record}, 1);
    const HeightEquations likely = height_equations(record, noise, {0.0});
    squares_least += std::pow(minimum.coefficients[0] / minimum.standard_errors[0], 2);
    squares_likely += std::pow(likely.best(1)[0], 2) / likely.covariance(1)(0, 0);
  }
  // Scores of the likelihood have a mean square of 1, known to sqrt(2/40) = 0.22 from 40 seeds; scores of
  // least squares one of about twice the correlation time, 240.
  EXPECT_NEAR(squares_likely / seeds, 1.0, 0.67);
  EXPECT_GT(squares_least / seeds, 50.0);
}

}  // namespace
