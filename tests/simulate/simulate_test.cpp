// The simulator compared with laws of nature and with its documentation: truth, sensors, effects, reader.
#include <pcor/simulate/simulate.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/batch/batch.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "simulate/random.hpp"
#include "support/error_of.hpp"
#include "support/temporary_directory.hpp"
#include "support/test_name.hpp"
#include "support/values_of.hpp"

using namespace pcor::internal;

namespace pcor {
namespace {

using testing::IsEmpty;

const std::string head = R"(
format = "pcor-scenario/1"
name = "test"
aircraft = "C-130"
seed = 7
start = 2011-11-17T20:00:00Z
)";

const std::string noiseless = "noiseless = true\n";

const std::string calm = R"(
[atmosphere]
turbulence = 1e-9
boundary_layer = 1e-9
wind_drift = 0.0
)";

const std::string systems = R"(
[[system]]
static = "PSFD"
dynamic = "QCF"
law = { static-constant = 0.004127875, static-alpha = 0.021279816, static-qp = 0.030849643 }
[[system]]
static = "PSFRD"
dynamic = "QCFR"
law = { static-constant = 0.002047, static-alpha = 0.008890, static-qp = 0.07119 }
)";

const std::string aloft = R"(
[[leg]]
kind = "take-off"
altitude = 1500
speed = 110
)";

const std::string noisy_flight = head + systems + aloft;
const std::string quiet_flight = head + noiseless + systems + aloft;
const std::string calm_flight = head + noiseless + calm + systems + aloft;

std::string leg(const std::string& kind, const std::string& numbers = "") {
  return "[[leg]]\nkind = \"" + kind + "\"\n" + numbers + "\n";
}

/// A simulated flight, read back.
class Simulated {
 public:
  explicit Simulated(const std::string& text)
      : summary_(simulate_flight(parse_scenario(text, "test.toml"), directory_ / "flight.nc")),
        flight_(directory_ / "flight.nc") {}

  const SimulationSummary& summary() const { return summary_; }
  const Flight& flight() const { return flight_; }

  std::vector<double> operator()(const std::string& name, const std::string& unit) const {
    return test::values_of(flight_, name, unit);
  }

  /// As the file has it.
  std::vector<double> raw(const std::string& name) const { return test::values_of(flight_, name); }

  /// The records of the last leg of a kind, without `less` seconds at its beginning.
  std::pair<std::size_t, std::size_t> leg(const std::string& kind, double less = 0.0) const {
    for (auto each = summary_.legs.rbegin(); each != summary_.legs.rend(); ++each) {
      if (each->kind != kind) continue;
      return {static_cast<std::size_t>(std::ceil(each->start_time - summary_.start_time + less)),
              std::min(flight_.records(), static_cast<std::size_t>(each->end_time - summary_.start_time))};
    }
    ADD_FAILURE() << "no leg " << kind;
    return {0, 0};
  }

  /// The least and greatest value of a variable in a leg.
  std::pair<double, double> range(const std::string& name, const std::string& kind) const {
    const std::vector<double> values = raw(name);
    const auto [first, last] = leg(kind);
    const auto found = std::minmax_element(values.begin() + static_cast<std::ptrdiff_t>(first),
                                           values.begin() + static_cast<std::ptrdiff_t>(last));
    return {*found.first, *found.second};
  }

 private:
  test::TemporaryDirectory directory_;
  SimulationSummary summary_;
  Flight flight_;
};

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// The names of the variables that are not the same, bit by bit, in two flights.
std::vector<std::string> differences(const Simulated& a, const Simulated& b) {
  std::vector<std::string> names;
  for (const std::string& name : a.flight().variables()) {
    if (!a.flight().variable(name).is_series || name == "Time") continue;
    if (!same_bits(a.raw(name), b.raw(name))) names.push_back(name);
  }
  return names;
}

// Pressures are stored as 32-bit floats: half a unit in the last place is 3e-5 hPa at 1000 hPa, 4e-6 at 100.
constexpr double stored_pressure = 3.1e-5;
constexpr double stored_dynamic = 4e-6;

// Reproducibility

TEST(Simulate, GivesTheSameDataForTheSameSeed) {
  const std::string text = noisy_flight + leg("level", "duration = 60");
  EXPECT_THAT(differences(Simulated(text), Simulated(text)), IsEmpty());
}

TEST(Simulate, GivesOtherDataForAnotherSeed) {
  const std::string text = noisy_flight + leg("level", "duration = 60");
  std::string other = text;
  other.replace(other.find("seed = 7"), 8, "seed = 8");
  EXPECT_FALSE(same_bits(Simulated(other).raw("PSFD"), Simulated(text).raw("PSFD")));
}

TEST(Simulate, TrueVariablesAreMarked) {
  const Simulated flight(noisy_flight + leg("level", "duration = 60"));
  for (const std::string& name : flight.flight().variables()) {
    const bool marked = flight.flight().variable(name).attribute("Category") == truth_category;
    EXPECT_EQ(marked, name.rfind("TRUE_", 0) == 0) << name;
  }
}

TEST(Simulate, SensorNoiseChangesOnlyThatSensor) {
  const std::string text = noisy_flight + leg("level", "duration = 60");
  EXPECT_THAT(differences(Simulated(text), Simulated(text + "[noise]\nQCFR = 0.5\n")),
              testing::ElementsAre("QCFR"));
}

TEST(Random, IsReproducible) {
  // The first number of std::mt19937_64 for the seed of this stream, found once; integers alone decide it.
  simulate::Random a(1, "QCF");
  simulate::Random b(1, "QCF");
  simulate::Random c(1, "QCR");
  const double first = a.uniform();
  EXPECT_EQ(first, b.uniform());
  EXPECT_NE(first, c.uniform());
}

