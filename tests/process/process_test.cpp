#include <pcor/process/process.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/physics/lams.hpp>
#include <pcor/realtime/loop.hpp>
#include <pcor/realtime/low_pass.hpp>
#include "support/error_of.hpp"
#include "support/netcdf_file.hpp"
#include "support/says.hpp"
#include "support/temporary_directory.hpp"
#include "support/values_of.hpp"

namespace pcor {
namespace {

using testing::Contains;
using testing::HasSubstr;

// A model of two pressures. @param rest further variables, then further tables
ModelDefinition pressure_model(const std::string& rest) {
  return parse_model(R"(
format = "pcor-model/1"
[variables]
static_pressure = "PSFD"
dynamic_pressure = "QCF"
)" + rest,
                     "test.toml");
}

// Equation 18 of the memo, in a C-130 with a laser.
ModelDefinition lams_model() {
  return pressure_model(R"(
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
)");
}

// The model of these tests without the laser.
ModelDefinition law_model() {
  ModelDefinition model = lams_model();
  model.variables.erase(Quantity::lams_airspeed);
  return model;
}

// Instrument readings in air that moves at `airspeed` with the static defect `defect`.
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

// Writes a flight of readings, `rate` for each record.
void write_readings(const std::filesystem::path& path, const std::vector<double>& time, int rate,
                    const std::vector<Reading>& readings) {
  test::NetcdfMaker maker(path);
  maker.time(time);
  const auto put = [&](const char* name, const char* unit, const auto& value_of) {
    std::vector<double> values;
    for (const Reading& each : readings) values.push_back(value_of(each));
    maker.series(name, unit, values, rate);
  };
  put("PSFD", "mbar", [](const Reading& r) { return r.static_pressure; });
  put("QCF", "hPa", [](const Reading& r) { return r.dynamic_pressure; });
  put("QCR", "Pa", [](const Reading& r) { return 100.0 * r.dynamic_pressure; });
  put("ADIFR", "mb", [](const Reading& r) { return r.attack_pressure; });
  put("TTRR", "deg_C", [](const Reading& r) { return r.recovery_temperature - 273.15; });
  put("VLAMS", "M/s", [](const Reading& r) { return r.beam_speed; });
  maker.series("EDPC", "hPa", std::vector<double>(time.size(), vapor_pressure));
}

// Writes a flight with the given number of records in which the true static pressure is 700 hPa and delta-p
// is 2 hPa.
void write_flight(const std::filesystem::path& path, std::size_t records, int rate, double start = 50000.0) {
  std::vector<Reading> readings;
  for (std::size_t i = 0; i < records * static_cast<std::size_t>(rate); ++i)
    readings.push_back(reading(110.0 + 20.0 * std::sin(0.001 * static_cast<double>(i)), 2.0));
  write_readings(path, test::sequence(start, records), rate, readings);
}

/// Inputs in level flight: name, unit and value.
constexpr std::tuple<const char*, const char*, double> level_flight[] = {
    {"PSFD", "hPa", 700.0}, {"QCF", "hPa", 60.0},    {"TTRR", "deg_C", 5.0},
    {"QCR", "hPa", 60.0},   {"ADIFR", "hPa", -10.0}, {"EDPC", "hPa", 4.0}};

/// Whether the flags of a sample have a bit.
bool has(double flags, Quality bit) {
  return (static_cast<std::uint32_t>(flags) & static_cast<std::uint32_t>(bit)) != 0;
}

class Process : public testing::Test {
 protected:
  /// Setting for flights that are steadier than any real one: a constant sensor does not count as frozen.
  static ProcessOptions steady() {
    ProcessOptions options;
    options.keep_frozen = true;
    return options;
  }

  void expect_frozen(std::size_t count, int rate);

  std::vector<double> read(const std::string& name, const std::string& unit) {
    return test::values_of(Flight(output_), name, unit);
  }

  using Series = std::tuple<const char*, const char*, std::vector<double>>;

  /// Writes a flight of series: name, unit and values.
  void write_series(const std::vector<double>& time, const std::vector<Series>& all) const {
    test::NetcdfMaker maker(input_);
    maker.time(time);
    for (const auto& [name, unit, values] : all) maker.series(name, unit, values);
  }

  /// Writes a level flight. @param flaps percent; empty: not recorded. @param dead sensor that records -9999
  void write_level(std::size_t records, const std::vector<double>& flaps,
                   const std::string& dead = "") const {
    test::NetcdfMaker maker(input_);
    maker.time(test::sequence(50000.0, records));
    for (const auto& [name, unit, level] : level_flight)
      maker.series(name, unit, std::vector<double>(records, name == dead ? -9999.0 : level));
    if (!flaps.empty()) maker.series("FLAPS", "percent", flaps);
  }

  std::string attribute(const std::string& variable, const std::string& name) const {
    return Flight(output_).variable(variable).attribute(name);
  }

