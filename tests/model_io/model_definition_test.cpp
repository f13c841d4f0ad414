#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/physics/lams.hpp>
#include <pcor/physics/recovery_factor.hpp>
#include "model_io/minimum_model.hpp"
#include "model_io/output_table.hpp"
#include "support/error_of.hpp"
#include "support/temporary_directory.hpp"

namespace {

namespace fs = std::filesystem;
using namespace pcor;
using test::error_of;
using test::IsError;
using test::minimum_model;
using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// The example of the interface, word for word.
const std::string published_example = R"(format = "pcor-model/1"
name = "C-130 PSFD/QCF"
aircraft = "C-130 N130AR"

[variables]                                # role = netCDF variable; the first two are required
static_pressure = "PSFD"
dynamic_pressure = "QCF"
recovery_temperature = "RTF1"              # or ambient_temperature = "ATX"
vapor_pressure = "EWX"                     # or dew_point = "DPXC"
radome_dynamic_pressure = "QCR"
attack_differential_pressure = "ADIFR"
sideslip_differential_pressure = "BDIFR"
attack = "ATTACK"
sideslip = "SSLIP"
lams_airspeed = "VLAMS"                    # along the beam
altitude = "GGALT"
vertical_speed = "GGVSPD"
roll = "ROLL"
flaps = "FLAPS"                            # a role that is absent is not used

[lams]
elevation = 1.5                            # theta_1, deg above the longitudinal axis
azimuth = -0.8                             # theta_2, deg to starboard

[temperature]
recovery_factor = 0.975                    # a number, or the name of a published law

[humidity]
moist = true

[[effect]]
id = "static-constant"                     # delta-p/p = a0
parameters = { a0 = 0.0042 }

[[effect]]
id = "static-qp"                           # delta-p/p = a2 q_m/p_m
parameters = { a2 = 0.0308 }
fixed = ["a2"]                             # optional: not refitted
)";

const std::string published_formula = R"(
[[effect]]
id = "my-thrust"
where = "static"                           # the stage it acts on
formula = "k * ENGTRQ / 100"               # added to delta-p, hPa; variables by netCDF name or by role
parameters = { k = 0.0 }
unit = "hPa"
source = "engine run-up, 2011-11-02"
)";

ModelDefinition parsed(std::string_view text) { return parse_model(text, "m.toml"); }

std::optional<Error> parse_error_of(std::string_view text) {
  return error_of([&] { parsed(text); });
}

std::optional<Error> write_error_of(const ModelDefinition& file) {
  return error_of([&] { write_model(file); });
}

// Every bit of a model file as text, to compare two of them.
class Description {
 public:
  static std::string of(const ModelDefinition& file) {
    Description description;
    description.add(file);
    return description.text_.str();
  }

 private:
  Description() { text_ << std::hexfloat; }

  template <class... T>
  void values(const T&... items) {
    (value(items), ...);
  }

  template <class T>
  void value(const T& item) {
    text_ << item << '|';
  }

  template <class T>
  void value(const std::vector<T>& items) {
    for (const T& item : items) value(item);
    text_ << ';';
  }

  template <class Key, class T>
  void value(const std::pair<Key, T>& item) {
    values(item.first, item.second);
  }

  template <class Key, class T>
  void value(const std::map<Key, T>& items) {
    for (const auto& item : items) value(item);
    text_ << ';';
  }

  void value(Quantity quantity) { value(info_of(quantity).name); }

  void value(const std::optional<double>& item) {
    if (item) value(*item);
    text_ << ';';
  }

  void value(const ProvenanceValue& item) {
    text_ << item.index() << ':';
    std::visit([this](const auto& each) { value(each); }, item);
    text_ << '\n';
  }

  void value(const RadomeCalibration& radome) { values(radome.offset, radome.slope, radome.slope_mach); }

  void value(const DomainRange& range) { values(range.quantity, range.lower, range.upper); }

  void add(const ModelDefinition& file) {
    const Model& model = file.model;
    values(model.name, model.aircraft);
    for (std::size_t i = 0; i < model.effects.size(); ++i) add_effect(file, i);
    values(model.lams.elevation, model.lams.azimuth, static_cast<int>(model.lams.approach));
    for (const double coefficient : model.recovery.coefficients) value(coefficient);
    const Policy& policy = model.policy;
    values(model.moist, model.attack_radome, model.sideslip_radome, policy.taper_below, policy.taper_power,
           policy.minimum, policy.min_dynamic_pressure, model.domain);
    values(file.variables, file.units, file.output, file.recovery_factor_name, file.law.source,
           file.law.valid_from, file.law.valid_to, file.law.rms_hpa, file.law.note,
           file.covariance.parameters, file.covariance.matrix, file.uncertainty.roles,
           file.uncertainty.static_defect, file.uncertainty.static_defect_ratio, file.provenance);
  }

  void add_effect(const ModelDefinition& file, std::size_t number) {
    const ModelEffect& effect = file.model.effects[number];
    values(effect.id, effect.formula, static_cast<int>(effect.location), effect.scaling.static_pressure,
           effect.scaling.dynamic_pressure, effect.unit, effect.source, effect.parameter_names);
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
      const ParameterFit fit = file.fit(number, i);
      values(effect.parameters[i], fit.fixed, fit.standard_error);
      if (fit.bounds) values(fit.bounds->lower, fit.bounds->upper);
      text_ << '\n';
    }
  }

  std::ostringstream text_;
};

// Models of every kind that a file can hold, one for each seed.
class ModelGenerator {
 public:
  explicit ModelGenerator(std::uint64_t seed) : random_(seed) {}

  ModelDefinition model() {
    ModelDefinition file;
    file.model.name = words();
    file.model.aircraft = words();
    variables(file);
    instrument(file);
    for (const EffectInfo& info : effect_info) {
      if (maybe()) add_effect(file, neutral_effect(info.id));
    }
    for (std::size_t i = below(3); i > 0; --i) add_effect(file, formula(i));
    std::shuffle(file.model.effects.begin(), file.model.effects.end(), random_);
    for (const ModelEffect& effect : file.model.effects) file.fits.push_back(fit(effect));
    if (maybe()) file.law = {words(), "2011-11-02", "2012-02-29", maybe(), positive(), words()};
    if (maybe()) covariance(file);
    if (maybe()) uncertainty(file);
    file.provenance = provenance(3);
    return file;
  }

 private:
  std::size_t below(std::size_t end) { return random_() % end; }
  bool maybe() { return below(2) == 0; }