TEST(Random, IsNormallyDistributed) {
  simulate::Random random(3, "normal");
  constexpr int count = 200000;
  double sum = 0.0, square = 0.0, fourth = 0.0;
  for (int i = 0; i < count; ++i) {
    const double x = random.normal();
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
  }
  // Five standard errors: 1, sqrt(2) and sqrt(96) over sqrt(count).
  EXPECT_NEAR(sum / count, 0.0, 0.011);
  EXPECT_NEAR(square / count, 1.0, 0.016);
  EXPECT_NEAR(fourth / count, 3.0, 0.11);
}

// The air

TEST(Simulate, TurbulenceFollowsTheTwoThirdsLaw) {
  simulate::Turbulence turbulence(5, "gust", false);
  constexpr double step = 5.0, dissipation = 1e-3;
  std::vector<double> u(400000);
  for (double& value : u) value = turbulence.next(step, dissipation);
  for (const std::size_t lag : {8U, 16U, 32U, 64U}) {
    double sum = 0.0;
    for (std::size_t i = lag; i < u.size(); ++i) sum += (u[i] - u[i - lag]) * (u[i] - u[i - lag]);
    const double structure = sum / static_cast<double>(u.size() - lag);
    const double distance = step * static_cast<double>(lag);
    // D = 4.02 alpha (eps r)^(2/3), alpha 0.49. The scales end at 3 km, a factor of ten above the longest r,
    // and beyond it there is less energy than by the law.
    const double law = 4.02 * 0.49 * std::pow(dissipation * distance, 2.0 / 3.0);
    EXPECT_NEAR(structure / law, 0.95, 0.1) << distance << " m";
  }
}

TEST(Simulate, AirIsInHydrostaticBalance) {
  const Simulated flight(calm_flight + leg("climb", "altitude = 6000"));
  const auto z = flight("TRUE_ALT", "m"), p = flight("TRUE_PS", "hPa"), t = flight("TRUE_AT", "K"),
             e = flight("TRUE_EW", "hPa");
  const auto [first, last] = flight.leg("climb");
  double integral = 0.0;
  const auto slope = [&](std::size_t i) {
    // Gravity of 1980 with the free-air gradient; gas constant by virtual temperature.
    const double g =
        9.780327 * (1.0 + 0.0053024 * std::pow(std::sin(40.0 * M_PI / 180.0), 2.0)) - 3.086e-6 * z[i];
    return g * (1.0 - 0.378 * e[i] / p[i]) / (287.065 * t[i]);
  };
  for (std::size_t i = first + 1; i < last; ++i)
    integral -= 0.5 * (slope(i) + slope(i - 1)) * (z[i] - z[i - 1]);
  // The formulas of gravity and of the virtual temperature differ by 3e-5 each.
  EXPECT_NEAR(integral / std::log(p[last - 1] / p[first]), 1.0, 1e-4);
  EXPECT_LT(integral, -0.4);
}

TEST(Simulate, GroundVelocityIsAirVelocityPlusWind) {
  const Simulated flight(quiet_flight + leg("turn") + leg("yaw"));
  const auto speed = flight("GGSPD", "m/s"), track = flight("GGTRK", "degree"),
             heading = flight("THDG", "degree"), airspeed = flight("TASX", "m/s"),
             sideslip = flight("TRUE_BETA", "degree"), east = flight("TRUE_UE", "m/s"),
             north = flight("TRUE_UN", "m/s");
  const auto [first, last] = flight.leg("yaw");
  for (std::size_t i = first; i < last; ++i) {
    const double through = (heading[i] + sideslip[i]) * M_PI / 180.0;
    // A sideslip of 4 deg times the change of airspeed by gusts within a second.
    EXPECT_NEAR(airspeed[i] * std::sin(through) + east[i], speed[i] * std::sin(track[i] * M_PI / 180.0), 0.1);
    EXPECT_NEAR(airspeed[i] * std::cos(through) + north[i], speed[i] * std::cos(track[i] * M_PI / 180.0),
                0.1);
  }
}

// Pressures

TEST(Simulate, TotalPressureOfTwoSystemsIsOne) {
  const Simulated flight(quiet_flight + leg("pitch"));
  const auto p1 = flight("PSFD", "hPa"), q1 = flight("QCF", "hPa"), p2 = flight("PSFRD", "hPa"),
             q2 = flight("QCFR", "hPa"), total = flight("TRUE_PT", "hPa");
  for (std::size_t i = 0; i < p1.size(); ++i) {
    EXPECT_NEAR(p1[i] + q1[i], p2[i] + q2[i], 2.0 * (stored_pressure + stored_dynamic));
    EXPECT_NEAR(p1[i] + q1[i], total[i], 3.0 * stored_pressure);
  }
}

TEST(Simulate, DefectFollowsTheLawOfMeasuredQuantities) {
  const Simulated flight(head + "rate = 25\n" + noiseless + systems + aloft + leg("pitch"));
  const auto p = flight("PSFD", "hPa"), q = flight("QCF", "hPa"), qr = flight("QCR", "hPa"),
             a = flight("ADIFR", "hPa"), truth = flight("TRUE_PS", "hPa"),
             defect = flight("TRUE_PCOR_PSFD", "hPa");
  EXPECT_EQ(flight.flight().variable("PSFD").rate, 25);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_NEAR(p[i], truth[i] - defect[i], 2.0 * stored_pressure);
    if (q[i] < 25.0) continue;  // the law fades where there is little flow
    ++compared;
    const double law = p[i] * (0.004127875 + 0.021279816 * a[i] / qr[i] + 0.030849643 * q[i] / p[i]);
    EXPECT_NEAR(defect[i], law, 2e-6);  // 1e-7 relative of 10 hPa, the size of the terms
  }
  EXPECT_GT(compared, 5000U);
}

