#include "pcor/offline/process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pcor/offline/error.hpp"
#include "pcor/physics/lams.hpp"
#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace pcor {
namespace {

using testing::Contains;
using testing::HasSubstr;

// Equation 18 of the memo, in a C-130 with a laser.
ModelFile lams_model() {
  return parse_model(R"(
format = "pcor-model/1"
name = "test"
[variables]
static_pressure = "PSFD"
dynamic_pressure = "QCF"
recovery_temperature = "TTRR"
vapor_pressure = "EDPC"
radome_dynamic_pressure = "QCR"
attack_differential_pressure = "ADIFR"
lams_airspeed = "VLAMS"
[lams]
elevation = 1.5
[radome]
attack = [5.776, 15.031]
[temperature]
recovery_factor = 0.95
[[effect]]
id = "static-constant"
parameters = { a0 = 0.004127875 }
[[effect]]
id = "static-alpha"
parameters = { a1 = 0.021279816 }
[[effect]]
id = "static-qp"
parameters = { a2 = 0.030849643 }
)",
                     "test.toml");
}

// What the instruments read in air that moves at `airspeed` with the static defect `defect`.
struct Reading {
  double static_pressure, dynamic_pressure, attack_pressure, recovery_temperature, beam_speed;
};

constexpr double vapor_pressure = 4.0;  // hPa
constexpr double attack_ratio = -0.2;

Reading reading(double airspeed, double defect) {
  const double p = 700.0;
  const double temperature = 270.0;
  const MoistAir<double> air = moist_air(vapor_pressure / p);
  const double q = dynamic_pressure_from_airspeed(p, airspeed, temperature, air);
  const double mach = airspeed / speed_of_sound(temperature, air);
  const double attack = 5.776 + 15.031 * attack_ratio;
  return {p - defect, q + defect, attack_ratio * (q + defect),
          recovery_temperature(temperature, mach, 0.95, air), airspeed * beam_cosine(1.5, 0.0, attack, 0.0)};
}

// Writes a flight of so many samples in which the true static pressure is 700 hPa and delta-p is 2 hPa.
void write_flight(const std::filesystem::path& path, std::size_t records, int rate, double start = 50000.0) {
  const std::size_t samples = records * static_cast<std::size_t>(rate);
  std::vector<double> p, q, attack, temperature, beam;
  for (std::size_t i = 0; i < samples; ++i) {
    const Reading r = reading(110.0 + 20.0 * std::sin(0.001 * static_cast<double>(i)), 2.0);
    p.push_back(r.static_pressure);
    q.push_back(r.dynamic_pressure);
    attack.push_back(r.attack_pressure);
    temperature.push_back(r.recovery_temperature - 273.15);
    beam.push_back(r.beam_speed);
  }
  test::NetcdfMaker maker(path);
  maker.time(test::sequence(start, records));
  maker.series("PSFD", "mbar", p, rate);
  maker.series("QCF", "hPa", q, rate);
  maker.series(
      "QCR", "Pa",
      [&] {
        std::vector<double> pascal = q;
        for (double& value : pascal) value *= 100.0;
        return pascal;
      }(),
      rate);
  maker.series("ADIFR", "mb", attack, rate);
  maker.series("TTRR", "deg_C", temperature, rate);
  maker.series("VLAMS", "M/s", beam, rate);
  maker.series("EDPC", "hPa", std::vector<double>(records, vapor_pressure));
}

class Process : public testing::Test {
 protected:
  std::vector<double> read(const std::string& name, const std::string& unit) {
    const Flight flight(output_);
    std::vector<double> values(flight.records() * static_cast<std::size_t>(flight.variable(name).rate));
    const UnitConversion conversion = unit.empty() ? UnitConversion() : flight.conversion(name, unit);
    flight.read(name, {0, flight.records()}, conversion, values.data());
    return values;
  }

  test::TemporaryDirectory directory_;
  std::filesystem::path input_ = directory_.path() / "in.nc";
  std::filesystem::path output_ = directory_.path() / "out.nc";
};

// Values are stored as 32-bit floats: one part in 1.7e7, on each of a few inputs.
TEST_F(Process, FindsTheAirBehindTheReadings) {
  write_flight(input_, 200, 1);
  ProcessOptions options;
  options.correct_with = CorrectWith::lams;
  process_flight(input_, lams_model(), output_, options);
  EXPECT_THAT(read("PCOR_LAMS", "hPa"), testing::Each(testing::DoubleNear(2.0, 3e-4)));
  EXPECT_THAT(read("PSXC", "hPa"), testing::Each(testing::DoubleNear(700.0, 3e-4)));
  EXPECT_THAT(read("ATX", "K"), testing::Each(testing::DoubleNear(270.0, 1e-4)));
  EXPECT_THAT(read("ATLAMS", "K"), testing::Each(testing::DoubleNear(270.0, 1e-3)));
  EXPECT_THAT(read("TASX", "m/s")[0], testing::DoubleNear(110.0, 1e-4));
  const std::vector<double> flags = read("PCORFLAG", "");
  EXPECT_THAT(flags, testing::Each(static_cast<double>(Quality::corrected_with_lams)));
}