  // Any finite double, subnormal and negative zero included.
  double number() {
    if (below(4) == 0) return maybe() ? -0.0 : static_cast<double>(below(1000));
    double value = std::numeric_limits<double>::quiet_NaN();
    while (!std::isfinite(value)) {
      const std::uint64_t bits = random_();
      static_assert(sizeof(bits) == sizeof(value));
      std::memcpy(&value, &bits, sizeof(value));
    }
    return value;
  }

  double positive() { return std::abs(number()); }

  Bounds range() {
    const double a = number(), b = number();
    return a == b ? Bounds{-1.0, 1.0} : Bounds{std::min(a, b), std::max(a, b)};
  }

  std::string words() {
    static const std::vector<std::string> pieces{
        "a", " ",    "\"",   "\\", "\n",     "\t", "\r", "'",  "''' \"\"\"", "#", "=", "[",
        "]", "\x01", "\x7f", "é",  "\u2028", "😀",  "\b", "\f", "{",          "}", ".", "\\u0041"};
    std::string text;
    for (std::size_t i = below(8); i > 0; --i) text += pieces[below(pieces.size())];
    return text;
  }

  void variables(ModelDefinition& file) {
    file.variables = {{Quantity::static_pressure, "PSFD"}, {Quantity::dynamic_pressure, "QC \"F\" é"}};
    for (std::size_t i = 2; i < role_count; ++i) {
      const auto role = static_cast<Quantity>(i);
      if (!maybe() || (is_humidity(role) && has_humidity(file))) continue;
      file.variables[role] = "V" + std::to_string(i);
      if (maybe()) file.units[role] = info_of(role).unit;
    }
    for (const std::string& name : internal::output_names()) {
      if (maybe()) file.output[name] = "my " + name;
    }
  }

  static bool is_humidity(Quantity role) {
    return role == Quantity::vapor_pressure || role == Quantity::dew_point || role == Quantity::frost_point;
  }

  static bool has_humidity(const ModelDefinition& file) {
    return std::any_of(file.variables.begin(), file.variables.end(),
                       [](const auto& variable) { return is_humidity(variable.first); });
  }

  void instrument(ModelDefinition& file) {
    Model& model = file.model;
    if (maybe()) model.lams = {number(), number(), static_cast<LamsApproach>(1 + below(3))};
    if (file.variables.count(Quantity::recovery_temperature) != 0 &&
        file.variables.count(Quantity::ambient_temperature) != 0) {
      model.lams.approach = LamsApproach::with_temperature;
    }
    switch (below(4)) {
      case 0: {
        const PublishedRecoveryFactor& law =
            published_recovery_factors[below(published_recovery_factors.size())];
        model.recovery = law.law;
        file.recovery_factor_name = law.name;
        break;
      }
      case 1:
        model.recovery.coefficients = {0.1 + 0.001 * static_cast<double>(below(1000)), number(), number(),
                                       number()};
        break;
      case 2:
        model.recovery.coefficients = {0.975, 0.0, 0.0, 0.0};
        break;
      default:
        break;
    }
    model.moist = maybe();
    if (maybe()) model.attack_radome = {number(), number(), number()};
    if (maybe()) model.sideslip_radome = {number(), number(), 0.0};
    if (maybe()) model.policy = {positive(), positive(), number()};
    if (maybe()) model.policy.taper_below = positive();
    for (const std::string_view quantity : {"mach", "dynamic_ratio", "altitude"}) {
      const Bounds ends = range();
      if (maybe()) model.domain.push_back({std::string(quantity), ends.lower, ends.upper});
    }
  }

  ModelEffect formula(std::size_t which) {
    ModelEffect effect;
    effect.id = "own \"" + std::to_string(which) + "\"." + words();
    effect.location = static_cast<EffectLocation>(below(location_count));
    effect.formula = "z*VAR1 +\t b/2 + a";
    effect.parameter_names = {"z", "b", "a"};
    effect.parameters = {0.0, 0.0, 0.0};
    if (maybe()) effect.unit = info_of(effect.location).unit;
    if (maybe()) effect.source = words();
    return effect;
  }

  int power() { return maybe() ? 0 : static_cast<int>(below(7)) - max_power; }

  double between(double lower, double upper) {
    const double value = maybe() ? number() : std::uniform_real_distribution<>(lower, upper)(random_);
    return std::clamp(value, lower, upper);
  }

  void add_effect(ModelDefinition& file, ModelEffect effect) {
    if (!effect.is_formula()) effect.scaling = {power(), power()};
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
      if (maybe()) continue;
      if (effect.is_formula()) {
        effect.parameters[i] = number();
      } else {
        const ParameterInfo& info = effect_named(effect.id)->parameters[i];
        effect.parameters[i] = between(info.lower, info.upper);
      }
    }
    file.model.effects.push_back(std::move(effect));
  }

  EffectFit fit(const ModelEffect& effect) {
    EffectFit fit(effect.parameters.size());
    for (std::size_t i = 0; i < fit.size(); ++i) {
      fit[i].fixed = maybe();
      if (maybe()) fit[i].standard_error = positive();
      const Bounds bounds = effect.is_formula() ? range() : range_within(effect, i);
      const double value = effect.parameters[i];
      if (value >= bounds.lower && value <= bounds.upper) fit[i].bounds = bounds;
    }
    return fit;
  }

  Bounds range_within(const ModelEffect& effect, std::size_t number) {
    const ParameterInfo& info = effect_named(effect.id)->parameters[number];
    const double a = between(info.lower, info.upper), b = between(info.lower, info.upper);
    return a == b ? Bounds{info.lower, info.upper} : Bounds{std::min(a, b), std::max(a, b)};
  }

  void covariance(ModelDefinition& file) {
    std::vector<std::string>& names = file.covariance.parameters;
    std::vector<double> errors;
    for (std::size_t e = 0; e < file.model.effects.size(); ++e) {
      const ModelEffect& effect = file.model.effects[e];
      const std::vector<std::string> parameters = parameter_names(effect);
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        const double error = file.fit(e, i).standard_error.value_or(1.0);
        if (!maybe() || error < 1e-100 || error > 1e100) continue;  // its square has to be a number
        names.push_back(effect.id + "." + parameters[i]);
        errors.push_back(error);
      }
    }
    const double correlation = 0.01 * static_cast<double>(below(101));
    std::vector<std::vector<double>>& matrix = file.covariance.matrix;
    matrix.assign(names.size(), std::vector<double>(names.size()));
    for (std::size_t i = 0; i < names.size(); ++i) {
      for (std::size_t j = 0; j < names.size(); ++j)
        matrix[i][j] = errors[i] * errors[j] * (i == j ? 1.0 : correlation);
    }
  }

  void uncertainty(ModelDefinition& file) {
    for (const auto& [role, variable] : file.variables) {
      if (maybe()) file.uncertainty.roles[role] = positive();
    }
    if (maybe()) file.uncertainty.static_defect = positive();
    if (maybe()) file.uncertainty.static_defect_ratio = positive();
  }

  Provenance provenance(std::size_t depth) {
    Provenance table;
    for (std::size_t i = below(6); i > 0; --i) {
      table.emplace_back(words() + std::to_string(i), provenance_value(depth));
    }
    return table;
  }

  ProvenanceValue provenance_value(std::size_t depth) {
    switch (below(depth == 0 ? 4 : 6)) {
      case 0:
        return number();
      case 1:
        return static_cast<std::int64_t>(random_());
      case 2:
        return maybe();
      case 3:
        return words();
      case 4: {
        ProvenanceList list;
        for (std::size_t i = below(9); i > 0; --i) list.push_back(provenance_value(depth - 1));
        return list;
      }
      default:
        return provenance(depth - 1);
    }
  }

  std::mt19937_64 random_;
};