TEST(Simulate, LamsRecoversTheDefect) {
  const std::string text = head + noiseless + "[lams]\nelevation = 1.5\nazimuth = -0.8\n" + systems + aloft +
                           leg("pitch") + leg("speed-run", "low = 95\nhigh = 125") + leg("yaw");
  const Simulated flight(text);
  const ModelDefinition model = parse_model(R"(
format = "pcor-model/1"
name = "laser only"
[variables]
static_pressure = "PSFD"
dynamic_pressure = "QCF"
recovery_temperature = "TTRR"
vapor_pressure = "EDPC"
attack = "ATTACK"
sideslip = "SSLIP"
lams_airspeed = "VLAMS"
[lams]
elevation = 1.5
azimuth = -0.8
[temperature]
recovery_factor = 0.95
)",
                                            "model.toml");
  const std::map<Quantity, std::vector<double>> recorded{
      {Quantity::static_pressure, flight("PSFD", "hPa")},
      {Quantity::dynamic_pressure, flight("QCF", "hPa")},
      {Quantity::recovery_temperature, flight("TTRR", "K")},
      {Quantity::vapor_pressure, flight("EDPC", "hPa")},
      {Quantity::attack, flight("ATTACK", "degree")},
      {Quantity::sideslip, flight("SSLIP", "degree")},
      {Quantity::lams_airspeed, flight("VLAMS", "m/s")}};
  std::vector<Quantity> quantities;
  std::vector<Batch::Input> inputs;
  for (const auto& [quantity, values] : recorded) {
    quantities.push_back(quantity);
    inputs.push_back({quantity, values.data()});
  }
  std::vector<double> found(flight.flight().records());
  Batch(model.model, quantities).run(inputs, {{Quantity::lams_static_defect, found.data()}}, found.size());
  const auto defect = flight("TRUE_PCOR_PSFD", "hPa");
  for (const std::string kind : {"speed-run", "pitch", "yaw"}) {
    const auto [first, last] = flight.leg(kind);
    double square = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      // The beam's cosine as a product errs by 6e-5 of the airspeed at angles of 5 deg, 0.008 hPa; means over
      // a second of pressures and speeds that gusts change are not those of one moment.
      EXPECT_NEAR(found[i], defect[i], 0.05) << kind << ' ' << i;
      square += std::pow(found[i] - defect[i], 2.0);
    }
    EXPECT_LT(std::sqrt(square / static_cast<double>(last - first)), 0.01) << kind;
  }
}

TEST(Simulate, AvionicsMachNumberFulfilsEquation20) {
  const Simulated flight(R"(
format = "pcor-scenario/1"
name = "equation 20"
aircraft = "GV"
rate = 25
noiseless = true
[avionics]
response = 0.0
delay = 0.0
law = { static-constant = 0.00696, static-qp = 0.6678, static-mach = -0.05965, static-mach2 = -0.2833, static-mach3 = -0.2437 }
[[system]]
static = "PSF"
dynamic = "QCF"
law = { static-constant = -0.012255, static-qp = 0.075372, static-mach3 = -0.087508, static-attack = 0.002148 }
[[leg]]
kind = "take-off"
altitude = 3000
speed = 150
[[leg]]
kind = "level"
duration = 30
)");
  const auto p = flight("PSF", "hPa"), q = flight("QCF", "hPa"), m = flight("MACH_A", "1"),
             truth = flight("TRUE_MACH", "1"), defect = flight("TRUE_PCOR_PSF", "hPa");
  const auto [first, last] = flight.leg("level");
  for (std::size_t i = 25 * first; i < 25 * last; ++i) {
    const double law =
        p[i] * (0.00696 + 0.6678 * q[i] / p[i] + m[i] * (-0.05965 + m[i] * (-0.2833 - 0.2437 * m[i])));
    EXPECT_NEAR(defect[i], law, 5e-5);  // terms of 80 hPa, stored to 6e-8 of themselves
    EXPECT_NEAR(defect[i], -2.0, 1.5);  // the law of 2014 at 700 hPa
    EXPECT_NEAR(m[i], truth[i], 0.01);
  }
}

// Manoeuvres: the sizes of NCAR's calibration flights

TEST(Simulate, FliesPitchManoeuvres) {
  const Simulated flight(calm_flight + leg("pitch"));
  const auto [down, up] = flight.range("BNORMA", "pitch");
  EXPECT_NEAR(up, 4.0, 0.1);  // m/s2; means over a second of a period of 20 s lose 0.4 %
  EXPECT_NEAR(down, -4.0, 0.1);
  const auto [sinks, climbs] = flight.range("GGVSPD", "pitch");
  EXPECT_NEAR(climbs, 12.7, 0.2);  // 4 m/s2 20 s/(2 pi)
  EXPECT_NEAR(sinks, -12.7, 0.2);
  const auto [low, high] = flight.range("GGALT", "pitch");
  EXPECT_NEAR(high - low, 81.0, 3.0);
  EXPECT_NEAR(high + low, 2.0 * 1500.0, 8.0);
  const auto [minimum, maximum] = flight.range("TRUE_ALPHA", "pitch");
  EXPECT_NEAR(0.5 * (maximum - minimum), 2.2, 0.5);
}

