// Check of the stated uncertainties of corrected samples on flights whose truth is known: over many flights,
// each with separate errors in the law, the transducers, the thermometer and every sample, 68 % of the
// results are within one standard uncertainty of the truth and 95 % within two. The truth is the
// simulator's, which shares no physics with the corrections.
#include <pcor/process/process.hpp>

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <pcor/simulate/simulate.hpp>
#include "support/many_seeds.hpp"
#include "support/temporary_directory.hpp"
#include "support/values_of.hpp"

namespace pcor {
namespace {

constexpr const char* scenario_text = R"(
format = "pcor-scenario/1"
name = "coverage"
aircraft = "C-130"
start = 2011-11-17T20:00:00Z
[[system]]
static = "PSFD"
dynamic = "QCF"
[[leg]]
kind = "take-off"
altitude = 1500
speed = 105
[[leg]]
kind = "level"
duration = 90
[[leg]]
kind = "pitch"
cycles = 3
[[leg]]
kind = "speed-run"
low = 95
high = 135
rate = 0.5
)";

// Covariance of a fit of equation 18: L of the covariance L L', in the order a0, a1, a2.
constexpr std::array<std::array<double, 3>, 3> factor{
    {{4e-4, 0.0, 0.0}, {1e-3, 1.2e-3, 0.0}, {-3e-3, 1e-3, 2e-3}}};
constexpr std::array<double, 3> coefficients{0.004127875, 0.021279816, 0.030849643};

constexpr double static_offset = 0.1, dynamic_offset = 0.08;  // hPa
constexpr double thermometer_offset = 0.3;                    // K
const std::map<std::string, double> sensor_noise{
    {"PSFD", 0.05}, {"QCF", 0.05}, {"TTRR", 0.1}, {"ADIFR", 0.03}, {"QCR", 0.03}};

ModelDefinition model() {
  ModelDefinition file = parse_model(R"(
format = "pcor-model/1"
name = "equation 18, fitted"
[variables]
static_pressure = "PSFD"
dynamic_pressure = "QCF"
recovery_temperature = "TTRR"
vapor_pressure = "EDPC"
radome_dynamic_pressure = "QCR"
attack_differential_pressure = "ADIFR"
[temperature]
recovery_factor = 0.95
[[effect]]
id = "static-constant"
[[effect]]
id = "static-alpha"
[[effect]]
id = "static-qp"
[[effect]]
id = "psfd-bias"
[[effect]]
id = "qcf-zero"
[[effect]]
id = "temp-offset"
)",
                                     "model.toml");
  file.covariance.parameters = {"static-constant.a0", "static-alpha.a1", "static-qp.a2"};
  file.covariance.matrix.assign(3, std::vector<double>(3, 0.0));
  for (std::size_t i = 0; i < 3; ++i) {
    file.model.effects[i].parameters[0] = coefficients[i];
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) file.covariance.matrix[i][j] += factor[i][k] * factor[j][k];
    }
  }
  const std::array<double, 3> offsets{static_offset, dynamic_offset, thermometer_offset};
  for (std::size_t i = 0; i < 3; ++i) file.fits[3 + i][0] = {true, offsets[i], {}};
  for (const auto& [role, variable] : file.variables) {
    if (const auto size = sensor_noise.find(variable); size != sensor_noise.end())
      file.uncertainty.roles[role] = size->second;
  }
  return parse_model(write_model(file), "model.toml");
}

// A flight of the seed: its law and offsets are drawn from the uncertainties that the model states.
Scenario scenario_of(std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Scenario scenario = parse_scenario(scenario_text, "coverage.toml");
  scenario.seed = seed;
  std::array<double, 3> law = coefficients;
  for (std::size_t k = 0; k < 3; ++k) {
    const double draw = normal(engine);
    for (std::size_t i = 0; i < 3; ++i) law[i] += factor[i][k] * draw;
  }
  scenario.systems[0].law.a0 = law[0];
  scenario.systems[0].law.a1 = law[1];
  scenario.systems[0].law.a2 = law[2];
  for (const auto& [variable, size] : sensor_noise) scenario.noise[variable] = {size, 0.0, 0.0, 0.0};
  scenario.noise["PSFD"].bias = static_offset * normal(engine);
  scenario.noise["QCF"].bias = dynamic_offset * normal(engine);
  scenario.noise["TTRR"].bias = thermometer_offset * normal(engine);
  return scenario;
}

