#include <gtest/gtest.h>
#include <pcor/fit/refit.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "support/many_seeds.hpp"
#include "support/nuisance.hpp"
#include "support/synthetic_samples.hpp"

// WhitenedSystem of refitted coefficients, (estimate - truth) / stated error, over flights whose noise is
// slower and less tidy than an autoregression: their rms is near one.

namespace {

using Flights = std::vector<std::shared_ptr<const pcor::FlightSamples>>;

const std::map<std::string, double> truth{
    {"static-constant.a0", 0.004127875}, {"static-alpha.a1", 0.021279816}, {"static-qp.a2", 0.030849643}};

/// Noise of 0.3 hPa with a correlation time of 3 s is added.
using pcor::test::Nuisance;

std::shared_ptr<const pcor::FlightSamples> flight(unsigned seed, const Nuisance& nuisance) {
  made::Plan plan;
  plan.seed = seed;
  plan.samples = 7200;
  plan.defect = made::equation_18;
  pcor::FlightSamples samples = made::flight(plan);
  pcor::test::add_nuisance(made::reference_pressure(samples), seed + 100000, nuisance);
  for (const std::size_t begin : {1000U, 3500U, 6000U})
    samples.intervals.push_back(
        {pcor::Regime::pitch_manoeuvre, samples.time[begin], samples.time[begin + 300]});
  return std::make_shared<const pcor::FlightSamples>(samples);
}

/// Rms of the scores of each coefficient over many fits.
std::map<std::string, double> scores_of(const Nuisance& nuisance, std::size_t seeds, std::size_t flights,
                                        pcor::RefitOptions options = {}) {
  options.trust_reference = !nuisance.is_off;
  std::map<std::string, double> squares;
  for (std::size_t s = 0; s < seeds; ++s) {
    Flights all;
    for (std::size_t f = 0; f < flights; ++f)
      all.push_back(flight(static_cast<unsigned>(1000 + s * flights + f), nuisance));
    pcor::ModelDefinition model = made::model({"static-constant", "static-alpha", "static-qp"});
    // A start that is two times wrong: what the first stage holds must not stay in the others.
    model.model.effects[2].parameters = {2.0 * truth.at("static-qp.a2")};
    for (const pcor::FittedParameter& parameter :
         pcor::refit(all, model, made::pressure_reference(), options).parameters) {
      const double score = (parameter.value - truth.at(parameter.name)) / parameter.standard_error;
      squares[parameter.name] += score * score / static_cast<double>(seeds);
    }
  }
  for (auto& [name, value] : squares) value = std::sqrt(value);
  return squares;
}

/// The rms of n scores of a correct error scatters by 1/sqrt(2n); three of these either side. The permitted
/// error of a correct method is added: the strength of a drift is estimated from the flight itself.
void expect_right(const std::map<std::string, double>& scores, std::size_t seeds, const std::string& what) {
  const double chance = 3.0 / std::sqrt(2.0 * static_cast<double>(seeds));
  for (const auto& [name, score] : scores) {
    EXPECT_GT(score, 0.9 - chance) << what << " " << name;
    EXPECT_LT(score, 1.15 + chance) << what << " " << name;
  }
}

const std::size_t seeds = pcor::test::number_of_seeds();

}  // namespace

TEST(StatedErrors, HoldWithoutDrift) { expect_right(scores_of({}, seeds, 1), seeds, "nothing"); }

TEST(StatedErrors, HoldUnderDrift) {
  expect_right(scores_of({0.06, 600.0}, seeds, 1), seeds, "0.06 hPa, 600 s");
  expect_right(scores_of({0.15, 900.0}, seeds, 1), seeds, "0.15 hPa, 900 s");
}

TEST(StatedErrors, HoldUnderFlickerNoise) {
  expect_right(scores_of({0.0, 1.0, 0.05}, seeds, 1), seeds, "1/f");
}

TEST(StatedErrors, HoldWithBurstsAndStuckValues) {
  expect_right(scores_of({0.0, 1.0, 0.0, true}, seeds, 1), seeds, "bursts");
  expect_right(scores_of({0.0, 1.0, 0.0, false, true}, seeds, 1), seeds, "stuck");
}

TEST(StatedErrors, HoldForEightFlights) {
  const std::size_t fits = std::max<std::size_t>(seeds / 5, 6);
  expect_right(scores_of({0.15, 900.0}, fits, 8), fits, "eight flights, 0.15 hPa, 900 s");
}

// A stage of an earlier fit held what the others had wrong: its errors were 5.7 times too small.
TEST(StatedErrors, HoldInStagesFromAWrongStart) {
  pcor::RefitOptions options;
  options.stages = {{{pcor::Regime::pitch_manoeuvre}, {"static-alpha"}}};
  expect_right(scores_of({}, seeds, 1, options), seeds, "stages");
  expect_right(scores_of({0.15, 900.0}, seeds, 1, options), seeds, "stages, 0.15 hPa, 900 s");
}

TEST(StatedErrors, IncludeAReferenceError) {
  Nuisance nuisance;
  nuisance.is_off = true;
  expect_right(scores_of(nuisance, seeds, 1), seeds, "reference off");
  nuisance.drift = 0.15;
  nuisance.drift_time = 900.0;
  expect_right(scores_of(nuisance, seeds, 1), seeds, "reference off, 0.15 hPa, 900 s");
}

// A zero that differs from flight to flight is an error of each sample of a flight.
TEST(StatedErrors, OfTheModelIncludeTheZeroOfEachFlight) {
  Flights flights;
  for (unsigned f = 0; f < 8; ++f) {
    pcor::FlightSamples samples = *flight(200 + f, {});
    for (double& value : made::reference_pressure(samples)) value += f % 2 == 0 ? 0.3 : -0.3;
    flights.push_back(std::make_shared<const pcor::FlightSamples>(samples));
  }
  const pcor::RefitResult result = pcor::refit(
      flights, made::model({"static-constant", "static-alpha", "static-qp"}), made::pressure_reference(), {});
  EXPECT_NEAR(result.between_flights, 0.3, 0.1);  // 8 zeros determine their deviation to 25 %
  ASSERT_TRUE(result.model.uncertainty.static_defect);
  EXPECT_GE(*result.model.uncertainty.static_defect, result.between_flights);
}