TEST(Simulate, FliesYawManoeuvres) {
  const Simulated flight(calm_flight + leg("yaw"));
  const auto [port, starboard] = flight.range("TRUE_BETA", "yaw");
  EXPECT_NEAR(starboard, 4.0, 0.1);  // means over a second of a period of 12 s lose 1.1 %
  EXPECT_NEAR(port, -4.0, 0.1);
  const auto [first, last] = flight.leg("yaw");
  EXPECT_NEAR(static_cast<double>(last - first), 144.0, 2.0);
  const auto [left, right] = flight.range("ROLL", "yaw");
  EXPECT_LT(right - left, 0.1);
}

TEST(Simulate, FliesSpeedRuns) {
  const Simulated flight(calm_flight + leg("speed-run", "low = 98\nhigh = 140"));
  const auto [slow, fast] = flight.range("TASX", "speed-run");
  EXPECT_NEAR(slow, 98.0, 0.5);
  EXPECT_NEAR(fast, 140.0, 0.5);
  const auto [low, high] = flight.range("GGALT", "speed-run");
  EXPECT_LT(high - low, 20.0);
  const auto v = flight("TASX", "m/s");
  const auto [first, last] = flight.leg("speed-run");
  std::size_t fast_enough = 0;
  for (std::size_t i = first + 1; i < last; ++i) fast_enough += std::abs(v[i] - v[i - 1]) >= 0.2 ? 1 : 0;
  EXPECT_GT(fast_enough, 2U * 75U);  // both branches
}

TEST(Simulate, FliesReverseHeadings) {
  const Simulated flight(calm_flight + leg("reverse-heading"));
  const auto heading = flight("THDG", "degree");
  const auto [first, last] = flight.leg("reverse-heading", 10.0);
  EXPECT_NEAR(std::abs(heading[last - 2] - heading[first]), 180.0, 1.0);
  const auto [low, high] = flight.range("GGALT", "reverse-heading");
  EXPECT_LT(high - low, 40.0);
}

TEST(Simulate, FliesCircles) {
  const Simulated flight(calm_flight + leg("circle", "angle = -360"));
  const auto [left, right] = flight.range("ROLL", "circle");
  EXPECT_NEAR(left, -26.7, 0.01);
  EXPECT_LT(right, 0.01);
  const auto [first, last] = flight.leg("circle");
  // 2 pi v/(g tan(roll)) = 140 s at 110 m/s, and what rolling in and out takes longer.
  EXPECT_NEAR(static_cast<double>(last - first), 140.0 + 12.0, 12.0);
}

// Effects

TEST(Simulate, StaticLagIsProportionalToThePressureRate) {
  constexpr double tau = 0.5;
  const Simulated flight(head + noiseless + calm + "[[system]]\nstatic = \"PSFD\"\ndynamic = \"QCF\"\n" +
                         aloft + leg("climb", "altitude = 4000") +
                         "[[effect]]\nid = \"static-lag\"\ntau = 0.5\n");
  const auto p = flight("PSFD", "hPa"), truth = flight("TRUE_PS", "hPa");
  const auto [first, last] = flight.leg("climb", 60.0);
  for (std::size_t i = first; i + 120 < last; ++i) {
    const double rate = 0.5 * (truth[i + 1] - truth[i - 1]);
    EXPECT_LT(rate, -0.3);
    // Storage in both, and tau^2 d2p/dt2 = 0.25 * 3e-4.
    EXPECT_NEAR(p[i] - truth[i], -tau * rate, 2e-4);
  }
}

// Changes of an effect in the file, and no others. A change of the static pressure at the port also changes
// QCR and the radome's differentials, which are in proportion to it.
struct Change {
  std::string effect;
  std::vector<std::string> variables;
};

void PrintTo(const Change& change, std::ostream* stream) { *stream << change.effect; }

class EffectOfScenario : public testing::TestWithParam<Change> {};

TEST_P(EffectOfScenario, ChangesOnlyTheAffectedVariables) {
  const std::string text = head + noiseless + R"(
[atmosphere]
cloud = [{ base = 1000, top = 2000, cover = 0.4 }]
)" + systems + aloft + leg("level", "duration = 60") +
                           leg("pitch", "cycles = 2") + leg("yaw", "cycles = 3") + leg("turn");
  EXPECT_THAT(differences(Simulated(text), Simulated(text + "[[effect]]\nid = " + GetParam().effect + "\n")),
              testing::UnorderedElementsAreArray(GetParam().variables));
}

const std::vector<std::string> static_of_first{"PSFD", "QCF", "TRUE_PCOR_PSFD", "QCR", "ADIFR", "BDIFR"};
const std::vector<std::string> static_of_second{"PSFRD", "QCFR", "TRUE_PCOR_PSFRD"};

// ATTACK and SSLIP come from quotients of means, which change in the last digits with QCR.
std::vector<std::string> with_angles(std::vector<std::string> names) {
  names.insert(names.end(), {"ATTACK", "SSLIP"});
  return names;
}