TEST_F(Process, KeepsTheTotalPressure) {
  write_flight(input_, 100, 1);
  process_flight(input_, lams_model(), output_);
  const std::vector<double> p = read("PSXC", "hPa"), q = read("QCXC", "hPa");
  const std::vector<double> measured_p = read("PSFD", "hPa"), measured_q = read("QCF", "hPa");
  for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(p[i] + q[i], measured_p[i] + measured_q[i], 2e-4);
}

TEST_F(Process, RunsHighRateFlightsAtTheirRate) {
  write_flight(input_, 40, 25, 86390.0);  // ten seconds before midnight
  const ProcessSummary summary = process_flight(input_, lams_model(), output_);
  EXPECT_EQ(summary.rate, 25);
  EXPECT_EQ(summary.samples, 1000U);
  EXPECT_EQ(summary.corrected, 1000U);
  EXPECT_EQ(summary.gaps, 0U);
  EXPECT_EQ(Flight(output_).variable("PSXC").rate, 25);
  EXPECT_THAT(read("PCOR_LAMS", "hPa"), testing::Each(testing::DoubleNear(2.0, 3e-4)));
}

// Blocks are an affair of the reader: a flight of many gives what its samples give one by one.
TEST_F(Process, DoesNotDependOnBlocks) {
  write_flight(input_, 2 * records_per_block + 17, 1);
  process_flight(input_, lams_model(), output_);
  EXPECT_THAT(read("PCOR_LAMS", "hPa"), testing::Each(testing::DoubleNear(2.0, 3e-4)));
}

TEST_F(Process, TellsItsProgress) {
  write_flight(input_, records_per_block + 1, 1);
  std::vector<std::size_t> done;
  ProcessOptions options;
  options.progress = [&done](std::size_t now, std::size_t) { done.push_back(now); };
  process_flight(input_, lams_model(), output_, options);
  EXPECT_THAT(done, testing::ElementsAre(records_per_block, records_per_block + 1));
}

TEST_F(Process, RenamesItsResults) {
  write_flight(input_, 10, 1);
  ModelFile model = lams_model();
  model.output["PCOR"] = "PCORD";
  ProcessOptions options;
  options.suffix = "_NEW";
  const ProcessSummary summary = process_flight(input_, model, output_, options);
  EXPECT_THAT(summary.outputs, Contains("PCORD_NEW"));
  EXPECT_THAT(summary.outputs, Contains("PSXC_NEW"));
}

TEST_F(Process, GoesOnWithoutALaser) {
  write_flight(input_, 10, 1);
  ModelFile model = lams_model();
  model.variables[Quantity::lams_airspeed] = "BEAM1";
  const ProcessSummary summary = process_flight(input_, model, output_);
  EXPECT_THAT(summary.notes, Contains(HasSubstr("BEAM1 is not in this file")));
  EXPECT_THAT(summary.outputs, testing::Not(Contains("PCOR_LAMS")));
}

TEST_F(Process, RefusesLamsWithoutALaser) {
  write_flight(input_, 10, 1);
  ModelFile model = lams_model();
  model.variables.erase(Quantity::lams_airspeed);
  ProcessOptions options;
  options.correct_with = CorrectWith::lams;
  EXPECT_THAT(test::message_of<Error>([&] { process_flight(input_, model, output_, options); }),
              HasSubstr("lams_airspeed"));
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(Process, TakesFormulasOfVariablesInTheFile) {
  write_flight(input_, 10, 1);
  ModelFile plain = lams_model();
  process_flight(input_, plain, output_);
  const std::vector<double> before = read("PCOR", "hPa");
  ModelEffect thrust;
  thrust.id = "thrust";
  thrust.formula = "k * EDPC";
  thrust.parameter_names = {"k"};
  thrust.parameters = {0.25};
  plain.model.effects.push_back(thrust);
  process_flight(input_, plain, output_);
  const std::vector<double> after = read("PCOR", "hPa");
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_NEAR(after[i] - before[i], 1.0, 1e-6);
}

// In a descent at a constant rate a lagging line reads tau dp/dt too low; only the first sample has no rate.
TEST_F(Process, GivesRatesToEffectsFromTheSampleBefore) {
  {
    test::NetcdfMaker maker(input_);
    maker.time({100, 101, 102, 103, 203, 204});
    maker.series("PSFD", "hPa", {700, 701, 702, 703, 800, 801});
    maker.series("QCF", "hPa", std::vector<double>(6, 60.0));
  }
  ModelFile model = parse_model(R"(
format = "pcor-model/1"
name = "lag"
[variables]
static_pressure = "PSFD"
dynamic_pressure = "QCF"
[humidity]
moist = false
[[effect]]
id = "static-lag"
parameters = { tau = 0.5 }
)",
                                "lag.toml");
  const ProcessSummary summary = process_flight(input_, model, output_);
  EXPECT_EQ(summary.gaps, 1U);
  const std::vector<double> p = read("PSXC", "hPa");
  EXPECT_THAT(p, testing::ElementsAre(testing::IsNan(), 701.5, 702.5, 703.5, testing::IsNan(), 801.5));
  const double after_gap =
      static_cast<double>(Quality::after_gap) + static_cast<double>(Quality::effect_input_missing);
  EXPECT_THAT(read("PCORFLAG", ""), testing::ElementsAre(after_gap, 0, 0, 0, after_gap, 0));
}

}  // namespace
}  // namespace pcor
