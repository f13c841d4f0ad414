#include <gmock/gmock.h>
#include <pcor/base/error.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/improve/improve.hpp>
#include <pcor/roles/add_effects.hpp>

#include <string>
#include <vector>

#include "support/error_of.hpp"
#include "support/netcdf_file.hpp"
#include "support/synthetic_samples.hpp"
#include "support/temporary_directory.hpp"

using pcor::Error;
using pcor::ModelDefinition;
using pcor::ModelEffect;
using pcor::Quantity;
using pcor::test::IsError;
using testing::ElementsAre;

namespace {

const std::string model_text = R"(format = "pcor-model/1"
name = "made"
aircraft = "C-130 N130AR"

[variables]
static_pressure = "PSFD"
dynamic_pressure = "QCF"

[units]
static_pressure = "mbar"

[output]
PSXC = "MINE"

[[effect]]
id = "static-constant"
parameters = { a0 = 0.004 }
stderr = { a0 = 0.001 }
fixed = ["a0"]
bounds = { a0 = [-0.01, 0.01] }

[law]
source = "the memo"

[provenance]
flights = ["one.nc"]
)";

ModelDefinition model() { return pcor::parse_model(model_text, "made.toml"); }

ModelEffect thrust(const std::string& formula = "k * ENGTRQ / 100") {
  ModelEffect effect;
  effect.id = "my-thrust";
  effect.formula = formula;
  effect.parameter_names = {"k"};
  effect.parameters = {0.0};
  effect.unit = "hPa";
  effect.source = "engine run-up";
  return effect;
}

ModelEffect of_catalogue(const std::string& id) {
  ModelEffect effect;
  effect.id = id;
  return effect;
}

std::optional<Error> refusal(const std::vector<ModelEffect>& effects,
                             const std::vector<std::string>& variables = {}) {
  return pcor::test::error_of([&] { add_effects(model(), effects, variables); });
}

}  // namespace

TEST(WithEffects, AddedEffectsAreNeutral) {
  const ModelDefinition file = add_effects(model(), {of_catalogue("static-qp"), of_catalogue("static-lag")});
  ASSERT_EQ(file.model.effects.size(), 3U);
  EXPECT_EQ(file.model.effects[1].id, "static-qp");
  EXPECT_THAT(file.model.effects[1].parameters, ElementsAre(0.0));
  EXPECT_THAT(file.model.effects[2].parameters, ElementsAre(0.0));
}

TEST(WithEffects, GivenParametersAreKept) {
  ModelEffect effect = of_catalogue("static-lag");
  effect.parameters = {0.2};
  EXPECT_THAT(add_effects(model(), {effect}).model.effects.back().parameters, ElementsAre(0.2));
}

TEST(WithEffects, RestOfTheModelIsUnchanged) {
  const std::string text = write_model(add_effects(model(), {of_catalogue("static-qp")}));
  const std::string added = "\n[[effect]]\nid = \"static-qp\"\nparameters = { a2 = 0.0 }\n";
  std::string expected = write_model(model());
  expected.insert(expected.find("\n[law]"), added);
  EXPECT_EQ(text, expected + "added = [\"static-qp\"]\n");
}

TEST(WithEffects, ProvenanceListsTheAddedEffects) {
  const ModelDefinition once = add_effects(model(), {of_catalogue("static-qp")});
  const ModelDefinition twice = add_effects(once, {of_catalogue("static-lag"), thrust()}, {"ENGTRQ"});
  EXPECT_THAT(added_effects(model()), ElementsAre());
  const ModelDefinition read = pcor::parse_model(write_model(twice), "made.toml");
  EXPECT_THAT(added_effects(read), ElementsAre("static-qp", "static-lag", "my-thrust"));
}

TEST(WithEffects, RequiredVariablesAreAdded) {
  const ModelDefinition file =
      add_effects(model(), {of_catalogue("static-attack"), of_catalogue("static-beta-odd")});
  EXPECT_EQ(file.variables.at(Quantity::attack), "ATTACK");
  EXPECT_EQ(file.variables.at(Quantity::sideslip_differential_pressure), "BDIFR");
  EXPECT_EQ(file.variables.at(Quantity::radome_dynamic_pressure), "QCR");
  EXPECT_EQ(file.variables.count(Quantity::attack_differential_pressure), 0U);
}

