#include <gtest/gtest.h>
#include <pcor/compare/compare.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "support/many_seeds.hpp"
#include "support/nuisance.hpp"
#include "support/synthetic_samples.hpp"

// Scores of the bias of a correct law, bias / stated error, over all samples, regimes, bands and flights,
// for any noise: their rms is near one.

namespace {

using Flights = std::vector<std::shared_ptr<const pcor::FlightSamples>>;

constexpr std::size_t two_hours = 7200;  // samples

std::shared_ptr<const pcor::FlightSamples> flight(unsigned seed, const pcor::test::Nuisance& nuisance,
                                                  std::size_t count) {
  made::Plan plan;
  plan.seed = seed;
  plan.samples = count;
  plan.defect = made::equation_18;
  pcor::FlightSamples samples = made::flight(plan);
  samples.motion.altitude.resize(plan.samples);
  for (std::size_t i = 0; i < plan.samples; ++i)
    samples.motion.altitude[i] = 3000.0 + 2000.0 * std::sin(static_cast<double>(i) / 900.0 + seed);
  pcor::test::add_nuisance(made::reference_pressure(samples), seed + 100000, nuisance);
  if (count == two_hours) {
    samples.intervals = {{pcor::Regime::climb, samples.time[200], samples.time[1400]},
                         {pcor::Regime::climb, samples.time[5600], samples.time[6500]},
                         {pcor::Regime::pitch_manoeuvre, samples.time[3500], samples.time[3800]}};
  }
  return std::make_shared<const pcor::FlightSamples>(samples);
}

/// Rms of the scores of all biases that are stated, over many comparisons of some flights.
double score_of(const pcor::test::Nuisance& nuisance, std::size_t seeds, std::size_t flights,
                std::size_t samples = two_hours) {
  pcor::ModelDefinition law = made::model({"static-constant", "static-alpha", "static-qp"});
  law.model.effects[0].parameters = {0.004127875};
  law.model.effects[1].parameters = {0.021279816};
  law.model.effects[2].parameters = {0.030849643};
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t s = 0; s < seeds; ++s) {
    Flights all;
    for (std::size_t f = 0; f < flights; ++f)
      all.push_back(flight(static_cast<unsigned>(1000 + s * flights + f), nuisance, samples));
    const pcor::Comparison comparison = pcor::compare(all, {{"law", law, made::pressure_reference()}});
    const pcor::ModelComparison& model = comparison.models.front();
    const auto add = [&](const pcor::Statistics& statistics) {
      sum += std::pow(statistics.bias / statistics.bias_error, 2);
      count += 1.0;
    };
    add(model.all);
    for (const auto* parts : {&model.regimes, &model.bands, &model.flights}) {
      for (const pcor::PartStatistics& part : *parts) add(part.statistics);
    }
  }
  return std::sqrt(sum / count);
}

/// Permitted error of a correct method. Four flights of two hours are two to nine correlation times of the
/// slowest drift, so they do not separate a drift of an hour from a larger one of a quarter of an hour: an
/// error that is correct in the mean over both is about 20 % too large for the one and too small for the
/// other. Chance is added: the parts of one comparison have much in common, so that each counts as two
/// independent scores; three standard errors of their rms.
void expect_right(double score, std::size_t comparisons, const std::string& what) {
  std::cout << what << ": rms of the scores " << score << "\n";
  const double chance = 3.0 / std::sqrt(2.0 * 2.0 * static_cast<double>(comparisons));
  EXPECT_GT(score, std::max(0.8 - chance, 0.5)) << what;
  EXPECT_LT(score, 1.3 + chance) << what;
}

const std::size_t seeds = pcor::test::number_of_seeds();
constexpr std::size_t flights = 4;

}  // namespace

TEST(StatedErrorsOfMeans, HoldWithoutDrift) { expect_right(score_of({}, seeds, flights), seeds, "nothing"); }

TEST(StatedErrorsOfMeans, HoldUnderDrift) {
  for (const auto& [rms, memory] : {std::pair(0.15, 900.0), {0.4, 900.0}, {0.15, 3600.0}, {0.4, 3600.0}}) {
    expect_right(score_of({rms, memory}, seeds, flights), seeds,
                 std::to_string(rms) + " hPa, " + std::to_string(memory) + " s");
  }
}

TEST(StatedErrorsOfMeans, HoldUnderFlickerNoise) {
  expect_right(score_of({0.0, 1.0, 0.05}, seeds, flights), seeds, "1/f");
}

TEST(StatedErrorsOfMeans, HoldWithBursts) {
  expect_right(score_of({0.0, 1.0, 0.0, true}, seeds, flights), seeds, "bursts");
}

// A single flight constrains its drift even less.
TEST(StatedErrorsOfMeans, HoldForOneFlight) {
  expect_right(score_of({0.15, 900.0}, 2 * seeds, 1), 2 * seeds, "one flight, 0.15 hPa, 900 s");
}

// The drift of short flights is a constant in each, which only their scatter shows. The errors were 3 to 7
// times too small.
TEST(StatedErrorsOfMeans, HoldForShortFlights) {
  constexpr std::size_t short_flights = 8, five_minutes = 300;
  for (const double rms : {0.0, 0.15, 0.4}) {
    expect_right(score_of({rms, 3600.0}, seeds, short_flights, five_minutes), seeds,
                 "five minutes, " + std::to_string(rms) + " hPa");
  }
}