INSTANTIATE_TEST_SUITE_P(
    All, EffectOfScenario,
    testing::Values(
        Change{"\"static-beta-odd\"\non = \"PSFRD\"\nb1 = -0.002", static_of_second},
        Change{"\"load-factor\"\non = \"PSFRD\"\nper_g = 1.0", static_of_second},
        Change{"\"ground-effect\"\non = \"PSFRD\"\ndefect = 0.5", static_of_second},
        Change{"\"line-head\"\non = \"PSFRD\"\nbelow = 1.0", {"PSFRD", "QCFR"}},
        Change{"\"roll-static\"\non = \"PSFRD\"\ndefect = 0.5", static_of_second},
        Change{"\"flaps-gear\"\non = \"PSFRD\"\ndefect = 1.5", static_of_second},
        Change{"\"speedbrake-thrust\"\non = \"PSFD\"\ndefect = 1.0", with_angles(static_of_first)},
        Change{"\"static-lag\"\ntau = 0.3", {"PSFD", "QCF", "PSFRD", "QCFR"}},
        Change{"\"total-lag\"\non = \"QCF\"\ntau = 0.3", {"QCF"}},
        Change{"\"static-leak\"\non = \"PSFRD\"\nfraction = 5e-4", {"PSFRD", "QCFR"}},
        Change{"\"qcf-zero\"\non = \"QCF\"\noffset = 0.3", {"QCF"}},
        Change{"\"qcf-gain\"\non = \"QCF\"\ngain = 0.005", {"QCF"}},
        Change{"\"psfd-bias\"\non = \"PSFD\"\noffset = 0.3", {"PSFD"}},
        Change{"\"transducer-thermal\"\non = \"PSFRD\"\ndynamic = 0.02", {"QCFR"}},
        Change{"\"time-drift\"\non = \"PSFRD\"\nstatic = 0.5", {"PSFRD"}},
        Change{"\"adif-drift\"\ngain = 0.05", {"ADIFR", "ATTACK"}},
        Change{"\"qcr-angle\"\nattack = 0.03", {"QCR", "ATTACK", "SSLIP"}},
        Change{"\"lams-elevation\"\nerror = 0.5", {"VLAMS"}},
        Change{"\"lams-azimuth\"\nerror = 0.5", {"VLAMS"}},
        Change{"\"lams-pod-flex\"\nper_tonne = 0.05", {"VLAMS"}},
        Change{"\"lams-scale\"\nscale = 1e-3", {"VLAMS"}},
        Change{"\"lams-induction\"\nfraction = 3e-3", {"VLAMS"}},
        Change{"\"lams-cloud\"\nerror = -1.0", {"VLAMS"}},
        Change{"\"temp-offset\"\noffset = 0.5", {"TTRR", "RTF1"}},
        Change{"\"recovery-factor\"\nerror = 0.02", {"TTRR", "RTF1"}},
        Change{"\"temp-lag\"\ntau = 2.3", {"TTRR", "RTF1"}},
        Change{"\"temp-deice-heat\"\nheat = 0.5", {"TTRR", "RTF1"}},
        Change{"\"temp-wetting\"\nerror = -1.0", {"TTRR", "RTF1"}},
        Change{"\"humidity-error\"\ngain = 0.1", {"EDPC", "EWX", "DPXC"}},
        Change{"\"humidity-error\"\ndew_point = -2.0", {"EDPC", "EWX", "DPXC"}},
        Change{"\"sensor-response\"\non = \"ADIFR\"\ntau = 0.2", {"ADIFR", "ATTACK"}},
        Change{"\"unknown\"\nof = \"hidden\"\nwhere = \"lams\"\nstrength = 0.3", {"VLAMS"}},
        Change{"\"unknown\"\nof = \"TBAY\"\nwhere = \"temperature\"\nshape = \"quadratic\"\nstrength = 0.01",
               {"TTRR", "RTF1"}}),
    [](const auto& change) { return test::test_name(change.param.effect); });

TEST(Simulate, PitotLossIncreasesWithFlowAngle) {
  const std::string text = calm_flight + leg("yaw");
  const Simulated flight(text + "[[effect]]\nid = \"pitot-angle\"\non = \"QCF\"\nk = 1e-4\n");
  const auto p = flight("PSFD", "hPa"), q = flight("QCF", "hPa"), total = flight("TRUE_PT", "hPa"),
             alpha = flight("TRUE_ALPHA", "degree"), beta = flight("TRUE_BETA", "degree"),
             truth = flight("TRUE_QC", "hPa");
  const auto [first, last] = flight.leg("yaw");
  for (std::size_t i = first; i < last; ++i) {
    const double loss = 1e-4 * truth[i] * (alpha[i] * alpha[i] + beta[i] * beta[i]);
    // The mean of squares over a second in which the sideslip changes by 2.1 deg: 0.37 deg^2 more.
    EXPECT_NEAR(total[i] - p[i] - q[i], loss, 2.7e-3);
    EXPECT_GT(total[i] - p[i] - q[i], 0.0);
  }
}

TEST(Simulate, GroundEffectActsNearTheGround) {
  const std::string text =
      quiet_flight + leg("descent", "altitude = 120\nrate = 8") + leg("level", "duration = 30\nspeed = 90");
  const Simulated without(text);
  const Simulated with(text +
                       "[[effect]]\nid = \"ground-effect\"\non = \"PSFRD\"\ndefect = 0.5\nspan = 40\n");
  const auto d0 = without("TRUE_PCOR_PSFRD", "hPa"), d1 = with("TRUE_PCOR_PSFRD", "hPa"),
             height = with("RALT", "m");
  const auto [first, last] = with.leg("level", 15.0);
  for (std::size_t i = first; i < last; ++i) {
    EXPECT_NEAR(height[i], 20.0, 2.0);
    // By hand: 4 h/b = 2, so a fifth. The law answers to the extra defect with some percent of it.
    EXPECT_NEAR(d1[i] - d0[i], 0.1, 0.02);
  }
  const auto [high, end] = with.leg("descent");
  EXPECT_LT(end - high, 400U);
  EXPECT_LT(std::abs(d1[high] - d0[high]), 1e-4);
}