class ModelFileOnDisk : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name, std::ios::binary) << text;
    return directory_ / name;
  }

  static std::string content(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }

  static std::optional<Error> read_error_of(const fs::path& path) {
    return error_of([&] { read_model(path); });
  }

  test::TemporaryDirectory directory_;
};

TEST(ModelDefinition, VariablesMayComeFromTheAircraftRoles) {
  const ModelDefinition file = parse_model("format = \"pcor-model/1\"\nroles = \"faam-core\"\n", "open.toml");
  EXPECT_TRUE(file.variables.empty());
  EXPECT_EQ(file.roles_from, "faam-core");
  EXPECT_EQ(parse_model(write_model(file), "again.toml").roles_from, "faam-core");
}

TEST(ModelDefinition, ReadsThePublishedExample) {
  const ModelDefinition file = parsed(published_example);
  EXPECT_EQ(file.model.name, "C-130 PSFD/QCF");
  EXPECT_EQ(file.model.aircraft, "C-130 N130AR");
  EXPECT_EQ(file.variables.size(), 14u);
  EXPECT_EQ(file.variables.at(Quantity::static_pressure), "PSFD");
  EXPECT_EQ(file.variables.at(Quantity::flaps), "FLAPS");
  EXPECT_EQ(file.roles().front(), Quantity::static_pressure);
  EXPECT_EQ(file.model.lams.elevation, 1.5);
  EXPECT_EQ(file.model.lams.azimuth, -0.8);
  EXPECT_EQ(file.model.lams.approach, LamsApproach::simultaneous);
  EXPECT_THAT(file.model.recovery.coefficients, ElementsAre(0.975, 0.0, 0.0, 0.0));
  EXPECT_THAT(file.recovery_factor_name, IsEmpty());
  EXPECT_TRUE(file.model.moist);
  ASSERT_EQ(file.model.effects.size(), 2u);
  EXPECT_EQ(file.model.effects[0].id, "static-constant");
  EXPECT_THAT(file.model.effects[0].parameters, ElementsAre(0.0042));
  EXPECT_EQ(file.model.effects[1].id, "static-qp");
  EXPECT_THAT(file.model.effects[1].parameters, ElementsAre(0.0308));
  EXPECT_FALSE(file.fit(0, 0).fixed);
  EXPECT_TRUE(file.fit(1, 0).fixed);
}

TEST(ModelDefinition, ReadsThePublishedFormulaEffect) {
  const ModelDefinition file = parsed(published_example + published_formula);
  ASSERT_EQ(file.model.effects.size(), 3u);
  const ModelEffect& effect = file.model.effects[2];
  EXPECT_TRUE(effect.is_formula());
  EXPECT_EQ(effect.id, "my-thrust");
  EXPECT_EQ(effect.location, EffectLocation::static_defect);
  EXPECT_EQ(effect.formula, "k * ENGTRQ / 100");
  EXPECT_EQ(effect.unit, "hPa");
  EXPECT_EQ(effect.source, "engine run-up, 2011-11-02");
  EXPECT_THAT(effect.parameter_names, ElementsAre("k"));
  EXPECT_THAT(effect.parameters, ElementsAre(0.0));
}

TEST(ModelDefinition, IsWrittenInTheLayoutOfTheExample) {
  EXPECT_EQ(write_model(parsed(minimum_model + published_formula)), R"(format = "pcor-model/1"

[variables]
static_pressure = "PSFD"
dynamic_pressure = "QCF"

[[effect]]
id = "my-thrust"
where = "static"
formula = "k * ENGTRQ / 100"
parameters = { k = 0.0 }
unit = "hPa"
source = "engine run-up, 2011-11-02"
)");
}

TEST(ModelDefinition, ReadsEveryTable) {
  const ModelDefinition file = parsed(minimum_model + R"(dew_point = "DPXC"
flaps = "FLAPS"
[units]
static_pressure = "mbar"
unit.dew_point = "C"
unit.flaps = "percent"
[output]
PCOR = "PCORD"
[lams]
approach = 3
[temperature]
recovery_factor = "harco-heated-2014"
[humidity]
moist = false
[radome]
attack = [5.516, 19.07, 2.08]
sideslip = [0, 21]
[policy]
taper_below = 20
taper_power = 2.5
minimum = -3.5
least_dynamic_pressure = 4.5
[domain]
mach = [0.1, 0.8]
altitude = [0, 15000]
[[effect]]
id = "static-constant"
stderr = { a0 = 1e-4 }
bounds = { a0 = [-0.01, 0.01] }
[law]
source = "memo"
valid_from = 2011-11-02
valid_to = "2014-12-31"
rms_hpa = 0.2
note = "clean"
[covariance]
parameters = ["static-constant.a0"]
matrix = [[1e-8]]
[provenance]
zebra = "first"
flights = ["rf01.nc", "rf02.nc"]
date = 2014-01-02T03:04:05Z
apple = { used = 12, share = 0.5, clean = true }
)");
  EXPECT_EQ(file.units.at(Quantity::static_pressure), "mbar");
  EXPECT_EQ(file.units.at(Quantity::dew_point), "C");
  EXPECT_EQ(file.units.at(Quantity::flaps), "percent");
  EXPECT_EQ(file.output_name("PCOR"), "PCORD");
  EXPECT_EQ(file.output_name("ATX"), "ATX");
  EXPECT_EQ(file.model.lams.approach, LamsApproach::with_temperature);
  EXPECT_EQ(file.recovery_factor_name, "harco-heated-2014");
  EXPECT_THAT(file.model.recovery.coefficients, ElementsAre(0.988, 0.053, 0.090, 0.091));
  EXPECT_FALSE(file.model.moist);
  EXPECT_EQ(file.model.attack_radome.slope_mach, 2.08);
  EXPECT_EQ(file.model.sideslip_radome.slope, 21.0);
  EXPECT_EQ(file.model.policy.taper_below, 20.0);
  EXPECT_EQ(file.model.policy.taper_power, 2.5);
  EXPECT_EQ(file.model.policy.minimum, -3.5);
  EXPECT_EQ(file.model.policy.min_dynamic_pressure, 4.5);
  ASSERT_EQ(file.model.domain.size(), 2u);
  EXPECT_EQ(file.model.domain[0].quantity, "mach");
  EXPECT_EQ(file.model.domain[1].upper, 15000.0);
  EXPECT_THAT(file.model.effects[0].parameters, ElementsAre(0.0));
  EXPECT_EQ(file.fit(0, 0).standard_error, 1e-4);
  EXPECT_EQ(file.bounds(0, 0).upper, 0.01);
  EXPECT_EQ(file.law.valid_from, "2011-11-02");
  EXPECT_EQ(file.law.valid_to, "2014-12-31");
  EXPECT_EQ(file.law.rms_hpa, 0.2);
  EXPECT_THAT(file.covariance.parameters, ElementsAre("static-constant.a0"));
  EXPECT_EQ(file.covariance.matrix, std::vector<std::vector<double>>{{1e-8}});
  ASSERT_EQ(file.provenance.size(), 4u);
  EXPECT_EQ(file.provenance[0].first, "zebra");
  EXPECT_EQ(file.provenance[3].first, "apple");
  EXPECT_EQ(std::get<std::string>(file.provenance[2].second), "2014-01-02T03:04:05Z");
  EXPECT_EQ(std::get<std::int64_t>(std::get<Provenance>(file.provenance[3].second)[0].second), 12);

  const std::string written = write_model(file);
  EXPECT_EQ(Description::of(parsed(written)), Description::of(file)) << written;
}