  test::TemporaryDirectory directory_;
  std::filesystem::path input_ = directory_.path() / "in.nc";
  std::filesystem::path output_ = directory_.path() / "out.nc";
};

// Values are stored as 32-bit floats: one part in 1.7e7, on each of a few inputs.
TEST_F(Process, RecoversTheTrueAir) {
  write_flight(input_, 200, 1);
  process_flight(input_, lams_model(), output_, {CorrectWith::lams});
  EXPECT_THAT(read("PCOR_LAMS", "hPa"), testing::Each(testing::DoubleNear(2.0, 3e-4)));
  EXPECT_THAT(read("PSXC", "hPa"), testing::Each(testing::DoubleNear(700.0, 3e-4)));
  EXPECT_THAT(read("ATX", "K"), testing::Each(testing::DoubleNear(270.0, 1e-4)));
  EXPECT_THAT(read("ATLAMS", "K"), testing::Each(testing::DoubleNear(270.0, 1e-3)));
  EXPECT_THAT(read("TASX", "m/s")[0], testing::DoubleNear(110.0, 1e-4));
  const std::vector<double> flags = read("PCORFLAG", "");
  EXPECT_THAT(flags, testing::Each(static_cast<double>(Quality::corrected_with_lams)));
}

// Marks of missing values that the file does not name, and a thermometer that is not connected.
TEST_F(Process, ImpossibleValuesAreMissing) {
  write_flight(input_, 20, 1);
  const auto put = [this](const char* name, std::size_t record, float value) {
    int file = 0, number = 0;
    ASSERT_EQ(nc_open(input_.c_str(), NC_WRITE, &file), NC_NOERR);
    ASSERT_EQ(nc_inq_varid(file, name, &number), NC_NOERR);
    ASSERT_EQ(nc_put_var1_float(file, number, &record, &value), NC_NOERR);
    nc_close(file);
  };
  put("PSFD", 3, 1e30F);
  put("PSFD", 4, 9999.0F);
  put("PSFD", 5, -9999.0F);
  put("QCF", 6, 1e20F);
  put("TTRR", 7, 9999.0F);
  int file = 0, dynamic_pressure = 0;
  const float valid_max = 500.0F;
  ASSERT_EQ(nc_open(input_.c_str(), NC_WRITE, &file), NC_NOERR);
  ASSERT_EQ(nc_inq_varid(file, "QCF", &dynamic_pressure), NC_NOERR);
  nc_redef(file);
  ASSERT_EQ(nc_put_att_float(file, dynamic_pressure, "valid_max", NC_FLOAT, 1, &valid_max), NC_NOERR);
  nc_close(file);
  const ProcessSummary summary = process_flight(input_, lams_model(), output_, {CorrectWith::lams});
  const std::vector<double> p = read("PSXC", "hPa"), temperature = read("ATX", "K"),
                            flags = read("PCORFLAG", "");
  for (const std::size_t record : {3U, 4U, 5U, 6U}) {
    EXPECT_TRUE(std::isnan(p[record])) << record;
    EXPECT_TRUE(has(flags[record],
                    record == 6 ? Quality::dynamic_pressure_missing : Quality::static_pressure_missing));
  }
  EXPECT_TRUE(std::isnan(temperature[7]));
  EXPECT_TRUE(has(flags[7], Quality::temperature_missing));
  EXPECT_NEAR(p[8], 700.0, 3e-4) << "and no other variable is affected";
  EXPECT_NEAR(temperature[8], 270.0, 1e-4);
  EXPECT_THAT(summary.notes,
              testing::IsSupersetOf(
                  {"2 samples of PSFD lie outside -2000 to 2000 hPa, which is impossible, and "
                   "are treated as missing",
                   "a sample of PSFD lies above 1e30, which marks missing values, and is treated as missing",
                   "a sample of QCF lies outside the range that the file states as valid, and "
                   "is treated as missing",
                   "a sample of TTRR lies outside 100 to 1000 K, which is impossible, and is "
                   "treated as missing"}));
}

TEST_F(Process, KeepsTheTotalPressure) {
  write_flight(input_, 100, 1);
  process_flight(input_, lams_model(), output_);
  const std::vector<double> p = read("PSXC", "hPa"), q = read("QCXC", "hPa");
  const std::vector<double> measured_p = read("PSFD", "hPa"), measured_q = read("QCF", "hPa");
  for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(p[i] + q[i], measured_p[i] + measured_q[i], 2e-4);
}

TEST_F(Process, HighRateFlightsKeepTheirRate) {
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
TEST_F(Process, ResultIsIndependentOfBlocks) {
  write_flight(input_, 2 * records_per_block + 17, 1);
  process_flight(input_, lams_model(), output_, steady());
  EXPECT_THAT(read("PCOR_LAMS", "hPa"), testing::Each(testing::DoubleNear(2.0, 3e-4)));
}

TEST_F(Process, ReportsProgress) {
  write_flight(input_, records_per_block + 1, 1);
  std::vector<std::size_t> done;
  ProcessOptions options = steady();
  options.progress = [&done](std::size_t now, std::size_t) { done.push_back(now); };
  process_flight(input_, lams_model(), output_, options);
  EXPECT_THAT(done, testing::ElementsAre(records_per_block, records_per_block + 1));
}

TEST_F(Process, OutputsAreRenamed) {
  write_flight(input_, 10, 1);
  ModelDefinition model = lams_model();
  model.output["PCOR"] = "PCORD";
  ProcessOptions options;
  options.suffix = "_NEW";
  const ProcessSummary summary = process_flight(input_, model, output_, options);
  EXPECT_THAT(summary.outputs, Contains("PCORD_NEW"));
  EXPECT_THAT(summary.outputs, Contains("PSXC_NEW"));
}

TEST_F(Process, WorksWithoutALaser) {
  write_flight(input_, 10, 1);
  ModelDefinition model = lams_model();
  model.variables[Quantity::lams_airspeed] = "BEAM1";
  const ProcessSummary summary = process_flight(input_, model, output_);
  EXPECT_THAT(summary.notes, Contains(test::Says("BEAM1")));
  EXPECT_THAT(summary.outputs, testing::Not(Contains("PCOR_LAMS")));
}

TEST_F(Process, RefusesLamsWithoutALaser) {
  write_flight(input_, 10, 1);
  EXPECT_THAT(test::error_of([&] { process_flight(input_, law_model(), output_, {CorrectWith::lams}); }),
              test::IsError(Error::Code::model, "lams_airspeed"));
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(Process, FormulasUseVariablesOfTheFile) {
  write_flight(input_, 10, 1);
  ModelDefinition plain = lams_model();
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

// The loop took TTRR, in degC in the file, for a further input in an unknown unit.
TEST_F(Process, FormulaOfARoleEqualsThatOfTheLoop) {
  write_flight(input_, 10, 1);
  const ModelDefinition file = pressure_model(R"(
recovery_temperature = "TTRR"
[humidity]
moist = false
[[effect]]
id = "thermal"
formula = "3.0 + k * TTRR"
parameters = { k = 0.01 }
)");
  process_flight(input_, file, output_);
  std::string error;
  auto loop = Loop::build(file.model, file.roles(), 1.0, &error);
  ASSERT_TRUE(loop) << error;
  EXPECT_TRUE(loop->extra_names().empty());
  const std::vector<double> defect = read("PCOR", "hPa");
  for (std::size_t i = 0; i < defect.size(); ++i) {
    for (const auto& [role, variable] : file.variables)
      loop->state()[role] = test::values_of(Flight(input_), variable, std::string(info_of(role).unit))[i];
    loop->run(static_cast<double>(i));
    EXPECT_NEAR(loop->state()[Quantity::static_defect], defect[i], 3e-7) << "a 32-bit float of 4 to 8 hPa";
  }
}

TEST_F(Process, CalibratesARecordedAmbientTemperature) {
  write_series(
      test::sequence(100.0, 3),
      {{"PSFD", "hPa", {700, 700, 700}}, {"QCF", "hPa", {60, 60, 60}}, {"ATX", "degC", {-20, 0, 10}}});
  const auto model = [](const std::string& effect) {
    return pressure_model(R"(
ambient_temperature = "ATX"
[humidity]
moist = false
)" + effect);
  };
  const ModelDefinition plain = model(""), calibrated = model(R"(
[[effect]]
id = "temp-calibration"
parameters = { a0 = 0.5, a1 = 0.01, a2 = 0.0005 }
)");
  EXPECT_THAT(process_flight(input_, plain, output_).outputs, testing::Not(Contains("ATX")));
  const double airspeed = read("TASX", "m/s")[0];
  EXPECT_THAT(test::error_of([&] { process_flight(input_, calibrated, output_); }),
              test::IsError(Error::Code::usage, "ATX", "--suffix"));
  ProcessOptions options;
  options.suffix = "_NEW";
  EXPECT_THAT(process_flight(input_, calibrated, output_, options).outputs, Contains("ATX_NEW"));
  // 0.5 - 0.2 + 0.2, 0.5 and 0.5 + 0.1 + 0.05; 32-bit floats of about 10 degC.
  EXPECT_THAT(read("ATX_NEW", "degC"),
              testing::Pointwise(testing::DoubleNear(2e-6), std::vector<double>{-19.5, 0.5, 10.65}));
  // At the same Mach number the airspeed varies with the root of the temperature.
  EXPECT_NEAR(read("TASX_NEW", "m/s")[0] / airspeed, std::sqrt(253.65 / 253.15), 2e-7);
}

/// A flight of `lams_model` whose thermometer is at rest and whose laser airspeed swings with some period.
class FilteredTemperature : public Process {
 protected:
  /// The samples `missing` have no laser airspeed; `time` holds one second for each record.
  void write_swinging(const std::vector<double>& time, int rate, double period,
                      const std::vector<std::size_t>& missing = {}) {
    std::vector<Reading> readings(time.size() * static_cast<std::size_t>(rate), reading(120.0, 2.0));
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const double seconds = static_cast<double>(i) / rate;
      readings[i].beam_speed *= 1.0 + 0.005 * std::sin(2.0 * 3.14159265358979 * seconds / period);
    }
    for (const std::size_t gone : missing) readings[gone].beam_speed = std::nan("");
    write_readings(input_, time, rate, readings);
  }

  std::vector<double> difference() {
    const std::vector<double> filtered = read("ATLAMSF", "K"), unfiltered = read("ATLAMS", "K");
    std::vector<double> difference;
    for (std::size_t i = 0; i < filtered.size(); ++i) difference.push_back(filtered[i] - unfiltered[i]);
    return difference;
  }
};

// The swing is 2.7 K; the filter leaves 0.5 % more or less of a minute, and would show a shift of one sample
// by 0.28 K at 1 Hz and 0.011 K at 25 Hz. At the ends it has part of its window.
TEST_F(FilteredTemperature, HasNoShiftForAnyBlockSize) {
  for (const int rate : {1, 25}) {
    const std::size_t records = records_per_block + 1000;
    write_swinging(test::sequence(50000.0, records), rate, 60.0);
    const ProcessSummary summary = process_flight(input_, lams_model(), output_, steady());
    EXPECT_THAT(summary.outputs, Contains("ATLAMSF"));
    const std::vector<double> found = difference();
    ASSERT_EQ(found.size(), records * static_cast<std::size_t>(rate));
    const std::size_t end = 7 * static_cast<std::size_t>(rate);
    double square = 0.0, maximum = 0.0;
    for (std::size_t i = end; i + end < found.size(); ++i) {
      square += found[i] * found[i];
      maximum = std::max(maximum, std::abs(found[i]));
    }
    EXPECT_LT(maximum, 0.02) << rate << " Hz";
    EXPECT_LT(std::sqrt(square / static_cast<double>(found.size())), rate == 1 ? 0.012 : 0.010);
    // Where half of the weights are within the flight there is a value: from 0.8 s on at 25 Hz.
    for (std::size_t i = 0; i < found.size(); ++i) {
      const std::size_t from_end = std::min(i, found.size() - 1 - i);
      if (rate == 1 || from_end >= 20) {
        ASSERT_FALSE(std::isnan(found[i])) << i;
      } else if (from_end < 10) {
        ASSERT_TRUE(std::isnan(found[i])) << i;
      }
    }
  }
}

TEST_F(FilteredTemperature, LosesPeriodsUnderThreeSeconds) {
  write_swinging(test::sequence(50000.0, 60), 25, 1.5);
  process_flight(input_, lams_model(), output_);
  const std::vector<double> filtered = read("ATLAMSF", "K"), unfiltered = read("ATLAMS", "K");
  const auto swing = [](const std::vector<double>& values) {
    const auto [minimum, maximum] = std::minmax_element(values.begin() + 200, values.end() - 200);
    return *maximum - *minimum;
  };
  EXPECT_GT(swing(unfiltered), 4.0);
  EXPECT_LT(swing(filtered), 0.003 * swing(unfiltered));
}

// Each stretch between gaps is as if it were alone.
TEST_F(FilteredTemperature, IsNotFilteredAcrossGaps) {
  for (const int rate : {1, 25}) {
    std::vector<double> time = test::sequence(50000.0, 40);
    // A short gap, shorter than the tail of the filter; and a stretch shorter than the filter.
    for (const double start : {50042.0, 50200.0, 60000.0}) {
      const std::size_t length = start == 50200.0 ? 3 : 40;
      for (const double each : test::sequence(start, length)) time.push_back(each);
    }
    write_swinging(time, rate, 5.0);
    EXPECT_EQ(process_flight(input_, lams_model(), output_).gaps, 3U);
    const std::vector<double> together = read("ATLAMSF", "K"), unfiltered = read("ATLAMS", "K");
    const std::vector<double> flags = read("PCORFLAG", "");
    const std::size_t samples = static_cast<std::size_t>(rate);
    std::size_t first = 0;
    for (const std::size_t records : {40U, 40U, 3U, 40U}) {
      // The filter by hand, on that stretch alone.
      LowPass filter(Quantity::lams_temperature, Quantity::filtered_lams_temperature, rate);
      for (std::size_t i = 0; i < records * samples + filter.delay(); ++i) {
        State<double> state;
        QualityFlags quality;
        if (i < records * samples) state[Quantity::lams_temperature] = unfiltered[first + i];
        filter.compute(state, quality);
        if (i < filter.delay()) continue;
        const std::size_t position = first + i - filter.delay();
        const double expected = state[Quantity::filtered_lams_temperature];
        if (std::isnan(expected)) {
          ASSERT_TRUE(std::isnan(together[position])) << position;
        } else {
          ASSERT_NEAR(together[position], expected, 1e-4) << position;  // 32-bit floats of degC
        }
        // The bit is set at the sample that has no value.
        ASSERT_EQ(flags[position] == static_cast<double>(Quality::filter_window_incomplete),
                  std::isnan(expected));
      }
      first += records * samples;
    }
  }
}

TEST_F(FilteredTemperature, MissingSampleGivesAMissingResult) {
  write_swinging(test::sequence(50000.0, 60), 1, 60.0, {20, 40, 41, 42, 43, 44});
  const ProcessSummary summary = process_flight(input_, lams_model(), output_);
  const std::vector<double> filtered = read("ATLAMSF", "K"), flags = read("PCORFLAG", "");
  const double lams_missing = static_cast<double>(Quality::lams_missing);
  const double incomplete = static_cast<double>(Quality::filter_window_incomplete);
  std::size_t flagged = 0;
  for (const std::size_t i : {20U, 40U, 42U, 44U}) {
    EXPECT_TRUE(std::isnan(filtered[i]));
    EXPECT_EQ(flags[i], lams_missing);
  }
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (flags[i] != incomplete) continue;
    ++flagged;
    EXPECT_TRUE(std::isnan(filtered[i]));
  }
  EXPECT_FALSE(std::isnan(filtered[30]));
  EXPECT_GE(flagged, 2U) << "the neighbours of a single missing sample";
  std::size_t position = 0;
  while (quality_info[position].bit != Quality::filter_window_incomplete) ++position;
  EXPECT_EQ(summary.flagged[position], flagged);
}

// One sensor of a noisy flight is frozen for two minutes; at 25 Hz for 15 s, which means of a second do not
// show.
void Process::expect_frozen(std::size_t count, int rate) {
  constexpr std::size_t records = 1000;
  const auto samples = static_cast<std::size_t>(rate);
  const std::size_t first = 500 * samples, end = first + count * samples;
  for (const std::string frozen : {"PSFD", "QCF", "TTRR"}) {
    std::mt19937_64 engine(1);
    std::normal_distribution<double> noise(0.0, 0.05);
    auto maker = std::make_unique<test::NetcdfMaker>(input_);
    maker->time(test::sequence(50000.0, records));
    for (const auto& [name, unit, level] : level_flight) {
      std::vector<double> values;
      for (std::size_t i = 0; i < records * samples; ++i) {
        const bool is_held = name == frozen && i > first && i < end;
        const double value = level + std::sin(0.01 * static_cast<double>(i) / rate) + noise(engine);
        values.push_back(is_held ? values.back() : value);
      }
      maker->series(name, unit, values, rate);
    }
    maker.reset();  // writes it
    const ModelDefinition model = law_model();
    const ProcessSummary summary = process_flight(input_, model, output_);
    EXPECT_THAT(summary.notes, Contains(test::Says(frozen + " is frozen")));
    EXPECT_THAT(summary.notes, Contains(test::Says(std::to_string(count) + " records")));
    const std::string result = frozen == "TTRR" ? "TASX" : "PSXC";
    const std::vector<double> missing_values = read(result, ""), flags = read("PCORFLAG", "");
    process_flight(input_, model, output_, steady());
    const std::vector<double> kept = read(result, ""), kept_flags = read("PCORFLAG", "");
    for (std::size_t i = 0; i < records * samples; ++i) {
      const bool is_frozen = i >= first && i < end;
      ASSERT_EQ(has(flags[i], Quality::sensor_frozen), is_frozen) << i;
      ASSERT_EQ(std::isnan(missing_values[i]), is_frozen) << i;
      ASSERT_EQ(has(kept_flags[i], Quality::sensor_frozen), is_frozen) << i;
      ASSERT_FALSE(std::isnan(kept[i])) << i;
    }
  }
}

TEST_F(Process, FrozenSensorGivesMissingValuesAndANote) { expect_frozen(120, 1); }

TEST_F(Process, SensorFrozenForSecondsIsFoundAtTheRecordedRate) { expect_frozen(15, 25); }

// The approach was corrected by a law that was not fitted there, without a bit: on GOTEX it is wrong by 1
// hPa.
TEST_F(Process, ExtendedFlapsAreOutsideTheLawUnlessAnEffectDescribesThem) {
  constexpr std::size_t records = 40, extended_from = 30;
  const auto outside = [&](const ModelDefinition& model, double flaps) {
    std::vector<double> position(records, 0.0);
    std::fill(position.begin() + extended_from, position.end(), flaps);
    write_level(records, position);
    process_flight(input_, model, output_);
    std::size_t marked = 0;
    const std::vector<double> flags = read("PCORFLAG", "");
    for (std::size_t i = 0; i < records; ++i) {
      const bool is_outside = has(flags[i], Quality::outside_domain);
      EXPECT_TRUE(!is_outside || i >= extended_from) << i;
      marked += is_outside ? 1 : 0;
    }
    return marked;
  };
  ModelDefinition model = law_model();
  model.variables[Quantity::flaps] = "FLAPS";
  EXPECT_EQ(outside(model, 50.0), records - extended_from);
  EXPECT_EQ(outside(model, 4.0), 0U);
  ModelDefinition unchanged = model;
  unchanged.model.effects.clear();
  EXPECT_EQ(outside(unchanged, 50.0), 0U);
  ModelDefinition describes_flaps = model;
  describes_flaps.model.effects.push_back(neutral_effect("flaps-gear"));
  EXPECT_EQ(outside(describes_flaps, 50.0), records - extended_from) << "an effect of zero describes nothing";
  describes_flaps.model.effects.back().parameters = {1.5};
  EXPECT_EQ(outside(describes_flaps, 50.0), 0U);
}

// The law has no part in samples that the laser corrects.
TEST_F(Process, NoteOnFlapsExceptsSamplesCorrectedWithLams) {
  constexpr std::size_t records = 40;
  std::vector<Series> all{{"FLAPS", "percent", std::vector<double>(records, 50.0)},
                          {"VLAMS", "m/s", std::vector<double>(records, 117.0)}};
  for (const auto& [name, unit, level] : level_flight)
    all.emplace_back(name, unit, std::vector<double>(records, level));
  write_series(test::sequence(50000.0, records), all);
  ModelDefinition model = lams_model();
  model.variables[Quantity::flaps] = "FLAPS";
  for (const CorrectWith with : {CorrectWith::model, CorrectWith::lams}) {
    ProcessOptions options = steady();
    options.correct_with = with;
    const ProcessSummary summary = process_flight(input_, model, output_, options);
    EXPECT_THAT(summary.notes, Contains(test::Says("flaps extended")));
    // The laser corrects its results in any configuration.
    const auto of_laser = Contains(test::Says("do not use PCOR or results by the model in "));
    if (with == CorrectWith::lams)
      EXPECT_THAT(summary.notes, of_laser);
    else
      EXPECT_THAT(summary.notes, testing::Not(of_laser));
  }
}

// An output without a corrected sample was written with status 0. The search for extended flaps used
// pressures that have no plausible value.
TEST_F(Process, FlightWithoutACorrectedSampleIsRefusedWithTheReason) {
  for (const auto& [dead, reason] :
       {std::pair{"PSFD", "static_pressure_missing"}, {"QCF", "dynamic_pressure_missing"}}) {
    write_level(40, {}, dead);
    EXPECT_THAT(test::error_of([&] { process_flight(input_, law_model(), output_); }),
                test::IsError(Error::Code::samples, "0 of 40 samples", reason, "40 samples"));
    EXPECT_FALSE(std::filesystem::exists(output_));
  }
}

// The reason given was one of no sample.
TEST_F(Process, ReasonOfTheRefusalIsThatOfMostSamples) {
  constexpr std::size_t records = 60;
  const ModelDefinition model = pressure_model(R"(
[[effect]]
id = "own"
where = "static"
formula = "k * dynamic_pressure"
parameters = { k = 2 }
)");
  write_series(test::sequence(50000.0, records), {{"PSFD", "hPa", std::vector<double>(records, 700.0)},
                                                  {"QCF", "hPa", std::vector<double>(records, 60.0)}});
  EXPECT_THAT(test::error_of([&] { process_flight(input_, model, output_); }),
              test::IsError(Error::Code::samples, "defect_exceeds_dynamic_pressure", "60 samples"));
}

// A ground test ended a run of several flights, with the advice to check the units.
TEST_F(Process, FlightThatDidNotFlyGivesAWarning) {
  for (const double q : {-0.05, 0.5, 15.0}) {
    write_series(test::sequence(50000.0, 45), {{"PSFD", "hPa", std::vector<double>(45, 1000.0)},
                                               {"QCF", "hPa", std::vector<double>(45, q)}});
    const ProcessSummary summary = process_flight(input_, pressure_model(""), output_);
    EXPECT_THAT(summary.notes, Contains(test::Says("the aircraft did not fly"))) << q;
    EXPECT_THAT(Flight(output_).attribute("pcor_notes"), HasSubstr("the aircraft did not fly")) << q;
    EXPECT_EQ(summary.in_flight, 0U) << q;
  }
}

TEST_F(Process, FewCorrectedSamplesGiveAWarning) {
  constexpr std::size_t records = 1000;
  const auto warnings = [&](std::size_t flown) {
    std::vector<double> q(records, -1.0);
    std::fill_n(q.begin(), flown, 60.0);
    write_series(test::sequence(50000.0, records),
                 {{"PSFD", "hPa", std::vector<double>(records, 700.0)}, {"QCF", "hPa", q}});
    const ProcessSummary summary = process_flight(input_, pressure_model(""), output_);
    EXPECT_EQ(summary.corrected, flown);
    return std::count_if(summary.notes.begin(), summary.notes.end(),
                         [](const Note& note) { return note.severity == Severity::warning; });
  };
  EXPECT_EQ(warnings(9), 1);
  EXPECT_EQ(warnings(11), 0);
}

// A lag is undone at even samples; at others a bit marks a doubtful value.
TEST_F(Process, ReportsUnevenSamples) {
  std::vector<double> time = test::sequence(50000.0, 100), p, q;
  for (double& each : time) each = 50000.0 + 4.0 * (each - 50000.0);
  for (int i = 0; i < 90; ++i) time.push_back(time.back() + 1.0);
  for (const double each : time) {
    p.push_back(600.0 + 0.5 * (each - 50000.0));
    q.push_back(60.0 + 0.01 * (each - 50000.0));
  }
  write_series(time, {{"PSFD", "hPa", p}, {"QCF", "hPa", q}});
  const ModelDefinition model = pressure_model(R"(
[[effect]]
id = "static-lag"
parameters = { tau = 5.0 }
)");
  process_flight(input_, model, output_);
  const std::vector<double> corrected = read("PSXC", ""), flags = read("PCORFLAG", "");
  for (std::size_t i = 0; i < time.size(); ++i) {
    const bool is_right = std::abs(corrected[i] - p[i] - 2.5) < 0.1;
    const bool is_marked = has(flags[i], Quality::uneven_samples);
    EXPECT_TRUE(is_right || is_marked || std::isnan(corrected[i])) << i;
    EXPECT_TRUE(i >= 80 || !is_marked) << i;  // more than the window before the first of them
  }
}

// A minute on the ramp, where the pressures of moving air are noise, and a minute of flight.
TEST_F(Process, SeparatesRampAndFlight) {
  constexpr std::size_t ramp = 1500;
  constexpr std::size_t samples = 3000;
  std::mt19937_64 engine(1);
  std::normal_distribution<double> noise(0.0, 0.2);
  std::vector<Reading> readings;
  for (std::size_t i = 0; i < samples; ++i) {
    Reading r = reading(110.0 + 20.0 * std::sin(0.01 * static_cast<double>(i)), 2.0);
    if (i < ramp) r = {900.0, noise(engine), noise(engine), 288.0, 0.0};
    readings.push_back(r);
  }
  write_readings(input_, test::sequence(50000.0, samples / 25), 25, readings);
  const ProcessSummary summary = process_flight(input_, law_model(), output_);
  const std::vector<double> airspeed = read("TASX", "m/s"), defect = read("PCOR", "hPa"),
                            flags = read("PCORFLAG", "");
  double sum = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    EXPECT_EQ(has(flags[i], Quality::no_airflow), i < ramp) << i;
    EXPECT_EQ(std::isnan(airspeed[i]), i < ramp) << i;
    if (i >= ramp) sum += defect[i] / (samples - ramp);
  }
  EXPECT_EQ(summary.in_flight, samples - ramp);
  EXPECT_NEAR(summary.mean_defect, sum, 1e-6) << "32-bit floats of about 1 to 10 hPa";
  // Half of 1.225 kg/m3 times the square of 60 m/s, and 0.8 % for the compression: M^2/4.
  EXPECT_NEAR(summary.flying_dynamic_pressure, 22.05 * 1.008, 0.02);
}

ModelDefinition uncertain_model() {
  ModelDefinition file = lams_model();
  file.fits.resize(file.model.effects.size());
  file.fits[0] = {{false, 1e-4, {}}};
  file.uncertainty.roles[Quantity::static_pressure] = 0.03;
  return file;
}

TEST_F(Process, WritesUncertaintiesBesideTheirResults) {
  write_flight(input_, 20, 1);
  ModelDefinition file = uncertain_model();
  file.output["PSXC"] = "PSFDC";
  ProcessOptions options;
  options.suffix = "_NEW";
  const ProcessSummary summary = process_flight(input_, file, output_, options);
  EXPECT_THAT(summary.outputs, Contains("PSFDC_uncertainty_NEW"));
  EXPECT_EQ(attribute("PSFDC_NEW", "ancillary_variables"), "PSFDC_uncertainty_NEW PCORFLAG_NEW");
  EXPECT_EQ(attribute("PSFDC_uncertainty_NEW", "standard_name"), "air_pressure standard_error");
  EXPECT_EQ(attribute("ATX_uncertainty_NEW", "units"), "K");
  EXPECT_THAT(attribute("PSFDC_uncertainty_NEW", "comment"), HasSubstr("systematic part"));
  // a0 is of the measured static pressure, 698 hPa; 32-bit floats. The noise of p moves delta-p by 0.4 %.
  EXPECT_NEAR(read("PCOR_uncertainty_NEW", "hPa")[5], std::hypot(1e-4 * 698.0, 0.004 * 0.03), 1e-5);
  EXPECT_NEAR(read("PSFDC_uncertainty_NEW", "hPa")[5], std::hypot(1e-4 * 698.0, 0.03), 1e-4);
  const auto is_of_thermometer = [](const Note& note) {
    return note.text.find("temp-offset.offset") != std::string::npos &&
           note.text.find("0.3") != std::string::npos;
  };
  EXPECT_EQ(std::count_if(summary.notes.begin(), summary.notes.end(), is_of_thermometer), 1);
  // The thermometer's 0.3 K and 0.005 of the recovery heating, about 8 K: all other terms are smaller.
  EXPECT_NEAR(read("ATX_uncertainty_NEW", "K")[5], 0.3, 0.01);
}

TEST_F(Process, UncertaintiesEqualThoseOfTheLoop) {
  write_flight(input_, 20, 1);
  const ModelDefinition file = uncertain_model();
  process_flight(input_, file, output_);
  std::string error;
  auto loop = Loop::build(file.model, file.roles(), 1.0, &error, CorrectWith::model, uncertainty_of(file));
  ASSERT_TRUE(loop) << error;
  for (const auto& [role, variable] : file.variables)
    loop->state()[role] = read(variable, std::string(info_of(role).unit))[0];
  loop->run(0.0);
  for (const auto& [name, quantity] :
       {std::pair{"ATX_uncertainty", Quantity::ambient_temperature_uncertainty},
        {"PSXC_uncertainty", Quantity::corrected_static_pressure_uncertainty},
        {"TASX_uncertainty", Quantity::corrected_airspeed_uncertainty}}) {
    // 32-bit floats
    EXPECT_NEAR(loop->state()[quantity] / read(name, std::string(info_of(quantity).unit))[0], 1.0, 1e-5)
        << name;
  }
}

TEST_F(Process, WritesTheRequestedUncertainties) {
  write_flight(input_, 20, 1);
  ProcessOptions options;
  options.uncertainty = UncertaintyPart::systematic;
  process_flight(input_, uncertain_model(), output_, options);
  EXPECT_NEAR(read("PSXC_uncertainty", "hPa")[5], 1e-4 * 698.0, 1e-5);
  options.uncertainty = UncertaintyPart::random;
  process_flight(input_, uncertain_model(), output_, options);
  EXPECT_NEAR(read("PSXC_uncertainty", "hPa")[5], 0.03, 2e-4);
  options.uncertainty = UncertaintyPart::none;
  EXPECT_THAT(process_flight(input_, uncertain_model(), output_, options).outputs,
              testing::Not(Contains("PSXC_uncertainty")));
}

TEST_F(Process, LaserCorrectedResultsHaveNoUncertainty) {
  write_flight(input_, 20, 1);
  process_flight(input_, uncertain_model(), output_, {CorrectWith::lams});
  EXPECT_GT(read("PCOR_uncertainty", "hPa")[5], 0.0);
  EXPECT_TRUE(std::isnan(read("PSXC_uncertainty", "hPa")[5]));
}

// The law was not fitted there: on GOTEX it is wrong by four of its standard uncertainties.
TEST_F(Process, ExtendedFlapsHaveNoUncertaintyAndTheirTimes) {
  constexpr std::size_t records = 40, extended_from = 30;
  std::vector<double> position(records, 0.0);
  std::fill(position.begin() + extended_from, position.end(), 50.0);
  write_level(records, position);
  ModelDefinition model = uncertain_model();
  model.variables.erase(Quantity::lams_airspeed);
  model.variables[Quantity::flaps] = "FLAPS";
  const ProcessSummary summary = process_flight(input_, model, output_);
  for (const char* const name : {"PCOR", "PSXC", "QCXC", "ATX", "TASX"}) {
    const std::vector<double> values = read(name, ""), stated = read(std::string(name) + "_uncertainty", "");
    for (std::size_t i = 0; i < records; ++i) {
      EXPECT_FALSE(std::isnan(values[i])) << name << ' ' << i;
      EXPECT_EQ(std::isnan(stated[i]), i >= extended_from) << name << ' ' << i;
    }
  }
  ASSERT_EQ(summary.outside.size(), 1U);
  EXPECT_EQ(summary.outside[0].reason, "flaps extended");
  // The value of a record belongs to its middle.
  EXPECT_EQ(summary.outside[0].begin - summary.start_time, 30.5);
  EXPECT_EQ(summary.outside[0].end - summary.outside[0].begin, 10.0);
  EXPECT_THAT(summary.notes, Contains(test::Says("do not use 10 of 40 records")));
}

TEST_F(Process, SamplesOutsideTheDomainHaveTheirTimes) {
  write_flight(input_, 1200, 1);
  ModelDefinition model = uncertain_model();
  model.model.domain = {{"dynamic_pressure", 0.0, 60.0}};  // up to 112 m/s of 110 to 130 m/s
  const ProcessSummary summary = process_flight(input_, model, output_, steady());
  ASSERT_EQ(summary.outside.size(), 1U);
  EXPECT_EQ(summary.outside[0].reason, "outside the domain");
  EXPECT_THAT(summary.notes, Contains(test::Says("outside the domain of the law")));
  const std::vector<double> stated = read("PSXC_uncertainty", "");
  const auto is_unknown = [](double value) { return std::isnan(value); };
  const auto unknown = std::count_if(stated.begin(), stated.end(), is_unknown);
  EXPECT_EQ(static_cast<double>(unknown), summary.outside[0].end - summary.outside[0].begin);
  EXPECT_LT(unknown, 1200);
}

// With the thermometer alone the uncertainties of the pressures were zero.
TEST_F(Process, PressuresHaveNoUncertaintyWithoutTheErrorOfDeltaP) {
  write_flight(input_, 20, 1);
  ModelDefinition model = lams_model();
  model.uncertainty.roles[Quantity::recovery_temperature] = 0.3;
  const std::vector<std::string> outputs = process_flight(input_, model, output_).outputs;
  EXPECT_THAT(outputs, Contains("ATX_uncertainty"));
  for (const char* const name : {"PCOR_uncertainty", "PSXC_uncertainty", "QCXC_uncertainty"})
    EXPECT_THAT(outputs, testing::Not(Contains(name)));
  model.uncertainty.static_defect = 0.1;
  EXPECT_THAT(process_flight(input_, model, output_).outputs, Contains("PSXC_uncertainty"));
}

TEST_F(Process, WarnsOfAnUndeterminedDefect) {
  write_flight(input_, 20, 1);
  ModelDefinition file = law_model();
  file.uncertainty.static_defect = 0.3;
  const auto warning = Contains(test::Says("delta-p is not determined"));
  EXPECT_THAT(process_flight(input_, file, output_).notes, testing::Not(warning));
  file.uncertainty.static_defect = 4.0;
  const ProcessSummary summary = process_flight(input_, file, output_);
  EXPECT_NEAR(summary.defect_uncertainty, 4.0, 0.01) << "the sensors add less than 0.01 hPa";
  EXPECT_THAT(summary.notes, warning);
  EXPECT_THAT(format_defect(summary), HasSubstr("4.00 hPa"));
}

// Kelvin labelled degrees Celsius: the recovery temperature is possible, the ambient one is not.
TEST_F(Process, ThermometerInAWrongUnitIsNamed) {
  for (const double offset : {0.0, 273.15}) {
    {
      test::NetcdfMaker maker(input_);
      maker.time(test::sequence(50000.0, 40));
      for (const auto& [name, unit, level] : level_flight) {
        const bool is_thermometer = std::string_view(name) == "TTRR";
        maker.series(name, unit, std::vector<double>(40, level + (is_thermometer ? offset : 0.0)));
      }
    }
    const Notes notes = process_flight(input_, law_model(), output_, steady()).notes;
    EXPECT_EQ(std::any_of(notes.begin(), notes.end(),
                          [](const Note& note) {
                            return note.severity == Severity::warning &&
                                   note.text.find("TTRR") != std::string::npos;
                          }),
              offset > 0.0);
  }
}

TEST_F(Process, AdvisesIfTheModelStatesNoUncertainty) {
  write_flight(input_, 20, 1);
  EXPECT_THAT(process_flight(input_, lams_model(), output_).outputs,
              testing::Not(Contains("PSXC_uncertainty")));
  ProcessOptions options;
  for (const UncertaintyPart part :
       {UncertaintyPart::total, UncertaintyPart::systematic, UncertaintyPart::random}) {
    options.uncertainty = part;
    EXPECT_THAT(test::error_of([&] { process_flight(input_, lams_model(), output_, options); }),
                test::IsError(Error::Code::model, "'pcor refit'", "--uncertainty"));
  }
}

const std::string temperature_and_humidity = "recovery_temperature = \"TTRR\"\nvapor_pressure = \"EDPC\"\n";

// In air of one temperature the hydrostatic equation has a closed form: H = R_a T/g0 ln(p_0/p).
TEST_F(Process, HydrostaticStepsSumToTheHeight) {
  const double nan = std::nan("");
  const std::vector<double> p{900, 850, 800, 700, 600, nan, 500, 400};
  write_series({100, 101, 102, 103, 104, 105, 106, 200}, {{"PSFD", "hPa", p},
                                                          {"QCF", "hPa", std::vector<double>(8, 60.0)},
                                                          {"TTRR", "degC", std::vector<double>(8, 5.0)},
                                                          {"EDPC", "hPa", std::vector<double>(8, 0.0)}});
  ModelDefinition model = pressure_model(temperature_and_humidity);
  EXPECT_THAT(process_flight(input_, model, output_).outputs, testing::Not(Contains("HYDSTEP")));
  model.model.effects.push_back({"temp-calibration", {0.5, -0.01, 0.0001}});
  ProcessOptions options;
  options.hydrostatic = true;
  EXPECT_THAT(process_flight(input_, model, output_, options).outputs, Contains("HYDSTEP"));
  const std::vector<double> steps = read("HYDSTEP", "m/K");
  // 29.2712 m/K is R_d/g0 of dry air, 287.05/9.80665 in the US Standard Atmosphere: its scale height at
  // 288.15 K is 8434.5 m.
  EXPECT_NEAR((steps[1] + steps[2] + steps[3] + steps[4]) * 288.15, 8434.5 * std::log(900.0 / 600.0), 0.5);
  for (const std::size_t none : {0U, 5U, 6U, 7U}) EXPECT_TRUE(std::isnan(steps[none])) << none;
  EXPECT_EQ(Flight(output_).variable("HYDSTEP").units, "m/K");
  EXPECT_EQ(attribute("HYDSTEP", "temperature_calibration"), "0.5 -0.01 0.0001");
  EXPECT_EQ(attribute("HYDSTEP", "Dependencies"), "2 PSXC EDPC");
  model.model.effects.clear();
  process_flight(input_, model, output_, options);
  EXPECT_EQ(attribute("HYDSTEP", "temperature_calibration"), "0 0 0");
}

// Vapour makes air lighter: R_a grows by 0.378 e/p.
TEST_F(Process, HydrostaticStepsIncludeVapour) {
  write_series({100, 101}, {{"PSFD", "hPa", {900, 890}},
                            {"QCF", "hPa", {60, 60}},
                            {"TTRR", "degC", {20, 20}},
                            {"EDPC", "hPa", {9.0, 8.9}}});
  const ModelDefinition model = pressure_model(temperature_and_humidity);
  ProcessOptions options;
  options.hydrostatic = true;
  process_flight(input_, model, output_, options);
  const double dry = 8434.5 / 288.15 * std::log(900.0 / 890.0);
  EXPECT_NEAR(read("HYDSTEP", "m/K")[1] / dry, 1.0 + 0.378 * 0.01, 1e-4);
}

// In a descent at a constant rate a lagging line reads tau dp/dt too low.
// A lag needs samples before and after; each gap ends a series, of which nothing is lost but a sample that is
// alone.
TEST_F(Process, RatesAreAvailableOnBothSidesOfAGap) {
  write_series({100, 101, 102, 103, 203, 204, 304}, {{"PSFD", "hPa", {700, 701, 702, 703, 800, 801, 900}},
                                                     {"QCF", "hPa", std::vector<double>(7, 60.0)}});
  const ModelDefinition model = pressure_model(R"(
[humidity]
moist = false
[[effect]]
id = "static-lag"
parameters = { tau = 0.5 }
)");
  const ProcessSummary summary = process_flight(input_, model, output_);
  EXPECT_EQ(summary.gaps, 2U);
  const std::vector<double> p = read("PSXC", "hPa");
  using testing::DoubleNear;
  EXPECT_THAT(p, testing::ElementsAre(DoubleNear(700.5, 1e-4), DoubleNear(701.5, 1e-4),
                                      DoubleNear(702.5, 1e-4), DoubleNear(703.5, 1e-4),
                                      DoubleNear(800.5, 1e-4), DoubleNear(801.5, 1e-4), testing::IsNan()));
  const double alone =
      static_cast<double>(Quality::after_gap) + static_cast<double>(Quality::effect_input_missing);
  EXPECT_THAT(read("PCORFLAG", ""), testing::ElementsAre(0, 0, 0, 0, 0, 0, alone));
}

// A heated thermometer of a usual noise in a climb through air without turbulence.
class NoisyLag : public Process {
 protected:
  // @param climb of the temperature, K/s, in the second half of the flight
  ProcessSummary run(double climb, double noise) {
    constexpr std::size_t records = 3000;
    std::mt19937 generator(5);
    std::normal_distribution<double> normal(0.0, noise);
    std::vector<double> temperature(records);
    for (std::size_t i = 0; i < records; ++i)
      temperature[i] = 270.0 + climb * std::max(0.0, static_cast<double>(i) - 1500.0) + normal(generator);
    write_series(test::sequence(100, records), {{"PSFD", "hPa", std::vector<double>(records, 700.0)},
                                                {"QCF", "hPa", std::vector<double>(records, 60.0)},
                                                {"TTRR", "K", temperature}});
    const ModelDefinition model = pressure_model(R"(
recovery_temperature = "TTRR"
[humidity]
moist = false
[[effect]]
id = "temp-lag"
parameters = { tau = 8.0 }
)");
    return process_flight(input_, model, output_, steady());
  }
};

// The noise of neighbours in the result, K.
double scatter(const std::vector<double>& values, std::size_t first, std::size_t count) {
  double sum = 0.0;
  for (std::size_t i = first; i < first + count; ++i) sum += std::pow(values[i] - values[i - 1], 2);
  return std::sqrt(0.5 * sum / static_cast<double>(count));
}

TEST_F(NoisyLag, LagIsCorrectedIfSignalExceedsNoise) {
  constexpr double noise = 0.02;
  const ProcessSummary summary = run(-0.06, noise);
  EXPECT_THAT(summary.notes, Not(Contains(test::Says("not applied"))));
  const std::vector<double> corrected = read("ATX", "K");
  const std::vector<double> recorded = read("TTRR", "K");
  const auto ratio = [&](std::size_t first) {
    return std::accumulate(&corrected[first], &corrected[first] + 1000, 0.0) /
           std::accumulate(&recorded[first], &recorded[first] + 1000, 0.0);
  };
  // Tau times the rate of the recorded temperature, whose mean there is 222 K; noise averages out.
  EXPECT_NEAR((ratio(1800) / ratio(200) - 1.0) * (270.0 - 0.06 * 799.5), 8.0 * -0.06, 0.01);
  // With all periods above 1 s it would be 8 s times 1.5 per second: twelve times as much.
  EXPECT_LT(scatter(corrected, 100, 1000), 2.0 * noise);
}

TEST_F(NoisyLag, LagIsSkippedIfNoiseExceedsErrorReduction) {
  constexpr double noise = 0.1;
  const ProcessSummary summary = run(0.0, noise);
  EXPECT_THAT(summary.notes, Contains(test::Says("temp-lag of 8 s")));
  EXPECT_LT(scatter(read("ATX", "K"), 100, 1000), 1.05 * noise);
}

}  // namespace
}  // namespace pcor