TEST(Simulate, LineHeadDependsOnTheWeightOfAir) {
  const std::string text = calm_flight + leg("level", "duration = 60") + leg("pitch", "cycles = 2") +
                           leg("speed-run", "low = 100\nhigh = 130\nrate = 0.5");
  const Simulated without(text);
  const std::string effect = "[[effect]]\nid = \"line-head\"\non = \"PSFRD\"\n";
  const Simulated below(text + effect + "below = 2.0\n");
  const Simulated behind(text + effect + "behind = 5.0\n");
  const auto p = without("PSFRD", "hPa"), lower = below("PSFRD", "hPa"), aft = behind("PSFRD", "hPa"),
             normal = without("BNORMA", "m/s2"), forward = without("BLONA", "m/s2"),
             bay = without("TBAY", "K");
  for (const std::string kind : {"pitch", "speed-run"}) {
    const auto [first, last] = without.leg(kind);
    for (std::size_t i = first; i < last; ++i) {
      const double density = 100.0 * p[i] / (287.05 * bay[i]);
      // The line's density is that of the true pressure, 1 % from the measured one.
      EXPECT_NEAR(lower[i] - p[i], 0.01 * density * 2.0 * (9.80665 + normal[i]), 5e-3);
      EXPECT_NEAR(aft[i] - p[i], 0.01 * density * 5.0 * forward[i], 3e-3);
    }
  }
}

TEST(Simulate, ForwardAccelerationMatchesSpeedAndGravity) {
  const Simulated flight(calm_flight + leg("speed-run", "low = 100\nhigh = 130\nrate = 0.5"));
  const auto speed = flight("TASX", "m/s"), forward = flight("BLONA", "m/s2"),
             pitch = flight("PITCH", "degree");
  const auto [first, last] = flight.leg("speed-run");
  double square = 0.0;
  for (std::size_t i = first + 1; i + 1 < last; ++i) {
    const double of_speed = forward[i] - 9.8 * std::sin(pitch[i] * M_PI / 180.0);
    const double miss = of_speed - 0.5 * (speed[i + 1] - speed[i - 1]);
    // Where the run turns from -0.5 to 0.5 m/s2, a difference over two seconds lags behind.
    EXPECT_LT(std::abs(miss), 0.2) << i;
    square += miss * miss;
  }
  EXPECT_LT(std::sqrt(square / static_cast<double>(last - first)), 0.02);
}

TEST(Simulate, DeicingHeatIncreasesWithLessAirflow) {
  const std::string text = calm_flight + leg("speed-run", "low = 90\nhigh = 130\nrate = 0.5");
  const Simulated cold(text);
  const Simulated heated(text + "[[effect]]\nid = \"temp-deice-heat\"\nheat = 0.5\npower = -1\n");
  const auto a = cold("TTRR", "K"), b = heated("TTRR", "K"), p = cold("TRUE_PS", "hPa"),
             t = cold("TRUE_AT", "K"), m = cold("TRUE_MACH", "1");
  const auto [first, last] = cold.leg("speed-run");
  for (std::size_t i = first; i < last; ++i)
    EXPECT_NEAR(b[i] - a[i], 0.5 * 0.3 / (0.269589 * p[i] * m[i] / t[i]), 2e-4);
}

TEST(Simulate, DewPointErrorChangesAllHumidityVariables) {
  const std::string text = calm_flight + leg("level", "duration = 60");
  const Simulated right(text);
  const Simulated wrong(text + "[[effect]]\nid = \"humidity-error\"\ndew_point = -2.0\n");
  const auto d0 = right("DPXC", "K"), d1 = wrong("DPXC", "K"), e0 = right("EDPC", "hPa"),
             e1 = wrong("EDPC", "hPa");
  for (std::size_t i = 0; i < d0.size(); ++i) {
    EXPECT_NEAR(d1[i] - d0[i], -2.0, 5e-5);
    // Clausius and Clapeyron: d ln e/dT = L/(R_v T^2), L = 2.5e6 - 2370 (T - 273) J/kg, at the middle of the
    // step.
    const double middle = d0[i] - 1.0;
    const double latent = 2.5008e6 - 2370.0 * (middle - 273.15);
    EXPECT_NEAR(std::log(e1[i] / e0[i]), -2.0 * latent / (461.5 * middle * middle), 2e-3);
  }
}

TEST(Simulate, HiddenCauseIsInTheDefect) {
  const std::string text = quiet_flight + leg("level", "duration = 120");
  const Simulated without(text);
  const Simulated with(text +
                       "[[effect]]\nid = \"unknown\"\nof = \"ENGTRQ\"\nwhere = \"static\"\non = \"PSFD\"\n"
                       "strength = 2.0\ncentre = 50\nscale = 100\n");
  const auto d0 = without("TRUE_PCOR_PSFD", "hPa"), d1 = with("TRUE_PCOR_PSFD", "hPa"),
             torque = with("ENGTRQ", "percent");
  const auto [first, last] = with.leg("level");
  for (std::size_t i = first; i < last; ++i) {
    // The law is a function of measured quantities and changes by a few per cent of the extra defect.
    const double extra = 2.0 * (torque[i] - 50.0) / 100.0;
    EXPECT_NEAR(d1[i] - d0[i], extra, 0.05 * std::abs(extra) + 1e-5);
  }
  EXPECT_TRUE(same_bits(without.raw("PSFRD"), with.raw("PSFRD")));
}