// Uncertainties of fitted parameters, of parameters that are only considered, and of samples.
TEST(ModelDefinition, ReadsAllUncertainties) {
  const ModelDefinition file = parsed(minimum_model + R"([[effect]]
id = "static-constant"
parameters = { a0 = 0.004 }
stderr = { a0 = 1e-4 }
[[effect]]
id = "psfd-bias"
stderr = { offset = 0.1 }
fixed = ["offset"]
[[effect]]
id = "static-qp"
stderr = { a2 = 2e-3 }
[covariance]
parameters = ["static-qp.a2", "static-constant.a0"]
matrix = [[4e-6, -1e-7], [-1e-7, 1e-8]]
[uncertainty]
dynamic_pressure = 0.03
static_defect_ratio = 0.00045
)");
  const ModelUncertainty uncertainty = uncertainty_of(file);
  EXPECT_THAT(uncertainty.covariance, ElementsAre(1e-8, 0.0, -1e-7,                   //
                                                  0.0, testing::DoubleEq(0.01), 0.0,  //
                                                  -1e-7, 0.0, 4e-6));
  EXPECT_EQ(uncertainty.random[index(Quantity::dynamic_pressure)], 0.03);
  EXPECT_EQ(uncertainty.random[index(Quantity::static_pressure)], 0.0);
  EXPECT_EQ(uncertainty.static_defect_ratio, 0.00045);
  EXPECT_FALSE(uncertainty_of(parsed(minimum_model)).has_systematic());
}

TEST(ModelDefinition, UncertaintyIsNamedAfterItsResult) {
  const ModelDefinition file =
      parsed(minimum_model + "[output]\nPSXC = \"PSFDC\"\nQCXC = \"QCFC\"\nQCXC_uncertainty = \"U\"\n");
  EXPECT_EQ(file.output_name("PSXC_uncertainty"), "PSFDC_uncertainty");
  EXPECT_EQ(file.output_name("QCXC_uncertainty"), "U");
  EXPECT_EQ(file.output_name("ATX_uncertainty"), "ATX_uncertainty");
}

TEST(ModelDefinition, DefaultBoundsAreThoseOfTheCatalogue) {
  const ModelDefinition file = parsed(minimum_model + "[[effect]]\nid = \"recovery-factor\"\n");
  EXPECT_EQ(file.bounds(0, 0).lower, -0.2);
  EXPECT_EQ(file.bounds(0, 0).upper, 0.2);
}

// A surface is not in the catalogue: its location was read through a null pointer.
TEST(ModelDefinition, EveryKindOfEffectHasALocation) {
  const ModelEffect surface = surface_effect(
      "static-surface",
      {SurfaceAxis{Quantity::mach, 0.2, 0.6, 4}, SurfaceAxis{Quantity::attack_ratio, -0.3, 0.1, 4}});
  EXPECT_EQ(location_of(surface), EffectLocation::static_defect);
  EXPECT_EQ(location_of(neutral_effect("qcf-gain")), EffectLocation::dynamic_transducer);
  ModelEffect formula;
  formula.id = "mine";
  formula.formula = "k * altitude";
  formula.location = EffectLocation::pitot;
  EXPECT_EQ(location_of(formula), EffectLocation::pitot);
}

// Any shape of an effect without size is neutral.
TEST(ModelDefinition, AnEffectIsNeutralIfItChangesNothing) {
  ModelEffect step = neutral_effect("aircraft-step");
  step.parameters[1] = 4000.0;  // since
  EXPECT_TRUE(is_neutral(step));
  step.parameters[0] = 0.1;
  EXPECT_FALSE(is_neutral(step));
  ModelEffect surface = surface_effect(
      "static-surface", {{{Quantity::attack_ratio, -0.1, 0.3, 5}, {Quantity::mach, 0.2, 0.5, 4}}});
  EXPECT_TRUE(is_neutral(surface));
  surface.parameters[3] = 0.001;
  EXPECT_FALSE(is_neutral(surface));
}

TEST(ModelDefinition, ThirdLamsApproachReadsBothTemperatures) {
  const std::string both = "recovery_temperature = \"RTF1\"\nambient_temperature = \"MTP\"\n";
  const ModelDefinition file = parsed(minimum_model + both + "[lams]\napproach = 3\n");
  EXPECT_EQ(file.variables.count(Quantity::recovery_temperature), 1u);
  EXPECT_EQ(file.variables.count(Quantity::ambient_temperature), 1u);
}

TEST(ModelDefinition, WindowsLineEndsAreAccepted) {
  std::string text = published_example + published_formula;
  for (std::size_t i = text.find('\n'); i != std::string::npos; i = text.find('\n', i + 2)) {
    text.insert(i, "\r");
  }
  EXPECT_EQ(Description::of(parsed("\xef\xbb\xbf" + text)),
            Description::of(parsed(published_example + published_formula)));
}