TEST(WithEffects, DerivedQuantitiesNeedNoVariable) {
  ModelDefinition file = model();
  file.variables[Quantity::radome_dynamic_pressure] = "QCR_B";
  file.variables[Quantity::attack_differential_pressure] = "ADIFR_B";
  file.model.attack_radome = {5.0, 20.0, 0.0};
  const ModelDefinition extended = add_effects(file, {of_catalogue("static-attack")});
  EXPECT_EQ(extended.variables, file.variables);
}

TEST(WithEffects, ChoosesVariablesOfTheFlight) {
  const ModelDefinition file = add_effects(model(), {of_catalogue("static-attack")}, {"PSFD", "AKRD", "QCF"});
  EXPECT_EQ(file.variables.at(Quantity::attack), "AKRD");
  const ModelDefinition suffixed =
      add_effects(model(), {of_catalogue("static-attack")}, {"ATTACKS", "AKRD_RWO"});
  EXPECT_EQ(suffixed.variables.at(Quantity::attack), "AKRD_RWO");
}

TEST(WithEffects, ChoosesAVariableByItsDescription) {
  const pcor::test::TemporaryDirectory folder;
  const auto path = folder.path() / "flight.nc";
  {
    pcor::test::NetcdfMaker maker(path);
    maker.time(pcor::test::sequence(0, 30));
    maker.text(maker.series("TRQ1", "percent", std::vector<double>(30, 60.0)), "long_name", "Engine Torque");
  }
  const pcor::Flight flight(path);
  const std::vector<ModelEffect> effects{of_catalogue("speedbrake-thrust")};
  EXPECT_EQ(add_effects(model(), effects, flight.variables(), &flight).variables.at(Quantity::engine_torque),
            "TRQ1");
  EXPECT_THAT(refusal(effects, flight.variables()), IsError(Error::Code::model, "'engine_torque'"));
}

TEST(WithEffects, MissingFlightVariablesAreReported) {
  EXPECT_THAT(refusal({of_catalogue("static-attack")}, {"PSFD", "QCF"}),
              IsError(Error::Code::model, "'static-attack'", "'attack'", "ATTACK, AKRD"));
}

TEST(WithEffects, AmbiguousRoleIsReported) {
  EXPECT_THAT(refusal({thrust("k * lams_airspeed")}),
              IsError(Error::Code::model, "'my-thrust'", "'lams_airspeed'", "lams_airspeed = \"...\""));
}

TEST(WithEffects, AcceptsAFormula) {
  const ModelDefinition file = add_effects(model(), {thrust("k * ENGTRQ * roll")}, {"ENGTRQ", "ROLL"});
  EXPECT_EQ(file.model.effects.back().formula, "k * ENGTRQ * roll");
  EXPECT_EQ(file.variables.at(Quantity::roll), "ROLL");
  EXPECT_EQ(file.variables.size(), 3U);
  EXPECT_EQ(write_model(pcor::parse_model(write_model(file), "it")), write_model(file));
}

TEST(WithEffects, InvalidEffectsAreRefused) {
  EXPECT_THAT(refusal({of_catalogue("static-constant")}), IsError(Error::Code::usage, "'static-constant'"));
  EXPECT_THAT(refusal({of_catalogue("static-qp"), of_catalogue("static-qp")}),
              IsError(Error::Code::usage, "'static-qp'"));
  EXPECT_THAT(refusal({of_catalogue("static-lg")}), IsError(Error::Code::usage, "'static-lg'", "static-lag"));
  EXPECT_THAT(refusal({thrust("k * (ENGTRQ")}), IsError(Error::Code::model, "'my-thrust'", "column 12"));
  ModelEffect catalogued = thrust();
  catalogued.id = "static-lag";
  EXPECT_THAT(refusal({catalogued}), IsError(Error::Code::usage, "'static-lag'"));
  ModelEffect wrong = of_catalogue("static-lag");
  wrong.parameters = {1.0, 2.0};
  EXPECT_THAT(refusal({wrong}), IsError(Error::Code::usage, "'static-lag'", "1", "2"));
}

TEST(WithEffects, ShapeParametersAreFixed) {
  for (const pcor::EffectInfo& info : pcor::effect_info) {
    ModelDefinition file = made::model({});
    for (std::size_t i = 0; i < pcor::role_count; ++i) {
      const auto role = static_cast<Quantity>(i);
      file.variables.emplace(role, std::string(pcor::info_of(role).name));
    }
    const ModelDefinition extended = add_effects(file, {of_catalogue(std::string(info.id))});
    for (std::size_t i = 0; i < info.parameter_count(); ++i)
      EXPECT_EQ(extended.fit(0, i).fixed, info.parameters[i].shape) << info.id;
  }
}