TEST(Simulate, ClockSkewDelaysOneSensor) {
  const std::string text = quiet_flight + leg("speed-run", "low = 95\nhigh = 125");
  const Simulated on_time(text);
  const Simulated late(text + "[[effect]]\nid = \"clock-skew\"\non = \"VLAMS\"\nseconds = 2.0\n");
  const auto a = on_time("VLAMS", "m/s"), b = late("VLAMS", "m/s");
  for (std::size_t i = 2; i < a.size(); ++i) EXPECT_EQ(b[i], a[i - 2]);
  EXPECT_THAT(differences(on_time, late), testing::ElementsAre("VLAMS"));
}

TEST(Simulate, NoiseHasTheSizeStated) {
  const std::string text = noisy_flight + leg("level", "duration = 1200");
  const Simulated none_detected(text + "[noise]\nTTRR = 0\nGGALT = 0\n");
  const Simulated noisy(text + "[noise]\nTTRR = 0.3\nGGALT = { rms = 2.0, memory = 5.0, bias = 1.0 }\n");
  const std::vector<std::pair<std::string, double>> expected{{"TTRR", 0.3}, {"GGALT", 2.0}};
  for (const auto& [name, rms] : expected) {
    const auto a = none_detected.raw(name), b = noisy.raw(name);
    double sum = 0.0, square = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      sum += b[i] - a[i];
      square += std::pow(b[i] - a[i], 2.0);
    }
    const auto count = static_cast<double>(a.size());
    const double mean = sum / count;
    // Three standard errors of 1600 samples, of which a memory of 5 s leaves every tenth.
    EXPECT_NEAR(std::sqrt(square / count - mean * mean), rms, (name == "TTRR" ? 0.06 : 0.18) * rms) << name;
    EXPECT_NEAR(mean, name == "TTRR" ? 0.0 : 1.0, (name == "TTRR" ? 0.08 : 0.25) * rms) << name;
  }
}

TEST(Simulate, AddsGapsAndSpikes) {
  const std::string text = quiet_flight + leg("level", "duration = 600");
  const Simulated whole(text);
  const Simulated flight(text + R"(
[[gap]]
start = 100
duration = 10
[[gap]]
variable = "VLAMS"
start = 300
duration = 20
[[outliers]]
variable = "QCF"
fraction = 0.1
size = 5.0
)");
  EXPECT_EQ(flight.flight().records(), whole.flight().records() - 10);
  EXPECT_EQ(flight.flight().time().gap_count, 1U);
  const auto laser = flight("VLAMS", "m/s");
  EXPECT_EQ(std::count_if(laser.begin(), laser.end(), [](double x) { return std::isnan(x); }), 20);
  const auto a = whole("QCF", "hPa"), b = flight("QCF", "hPa");
  std::size_t spikes = 0;
  for (std::size_t i = 0; i < 100; ++i) spikes += a[i] != b[i] ? 1 : 0;
  EXPECT_GT(spikes, 1U);
  EXPECT_LT(spikes, 25U);  // 10 expected, five standard deviations
}

TEST(Simulate, TablesOfOutliersAreIndependent) {
  const std::string text = quiet_flight + leg("level", "duration = 600");
  const std::string table = "[[outliers]]\nvariable = \"QCF\"\nfraction = 0.1\nsize = 5.0\n";
  const auto none = Simulated(text).raw("QCF");
  const auto one = Simulated(text + table).raw("QCF");
  const auto two = Simulated(text + table + table).raw("QCF");
  double first = 0.0, second = 0.0, shared = 0.0;
  for (std::size_t i = 0; i < none.size(); ++i) {
    const bool is_first = one[i] != none[i];
    const bool is_second = two[i] != one[i];
    first += is_first ? 1.0 : 0.0;
    second += is_second ? 1.0 : 0.0;
    shared += is_first && is_second ? 1.0 : 0.0;
  }
  // Binomial numbers, within five standard deviations.
  const auto expect_binomial = [](double found, double samples, double fraction) {
    EXPECT_NEAR(found, samples * fraction, 5.0 * std::sqrt(samples * fraction * (1.0 - fraction)));
  };
  const auto samples = static_cast<double>(none.size());
  expect_binomial(first, samples, 0.1);
  expect_binomial(second, samples, 0.1);
  expect_binomial(shared, samples, 0.01);
}

TEST(Simulate, StallIsRefused) {
  const Scenario scenario =
      parse_scenario(noisy_flight + leg("climb", "altitude = 8000\nspeed = 76"), "test.toml");
  const test::TemporaryDirectory directory;
  EXPECT_THAT(test::error_of([&] { simulate_flight(scenario, directory / "out.nc"); }),
              test::IsError(Error::Code::definition, "test.toml"));
  EXPECT_EQ(directory.entries(), 0U);
}

// Every scenario of the project can be flown.

class DataScenario : public testing::TestWithParam<std::string> {};