TEST(ModelDefinition, WriteAndReadRestoreEveryBit) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const ModelDefinition file = ModelGenerator(seed).model();
    const std::string text = write_model(file);
    const ModelDefinition restored = parsed(text);
    ASSERT_EQ(Description::of(restored), Description::of(file)) << "seed " << seed << "\n" << text;
    ASSERT_EQ(write_model(restored), text) << "seed " << seed;
  }
}

TEST(ModelDefinition, FormulaVariableOfARoleIsThatRole) {
  const auto formula = [](const std::string& text, const std::string& parameters = "k = 1") {
    return parsed(minimum_model +
                  "ground_speed = \"E5\"\nrecovery_temperature = \"T\"\nroll = \"pitch\"\n[[effect]]\n" +
                  "id = \"own\"\nformula = \"" + text + "\"\nparameters = { " + parameters + " }\n")
        .model.effects[0]
        .formula;
  };
  EXPECT_EQ(formula("T*k-T^2+TT/T2"), "recovery_temperature*k-recovery_temperature^2+TT/T2");
  EXPECT_EQ(formula("k * min(PSFD, 1.E5)"), "k * min(static_pressure, 1.E5)");
  EXPECT_EQ(formula("k*1.E5*E5 - 2E5"), "k*1.E5*ground_speed - 2E5")
      << "E5 is a variable and part of a number";
  EXPECT_EQ(formula("T * QCF", "T = 1"), "T * dynamic_pressure") << "T is a parameter";
  EXPECT_EQ(formula("k * pitch"), "k * pitch") << "the name of a quantity comes first";
  EXPECT_THAT(
      error_of([&] { formula("roll * T * recovery_temperature", "roll = 1, recovery_temperature = 1"); }),
      IsError(Error::Code::definition, "recovery_temperature", "T"));
}

TEST(ModelDefinition, SensorNoiseNeedsNoVariableWithoutPressures) {
  const std::string start = "format = \"pcor-model/1\"\n";
  for (const std::string section : {"[units]\nattack = \"deg\"\n", "[uncertainty]\nattack = 0.1\n"}) {
    EXPECT_EQ(parse_error_of(start + section), std::nullopt) << section;
    EXPECT_THAT(parse_error_of(minimum_model + section), IsError(Error::Code::definition, "attack"))
        << section;
  }
  EXPECT_EQ(parsed(start + "[uncertainty]\nattack = 0.1\n").uncertainty.roles.at(Quantity::attack), 0.1);
}

TEST(ModelDefinition, MinimumDynamicPressureHasTwoNames) {
  const std::string alias = "[policy]\nmin_dynamic_pressure = 4.5\n";
  EXPECT_EQ(parsed(minimum_model + alias).model.policy.min_dynamic_pressure, 4.5);
  EXPECT_THAT(parse_error_of(minimum_model + alias + "least_dynamic_pressure = 5\n"),
              IsError(Error::Code::definition, "min_dynamic_pressure", "least_dynamic_pressure"));
}

TEST(ModelDefinition, ArbitraryTextGivesAnErrorOnly) {
  std::mt19937_64 random(1);
  const std::string letters = "[]{}=\"'.,#\n\\ \t\r0-+_:eEnaifxu\x80\xff\x01" + std::string(1, '\0');
  const auto below = [&](std::size_t end) { return static_cast<std::size_t>(random() % end); };
  for (int trial = 0; trial < 1500; ++trial) {
    std::string text = trial % 2 == 0 ? published_example + published_formula
                                      : write_model(ModelGenerator(random() % 100).model());
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
      const std::size_t position = below(text.size());
      switch (below(4)) {
        case 0:
          text[position] = letters[below(letters.size())];
          break;
        case 1:
          text.insert(position, 1, letters[below(letters.size())]);
          break;
        case 2:
          text.erase(position, 1 + below(30));
          break;
        default:
          text.insert(below(text.size()), text.substr(position, below(60)));
      }
    }
    EXPECT_THAT(parse_error_of(text),
                AnyOf(testing::Eq(std::nullopt), IsError(Error::Code::definition, "m.toml")))
        << text;
  }
}

TEST(ModelDefinition, DeepNestingIsRefused) {
  EXPECT_THAT(parse_error_of("a = " + std::string(100000, '[')),
              IsError(Error::Code::definition, "m.toml:1"));
  EXPECT_THAT(parse_error_of(std::string(100000, '{')), IsError(Error::Code::definition, "m.toml:1"));
}

struct BadInput {
  std::string name;
  std::string text;  // added to the least model; the whole file where it begins with "format" or "\n"
  std::string position;
  std::vector<std::string> names;
};

void PrintTo(const BadInput& input, std::ostream* stream) { *stream << input.text; }

class BadInputTest : public testing::TestWithParam<BadInput> {};

TEST_P(BadInputTest, ErrorStatesPositionAndNames) {
  const BadInput& input = GetParam();
  const bool whole = input.text[0] == '\n' || input.text.rfind("format", 0) == 0;
  const std::optional<Error> error = parse_error_of(whole ? input.text : minimum_model + input.text);
  EXPECT_THAT(error, IsError(Error::Code::definition, "m.toml:" + input.position));
  for (const std::string& name : input.names) EXPECT_THAT(error, IsError(Error::Code::definition, name));
}

const std::string user_formula = "[[effect]]\nid = \"own\"\nformula = \"k * mach\"\nparameters = { k = 1 }\n";
const std::string constant = "[[effect]]\nid = \"static-constant\"\n";