struct Compared {
  std::string result, truth, unit;
};
const std::array<Compared, 4> compared_results{{{"PSXC", "TRUE_PS", "hPa"},
                                                {"QCXC", "TRUE_QC", "hPa"},
                                                {"ATX", "TRUE_AT", "degC"},
                                                {"TASX", "TRUE_TAS", "m/s"}}};

struct Shares {
  std::size_t count = 0, within_one = 0, within_two = 0;
};

// In level flight, in a pull-up and a push-over, slow and fast: in one flight they share what is systematic.
std::vector<std::size_t> samples_of(const SimulationSummary& summary) {
  std::vector<std::size_t> samples;
  for (const SimulatedLeg& leg : summary.legs) {
    if (leg.kind == "take-off") continue;
    for (const double part : {0.35, 0.7}) {
      samples.push_back(static_cast<std::size_t>(leg.start_time + part * (leg.end_time - leg.start_time) -
                                                 summary.start_time));
    }
  }
  return samples;
}

TEST(Coverage, SharesWithinOneAndTwoSigmaAreNormal) {
  const test::TemporaryDirectory directory;
  const ModelDefinition file = model();
  std::array<Shares, compared_results.size()> shares{};
  Shares all;
  const std::size_t flights = test::number_of_seeds();
  for (std::size_t seed = 1; seed <= flights; ++seed) {
    const SimulationSummary summary = simulate_flight(scenario_of(seed), directory / "in.nc");
    process_flight(directory / "in.nc", file, directory / "out.nc");
    const Flight recorded(directory / "in.nc"), corrected(directory / "out.nc");
    for (std::size_t i = 0; i < compared_results.size(); ++i) {
      const std::vector<double> values =
          test::values_of(corrected, compared_results[i].result, compared_results[i].unit);
      const std::vector<double> stated =
          test::values_of(corrected, compared_results[i].result + "_uncertainty",
                          compared_results[i].unit == "degC" ? "K" : compared_results[i].unit);
      const std::vector<double> truth =
          test::values_of(recorded, compared_results[i].truth, compared_results[i].unit);
      for (const std::size_t sample : samples_of(summary)) {
        const double z = std::abs(values[sample] - truth[sample]) / stated[sample];
        ASSERT_FALSE(std::isnan(z)) << compared_results[i].result << " of flight " << seed;
        for (Shares* const each : {&shares[i], &all}) {
          ++each->count;
          each->within_one += z <= 1.0 ? 1 : 0;
          each->within_two += z <= 2.0 ? 1 : 0;
        }
      }
    }
  }
  const auto share = [](std::size_t part, std::size_t of) {
    return static_cast<double>(part) / static_cast<double>(of);
  };
  // Four standard errors of a share if only flights are independent, which 200 of them satisfy: with four
  // results and six samples each the errors of the shares are less than half as large.
  const auto tolerance = [flights](double probability, double requested) {
    if (flights >= 200) return requested;
    return 4.0 * std::sqrt(probability * (1.0 - probability) / static_cast<double>(flights));
  };
  EXPECT_NEAR(share(all.within_one, all.count), 0.683, tolerance(0.683, 0.04));
  EXPECT_NEAR(share(all.within_two, all.count), 0.954, tolerance(0.954, 0.02));
  for (std::size_t i = 0; i < compared_results.size(); ++i) {
    RecordProperty(compared_results[i].result + "_within_one",
                   std::to_string(share(shares[i].within_one, shares[i].count)));
    EXPECT_NEAR(share(shares[i].within_one, shares[i].count), 0.683, 2.0 * tolerance(0.683, 0.04))
        << compared_results[i].result;
  }
}

}  // namespace
}  // namespace pcor