TEST_P(DataScenario, IsSimulated) {
  const test::TemporaryDirectory directory;
  const Scenario scenario =
      read_scenario(std::filesystem::path(PCOR_SOURCE_DIR) / "data/scenarios" / GetParam());
  const SimulationSummary summary = simulate_flight(scenario, directory / "out.nc");
  EXPECT_EQ(summary.legs.back().kind, "ground");
  EXPECT_GT(summary.records, 600U);
  EXPECT_EQ(summary.name + ".toml", GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, DataScenario,
                         testing::Values("c130-eq18.toml", "c130-eq19.toml", "gv-eq20.toml",
                                         "c130-no-manoeuvres.toml", "c130-hidden.toml", "c130-short.toml"),
                         [](const auto& scenario) { return test::test_name(scenario.param); });

// The reader

struct Refusal {
  std::string text;
  std::vector<std::string> names;
};

void PrintTo(const Refusal& refusal, std::ostream* stream) { *stream << refusal.text; }

class ScenarioRefusal : public testing::TestWithParam<Refusal> {};

TEST_P(ScenarioRefusal, ErrorHasCodeAndNames) {
  const std::optional<Error> error = test::error_of([] { parse_scenario(GetParam().text, "test.toml"); });
  EXPECT_THAT(error, test::IsError(Error::Code::definition, "test.toml"));
  for (const std::string& name : GetParam().names)
    EXPECT_THAT(error, test::IsError(Error::Code::definition, name));
}

INSTANTIATE_TEST_SUITE_P(
    All, ScenarioRefusal,
    testing::Values(
        Refusal{"a = [", {"test.toml:1"}}, Refusal{"name = \"x\"", {"1:1", "format ="}},
        Refusal{"format = \"pcor-model/1\"", {"test.toml:1:10", "pcor-scenario/1"}},
        Refusal{head + "sead = 3\n", {"test.toml:7:1", "sead", "seed"}},
        Refusal{head + "rate = 10\n", {"rate = 10", "1, 5 or 25"}}, Refusal{head, {"[[system]]"}},
        Refusal{head + systems, {"[[leg]]"}},
        Refusal{head + "[atmosphere]\nlapse_rte = 6\n", {"lapse_rte", "lapse_rate", "[atmosphere]"}},
        Refusal{head + "[atmosphere]\nlapse_rate = 60\n", {"lapse_rate = 60 K/km", "-5 to 12"}},
        Refusal{head + "[[system]]\nstatic = \"PSFD\"\ndynamic = \"PSFD\"\n", {"static", "dynamic"}},
        Refusal{noisy_flight + "[[leg]]\nkind = \"levl\"\n", {"levl", "level"}},
        Refusal{noisy_flight + leg("level", "duration = -5"), {"duration = -5 s"}},
        Refusal{noisy_flight + leg("level", "speed = 300"), {"speed = 300 m/s", "75 to 155"}},
        Refusal{noisy_flight + leg("level", "speed = \"fast\""), {"'speed'"}},
        Refusal{noisy_flight + leg("level", "cycles = 3"), {"cycles", "level"}},
        Refusal{noisy_flight + leg("climb"), {"altitude"}},
        Refusal{head + systems + leg("level"), {"ground"}},
        Refusal{noisy_flight + leg("climb", "altitude = 1000"), {"descent"}},
        Refusal{noisy_flight + leg("turn", "angle = 0"), {"angle = 0 deg"}},
        Refusal{noisy_flight + "[[effect]]\nid = \"lams-cloud\"\nerror = -1\n", {"test.toml:21", "cloud"}},
        Refusal{noisy_flight + "[[gap]]\nstart = 5\n", {"duration"}},
        Refusal{noisy_flight + leg("speed-run", "low = 120\nhigh = 100"), {"low", "high"}},
        Refusal{noisy_flight + "[[effect]]\nid = \"static-lagg\"\n", {"static-lagg", "static-lag"}},
        Refusal{noisy_flight + "[[effect]]\nid = \"static-lag\"\n", {"tau"}},
        Refusal{noisy_flight + "[[effect]]\nid = \"static-lag\"\ntau = -1\n", {"tau = -1 s"}},
        Refusal{noisy_flight + "[[effect]]\nid = \"static-lag\"\ntua = 1\n", {"tua", "tau"}},
        Refusal{noisy_flight + "[[effect]]\nid = \"static-lag\"\ntau = 1\non = \"PSFX\"\n", {"PSFX", "PSFD"}},
        Refusal{noisy_flight + "[[effect]]\nid = \"clock-skew\"\nseconds = 1\n", {"variable"}},
        Refusal{noisy_flight +
                    "[[effect]]\nid = \"unknown\"\nstrength = 1\nof = \"ENGTRK\"\nwhere = \"static\"\n",
                {"ENGTRK", "ENGTRQ"}},
        Refusal{noisy_flight + "[noise]\nQFC = 0.1\n", {"QFC", "QCF"}},
        // The first of two errors.
        Refusal{"\nformat = \"pcor-scenario/1\"\nnmae = \"x\"\n", {"test.toml:3:1", "nmae"}},
        Refusal{"\nformat = \"pcor-scenario/1\"\naircraft = \"GV\"\nsystem = 3\n",
                {"test.toml:1:1", "name ="}},
        Refusal{"\nformat = \"pcor-scenario/1\"\nname = \"\"\naircraft = \"GV\"\n",
                {"test.toml:1:1", "name ="}},
        Refusal{"\nformat = \"pcor-scenario/1\"\nname = \"x\"\nsystem = 3\n",
                {"test.toml:1:1", "aircraft ="}},
        Refusal{head + "[noise]\nQFC = 0.1\n", {"test.toml:1:1", "[[system]]"}},
        Refusal{head + "system = []\nleg = []\n", {"test.toml:1:1", "[[system]]"}},
        Refusal{head + systems + "[[effect]]\nid = \"static-lagg\"\n", {"test.toml:1:1", "[[leg]]"}}),
    // The last lines, which describe the case.
    [](const auto& refusal) {
      const std::string& text = refusal.param.text;
      const std::size_t line = text.rfind('\n', text.size() - 2);
      const std::size_t before = text.rfind('\n', line - 1);
      return std::to_string(refusal.index) + "_" + test::test_name(text.substr(before + 1));
    });

TEST(Scenario, RefusesAnAbsentFile) {
  EXPECT_THAT(test::error_of([] { read_scenario("/nowhere/flight.toml"); }),
              test::IsError(Error::Code::file, "/nowhere/flight.toml"));
}

}  // namespace
}  // namespace pcor