INSTANTIATE_TEST_SUITE_P(
    ModelDefinition, BadInputTest,
    testing::Values(
        BadInput{"NoFormat", "\nname = \"x\"\n", "1:1", {"pcor-model/1"}},
        BadInput{
            "NewerFormat", "format = \"pcor-model/2\"\nnew = 1\n", "1:10", {"pcor-model/2", "pcor-model/1"}},
        BadInput{"OtherFormat", "format = \"yaml\"\n", "1:10", {"yaml", "pcor-model/1"}},
        BadInput{"FormatOfWrongType", "format = 1\n", "1:10", {"format"}},
        BadInput{"Syntax", "[lams\n", "5:6", {}}, BadInput{"SyntaxThatOnceAborted", "[ = \"x", "5:3", {}},
        BadInput{"UnclosedText", "\nformat = \"pcor", "2:15", {}},
        BadInput{"KeyTwice", "dynamic_pressure = \"QCR\"\n", "5:20", {"dynamic_pressure"}},
        BadInput{"UnknownTable", "[lamps]\n", "5:2", {"lamps", "lams"}},
        BadInput{"UnknownTopKey", "\nformat = \"pcor-model/1\"\nnmae = \"x\"", "3:1", {"nmae", "name"}},
        BadInput{"TableThatIsNone", "[temperature]\n[lams]\n[variables.units]\n", "7:12", {"units"}},
        BadInput{"UnknownTableBeforeBadValue", "[lams]\nelevation = nan\n[lamps]\n", "7:2", {"lamps"}},
        BadInput{"VariablesBeforeUnits",
                 "format = \"pcor-model/1\"\n[units]\nflaps = \"percent\"\n[variables]\n"
                 "static_pressure = \"PSFD\"\n",
                 "4:2",
                 {"dynamic_pressure"}},
        BadInput{"EffectsBeforeCovariance",
                 "[covariance]\nparameters = [\"static-constant.a0\"]\nmatrix = [[1, 2]]\n"
                 "[[effect]]\nid = \"static-constnt\"\n",
                 "9:6",
                 {"static-constnt"}},
        BadInput{"NoDynamicPressure",
                 "format = \"pcor-model/1\"\n[variables]\nstatic_pressure = \"PSFD\"\n",
                 "2:2",
                 {"dynamic_pressure"}},
        BadInput{"OneVariableForBothPressures",
                 "\nformat = \"pcor-model/1\"\n[variables]\ndynamic_pressure = \"PSFD\"\n"
                 "static_pressure = \"PSFD\"\n",
                 "5:1",
                 {"static_pressure", "dynamic_pressure", "PSFD"}},
        BadInput{"ImpossibleElevation",
                 "[[effect]]\nid = \"lams-elevation\"\nparameters = { dtheta1 = 60 }\n",
                 "7:26",
                 {"dtheta1", "60", "[-45, 45]", "deg"}},
        BadInput{"VapourPressureAndDewPoint",
                 "vapor_pressure = \"EWX\"\ndew_point = \"DPXC\"\n",
                 "6:1",
                 {"vapor_pressure", "dew_point"}},
        BadInput{"FrostPointAndVapourPressure",
                 "frost_point = \"DPT\"\nvapor_pressure = \"EWX\"\n",
                 "6:1",
                 {"frost_point", "vapor_pressure"}},
        BadInput{"DewPointAndFrostPoint",
                 "dew_point = \"DPXC\"\nfrost_point = \"DPT\"\n",
                 "6:1",
                 {"dew_point", "frost_point"}},
        BadInput{"BothTemperatures",
                 "recovery_temperature = \"RTF1\"\nambient_temperature = \"ATX\"\n[lams]\napproach = 2\n",
                 "6:1",
                 {"recovery_temperature", "ambient_temperature", "approach = 3"}},
        BadInput{"UnknownRole",
                 "recovery_temprature = \"RTF1\"\n",
                 "5:1",
                 {"recovery_temprature", "recovery_temperature"}},
        BadInput{"DerivedQuantityAsRole", "dynamic_ratio = \"X\"\n", "5:1", {"dynamic_ratio"}},
        BadInput{"VariableOfWrongType", "attack = 3\n", "5:10", {"attack", "[variables]"}},
        BadInput{"EmptyVariable", "attack = \"\"\n", "5:10", {}},
        BadInput{"UnknownUnit", "[units]\nstatic_pressure = \"mBarr\"\n", "6:19", {"mBarr", "hPa"}},
        BadInput{"UnitOfAnotherKind", "[units]\nunit.static_pressure = \"K\"\n", "6:24", {"K", "hPa"}},
        BadInput{"UnitOfUnknownRole", "[units]\nunit.static_presure = \"hPa\"\n", "6:6", {"static_pressure"}},
        BadInput{"UnitWithoutVariable", "[units]\nflaps = \"percent\"\n", "6:1", {}},
        BadInput{"UnitTwice",
                 "[units]\nunit.static_pressure = \"hPa\"\nstatic_pressure = \"hPa\"\n",
                 "7:1",
                 {"static_pressure"}},
        BadInput{"UnknownOutput", "[output]\nPSCX = \"P\"\n", "6:1", {"PSCX", "PSXC"}},
        BadInput{"OutputsOfOneName", "[output]\nATX = \"TASX\"\n", "6:7", {"ATX", "TASX"}},
        BadInput{"OutputThatNetcdfRefuses", "[output]\nATX = \"a/b\"\n", "6:7", {"a/b"}},
        BadInput{"UnknownLamsKey", "[lams]\nelevaton = 1\n", "6:1", {"elevaton", "[lams]", "elevation"}},
        BadInput{"LamsKeyOfWrongType", "[lams]\nelevation = \"1\"\n", "6:13", {"elevation", "[lams]"}},
        BadInput{"NotANumber", "[lams]\nelevation = nan\n", "6:13", {"elevation", "[lams]"}},
        BadInput{"Infinite", "[lams]\nazimuth = -inf\n", "6:11", {}},
        BadInput{"TooLarge", "[lams]\nazimuth = 1e999\n", "6:16", {"1e999"}},
        BadInput{"Approach4", "[lams]\napproach = 4\n", "6:12", {std::string(approach_4_refusal)}},
        BadInput{"Approach5", "[lams]\napproach = 5\n", "6:12", {"1", "2", "3"}},
        BadInput{"ApproachWithFraction", "[lams]\napproach = 1.5\n", "6:12", {}},
        BadInput{"LamsIsNoTable",
                 "\nlams = 3\nformat = \"pcor-model/1\"\nvariables = { static_pressure = \"P\", "
                 "dynamic_pressure = \"Q\" }",
                 "2:8",
                 {"lams", "[lams]"}},
        BadInput{"UnknownRecoveryFactor",
                 "[temperature]\nrecovery_factor = \"harco-heated-2015\"\n",
                 "6:19",
                 {"harco-heated-2015", "harco-heated-2014"}},
        BadInput{"RecoveryFactorOfZero", "[temperature]\nrecovery_factor = 0\n", "6:19", {"0"}},
        BadInput{"RecoveryFactorTooLarge", "[temperature]\nrecovery_factor = 1.3\n", "6:19", {"1.3", "1.2"}},
        BadInput{"RecoveryFactorNaN", "[temperature]\nrecovery_factor = nan\n", "6:19", {}},
        BadInput{"RecoveryFactorOfWrongType", "[temperature]\nrecovery_factor = true\n", "6:19", {}},
        BadInput{
            "RecoveryFactorOfThreeNumbers", "[temperature]\nrecovery_factor = [1, 2, 3]\n", "6:19", {"3"}},
        BadInput{"MoistOfWrongType", "[humidity]\nmoist = 1\n", "6:9", {}},
        BadInput{"RadomeOfOneNumber", "[radome]\nattack = [1]\n", "6:10", {"1"}},
        BadInput{"RadomeOfText", "[radome]\nattack = [1, \"2\"]\n", "6:14", {}},
        BadInput{"RadomeUnknown", "[radome]\natack = [1, 2]\n", "6:1", {"attack"}},
        BadInput{"NegativeTaper", "[policy]\ntaper_below = -1\n", "6:15", {}},
        BadInput{"UnknownPolicy", "[policy]\ntaper = 1\n", "6:1", {"taper_below"}},
        BadInput{"UnknownDomain", "[domain]\nmahc = [0, 1]\n", "6:1", {"mahc", "mach"}},
        BadInput{"DomainUpsideDown", "[domain]\nmach = [1, 0]\n", "6:8", {"1", "0"}},
        BadInput{"DomainOfOneNumber", "[domain]\nmach = [1]\n", "6:8", {}},
        BadInput{"DomainInfinite", "[domain]\nmach = [0, inf]\n", "6:12", {}},
        BadInput{"EffectIsATable", "[effect]\nid = \"static-qp\"\n", "5:1", {"[[effect]]"}},
        BadInput{"EffectWithoutId", "[[effect]]\nparameters = { a0 = 1 }\n", "5:1", {}},
        BadInput{"UnknownEffect", "[[effect]]\nid = \"static-pq\"\n", "6:6", {"static-pq", "static-qp"}},
        BadInput{"EffectTwice", constant + constant, "8:6", {"static-constant", "6"}},
        BadInput{"FormulaTwice", user_formula + user_formula, "10:6", {"own", "6"}},
        BadInput{"FormulaOfTheCatalogue",
                 constant + "formula = \"k * mach\"\nparameters = { k = 1 }\n",
                 "7:1",
                 {"formula"}},
        BadInput{"UnknownEffectKey", constant + "fixd = []\n", "7:1", {"fixd", "[[effect]]", "fixed"}},
        BadInput{"UnknownParameter",
                 constant + "parameters = { a1 = 1 }\n",
                 "7:16",
                 {"static-constant", "a1", "a0"}},
        BadInput{"ParameterOfWrongType", constant + "parameters = { a0 = \"1\" }\n", "7:21", {}},
        BadInput{"ParameterNaN", constant + "parameters = { a0 = nan }\n", "7:21", {}},
        BadInput{"ParametersOfWrongType", constant + "parameters = [1]\n", "7:14", {}},
        BadInput{"ScalingByAnotherQuantity",
                 constant + "scaling = { mach = 1 }\n",
                 "7:13",
                 {"mach", "static_pressure"}},
        BadInput{"ScalingByABrokenPower",
                 constant + "scaling = { dynamic_pressure = 0.5 }\n",
                 "7:32",
                 {"0.5", "-3 to 3"}},
        BadInput{"ScalingByALargePower",
                 constant + "scaling = { static_pressure = -4 }\n",
                 "7:31",
                 {"-4", "-3 to 3"}},
        BadInput{"ScalingOfAFormula", user_formula + "scaling = { static_pressure = 1 }\n", "9:1", {"own"}},
        BadInput{"PlaceOfACatalogueEffect", constant + "where = \"static\"\n", "7:1", {"where"}},
        BadInput{"UnknownStderr", constant + "stderr = { b = 1 }\n", "7:12", {"b"}},
        BadInput{"NegativeStderr", constant + "stderr = { a0 = -1 }\n", "7:17", {}},
        BadInput{"UnknownFixed", constant + "fixed = [\"a2\"]\n", "7:10", {"a2", "a0"}},
        BadInput{"FixedTwice", constant + "fixed = [\"a0\", \"a0\"]\n", "7:16", {}},
        BadInput{"FixedOfWrongType", constant + "fixed = true\n", "7:9", {}},
        BadInput{"BoundsUpsideDown", constant + "bounds = { a0 = [1, -1] }\n", "7:17", {}},
        BadInput{"ImpossibleParameter",
                 constant + "parameters = { a0 = 0.62 }\n",
                 "7:21",
                 {"a0", "0.62", "[-0.5, 0.5]"}},
        BadInput{
            "BoundsBeyondTheCatalogue", constant + "bounds = { a0 = [-1, 0.01] }\n", "7:17", {"[-0.5, 0.5]"}},
        BadInput{"ValueOutsideItsBounds", constant + "bounds = { a0 = [0.01, 0.02] }\n", "7:17", {}},
        BadInput{"FormulaWithoutParameters", "[[effect]]\nid = \"own\"\nformula = \"k * mach\"\n", "7:1", {}},
        BadInput{"FormulaThatIsNone",
                 "[[effect]]\nid = \"own\"\nformula = \"k * (mach\"\nparameters = { k = 1 }\n",
                 "7:11",
                 {"own", "10"}},
        BadInput{"FormulaParameterOfAFunction",
                 "[[effect]]\nid = \"own\"\nformula = \"mach\"\nparameters = { sqrt = 1 }\n",
                 "8:14",
                 {"sqrt"}},
        BadInput{"UnusedFormulaParameter",
                 "[[effect]]\nid = \"own\"\nformula = \"k * mach\"\nparameters = { kk = 1 }\n",
                 "8:14",
                 {"kk", "k"}},
        BadInput{"UnknownPlace", user_formula + "where = \"statc\"\n", "9:9", {"statc", "static"}},
        BadInput{"WrongUnitOfAFormula", user_formula + "unit = \"Pa\"\n", "9:8", {"static", "Pa", "hPa"}},
        BadInput{"WrongUnitAtAnotherPlace",
                 user_formula + "where = \"attack\"\nunit = \"hPa\"\n",
                 "10:8",
                 {"attack", "deg"}},
        BadInput{"UnknownLawKey", "[law]\nvalid_form = \"2011-11-02\"\n", "6:1", {"valid_from"}},
        BadInput{"DateThatIsNone", "[law]\nvalid_from = \"2011-02-29\"\n", "6:14", {"2011-02-29"}},
        BadInput{"DateOfWrongType", "[law]\nvalid_from = 2011\n", "6:14", {}},
        BadInput{"LawEndsBeforeItBegins",
                 "[law]\nvalid_to = \"2011-01-01\"\nvalid_from = \"2011-11-02\"\n",
                 "6:12",
                 {"2011-01-01"}},
        BadInput{"NegativeRms", "[law]\nrms_hpa = -1\n", "6:11", {}},
        BadInput{"CovarianceWithoutMatrix", "[covariance]\nparameters = []\n", "5:2", {"matrix"}},
        BadInput{"CovarianceOfUnknownParameter",
                 constant + "[covariance]\nparameters = [\"static-constant.a1\"]\nmatrix = [[1]]\n",
                 "8:15",
                 {"static-constant.a1", "static-constant.a0"}},
        BadInput{"CovarianceOfWrongSize",
                 constant + "[covariance]\nparameters = [\"static-constant.a0\"]\nmatrix = [[1, 2]]\n",
                 "9:11",
                 {"1"}},
        BadInput{"CovarianceNaN",
                 constant + "[covariance]\nparameters = [\"static-constant.a0\"]\nmatrix = [[nan]]\n",
                 "9:12",
                 {}},
        BadInput{"NegativeVariance",
                 constant + "[covariance]\nparameters = [\"static-constant.a0\"]\nmatrix = [[-1]]\n",
                 "9:10",
                 {}},
        BadInput{"CovarianceNotSymmetric",
                 constant + "[[effect]]\nid = \"static-qp\"\n[covariance]\nparameters = "
                            "[\"static-constant.a0\", \"static-qp.a2\"]\nmatrix = [[1, 2], [3, 4]]\n",
                 "11:10",
                 {}},
        BadInput{"CovarianceNotPositive",
                 constant + "[[effect]]\nid = \"static-qp\"\n[covariance]\nparameters = "
                            "[\"static-constant.a0\", \"static-qp.a2\"]\nmatrix = [[1, 2], [2, 1]]\n",
                 "11:10",
                 {}},
        BadInput{"CovarianceOfOtherValues",
                 constant + "[covariance]\nparameters = [\"static-constant.a0\"]\nvalues = [0.5]\nmatrix = "
                            "[[1]]\n",
                 "9:10",
                 {"[covariance]", "0.5", "static-constant.a0"}},
        BadInput{
            "CovarianceOfMoreValues",
            constant + "[covariance]\nparameters = [\"static-constant.a0\"]\nvalues = []\nmatrix = [[1]]\n",
            "9:10",
            {"values", "0", "1"}},
        BadInput{"CovarianceOfOtherErrors",
                 constant + "stderr = { a0 = 0.2 }\n[covariance]\nparameters = [\"static-constant.a0\"]\n"
                            "matrix = [[0.01]]\n",
                 "10:10",
                 {"[covariance]", "0.1", "0.2"}},
        BadInput{"UncertaintyOfNothing", "[uncertainty]\nstatic_presure = 0.1\n", "6:1", {"static_pressure"}},
        BadInput{"UncertaintyWithoutVariable", "[uncertainty]\nattack = 0.1\n", "6:1", {"attack"}},
        BadInput{"NegativeUncertainty", "[uncertainty]\nstatic_defect = -0.1\n", "6:17", {}},
        BadInput{"ProvenanceNaN", "[provenance]\nrms = { a = [nan] }\n", "6:14", {}}),
    [](const auto& test) { return test.param.name; });

TEST(ModelDefinition, UnreadableDefinitionCannotBeWritten) {
  ModelDefinition file = parsed(published_example);
  file.model.effects[0].parameters[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(write_error_of(file), IsError(Error::Code::definition, "static-constant.a0", "nan"));
  file = parsed(published_example);
  file.model.effects[0].parameters.clear();
  EXPECT_THAT(write_error_of(file), IsError(Error::Code::definition, "'static-constant'", "1", "0"));
  file.model.effects[0].id = "static-constnat";
  EXPECT_THAT(write_error_of(file), IsError(Error::Code::usage, "'static-constnat'", "static-constant"));
  file = parsed(published_example);
  file.variables.erase(Quantity::static_pressure);
  EXPECT_THAT(write_error_of(file), IsError(Error::Code::definition, "static_pressure"));
  file = parsed(published_example);
  file.model.name = "latin \xe9";
  EXPECT_THAT(write_error_of(file), IsError(Error::Code::definition));
}

TEST(ModelDefinition, ChangedRecoveryFactorLosesPublishedName) {
  ModelDefinition file = parsed(minimum_model + "[temperature]\nrecovery_factor = \"rosemount-heated\"\n");
  EXPECT_THAT(write_model(file), HasSubstr("recovery_factor = \"rosemount-heated\""));
  file.model.recovery.coefficients[0] = 0.96;
  EXPECT_THAT(write_model(file), HasSubstr("recovery_factor = 0.96\n"));
}

TEST_F(ModelFileOnDisk, ErrorNamesTheFile) {
  const fs::path path = write("bad.toml", minimum_model + "[lams]\nelevation = nan\n");
  EXPECT_THAT(read_error_of(path), IsError(Error::Code::definition, path.string() + ":6:13"));
}

TEST_F(ModelFileOnDisk, AbsentFileOrDirectoryIsRefused) {
  EXPECT_THAT(read_error_of(directory_ / "none.toml"), IsError(Error::Code::file, "none.toml"));
  EXPECT_THAT(read_error_of(directory_.path()), IsError(Error::Code::file, directory_.path().string()));
}

TEST_F(ModelFileOnDisk, SavingReplacesAnExistingFile) {
  const ModelDefinition file = read_model(write("in.toml", published_example));
  const fs::path output = write("out.toml", "old");
  save_model(file, output, {directory_ / "in.toml"});
  EXPECT_EQ(content(output), write_model(file));
  EXPECT_EQ(Description::of(read_model(output)), Description::of(file));
}

TEST_F(ModelFileOnDisk, InputOrLinkToItIsNotOverwritten) {
  const fs::path input = write("in.toml", published_example);
  const ModelDefinition file = read_model(input);
  fs::create_symlink(input, directory_ / "link.toml");
  fs::create_hard_link(input, directory_ / "hard.toml");
  for (const char* name : {"in.toml", "link.toml", "hard.toml", "./in.toml"}) {
    const fs::path output = directory_ / name;
    EXPECT_THAT(error_of([&] {
                  save_model(file, output, {directory_ / "other.toml", input});
                }),
                IsError(Error::Code::usage, output.string()));
  }
  EXPECT_EQ(content(input), published_example);
}

TEST_F(ModelFileOnDisk, UnwritableModelKeepsTheFile) {
  ModelDefinition file = parsed(published_example);
  file.model.effects[0].parameters[0] = std::numeric_limits<double>::infinity();
  const fs::path output = write("out.toml", "old");
  EXPECT_THROW(save_model(file, output, {}), Error);
  EXPECT_EQ(content(output), "old");
  EXPECT_EQ(directory_.entries(), 1U);
}

TEST_F(ModelFileOnDisk, SavingToAMissingDirectoryFails) {
  EXPECT_THROW(save_model(parsed(minimum_model), directory_ / "none" / "m.toml", {}), Error);
}

}  // namespace
