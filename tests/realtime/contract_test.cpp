// Contract of the sample loop for every result and any input: a value, or NaN with a bit that gives the
// reason.
#include <pcor/realtime/loop.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <optional>
#include <ostream>
#include <string>

#include "realtime/sample.hpp"
#include "support/constants.hpp"
#include "support/uncertain_in_everything.hpp"

namespace {

using pcor::CorrectWith;
using pcor::Loop;
using pcor::Model;
using pcor::ModelEffect;
using pcor::Quantity;
using pcor::test::infinity;
using pcor::test::level;
using pcor::test::missing;
using pcor::test::Sample;

/// A role, and a value that a flight has of it.
struct RoleCase {
  Quantity role;
  double good;

  friend std::ostream& operator<<(std::ostream& out, const RoleCase& given) {
    return out << pcor::info_of(given.role).name;
  }
};

/// Central values of the possible ranges, without special values of a flight.
double good_value(Quantity role) {
  const Sample special{{Quantity::ambient_temperature, 274.0},
                       {Quantity::dew_point, 270.0},
                       {Quantity::frost_point, 270.0},
                       {Quantity::attack, 3.0},
                       {Quantity::sideslip, 0.5},
                       {Quantity::mach, 0.37},
                       {Quantity::true_airspeed, 117.0},
                       {Quantity::transducer_temperature, 300.0},
                       {Quantity::cabin_pressure, 850.0},
                       {Quantity::date, 4000.0}};
  if (const auto usual = level.find(role); usual != level.end()) return usual->second;
  const auto found = special.find(role);
  return found == special.end() ? 10.0 : found->second;
}

std::vector<RoleCase> all_roles() {
  std::vector<RoleCase> all;
  for (std::size_t i = 0; i < pcor::role_count; ++i) {
    const auto role = static_cast<Quantity>(i);
    all.push_back({role, good_value(role)});
  }
  return all;
}

/// A model all of whose stages are at work, and which reads that role.
Model model_of(Quantity role) {
  Model model;
  model.effects = {
      {"static-constant", {0.004127875}}, {"static-alpha", {0.021279816}}, {"static-qp", {0.030849643}}};
  model.recovery = {{0.95}};
  model.attack_radome = {4.9, 13.4, 6.1};
  model.sideslip_radome = {0.1, 11.8, 0.0};
  ModelEffect effect;
  effect.id = "of-the-role";
  effect.formula = "k * " + std::string(pcor::info_of(role).name);
  effect.parameter_names = {"k"};
  effect.parameters = {1e-4};
  model.effects.push_back(effect);
  return model;
}

Sample sample_of(const RoleCase& given) {
  Sample sample = level;
  // One humidity and one temperature: a second one would not be used.
  if (given.role == Quantity::dew_point || given.role == Quantity::frost_point)
    sample.erase(Quantity::vapor_pressure);
  if (given.role == Quantity::ambient_temperature) {
    sample.erase(Quantity::recovery_temperature);
    sample.erase(Quantity::lams_airspeed);  // required by the stage
  }
  sample[given.role] = given.good;
  return sample;
}

class Contract : public testing::TestWithParam<RoleCase> {
 protected:
  static Loop build(const Sample& sample, const Model& model, CorrectWith with) {
    std::vector<Quantity> roles;
    for (const auto& [role, value] : sample) roles.push_back(role);
    std::string error;
    std::optional<Loop> loop =
        Loop::build(model, roles, 1.0, &error, with, pcor::test::uncertain_in_everything(model));
    EXPECT_TRUE(loop) << error;
    return std::move(*loop);
  }

  static void run(Loop& loop, const Sample& sample) {
    for (const auto& [role, value] : sample) loop.state()[role] = value;
    loop.run(0.0);
  }

  /// All results from the model and the laser, and what is known of them.
  static std::vector<Quantity> results_of(const Loop& loop) {
    std::vector<Quantity> results;
    for (std::size_t i = pcor::index(Quantity::static_defect); i < pcor::quantity_count; ++i)
      if (loop.writes(static_cast<Quantity>(i))) results.push_back(static_cast<Quantity>(i));
    return results;
  }

  /// Runs a good sample and the same with another value of the role, and calls `judge` with each result of
  /// both and with the bits that are of the second alone.
  template <class Judge>
  static void judge_each(double value, Judge judge) {
    for (const CorrectWith with : {CorrectWith::model, CorrectWith::lams}) {
      const Sample good = sample_of(GetParam());
      if (with == CorrectWith::lams && good.count(Quantity::lams_airspeed) == 0) continue;
      Sample bad = good;
      bad[GetParam().role] = value;
      const Model model = model_of(GetParam().role);
      Loop expected = build(good, model, with), loop = build(bad, model, with);
      run(expected, good);
      run(loop, bad);
      for (const Quantity result : results_of(loop)) {
        SCOPED_TRACE(testing::Message() << pcor::info_of(result).name << " with " << value);
        judge(loop.state()[result], expected.state()[result],
              loop.quality().bits() & ~expected.quality().bits());
      }
    }
  }
};

INSTANTIATE_TEST_SUITE_P(Roles, Contract, testing::ValuesIn(all_roles()),
                         [](const auto& each) { return std::string(pcor::info_of(each.param.role).name); });

// The result equals the result of a good sample if it does not depend on the role; otherwise it is missing,
// or another, and a bit is set: dry air is assumed if the humidity is missing, the model if the laser is.
TEST_P(Contract, MissingInputSetsABitIfResultsChange) {
  for (const double none : {missing, infinity, -infinity}) {
    judge_each(none, [](double value, double expected, std::uint32_t bits) {
      const bool is_unhurt = value == expected || (std::isnan(value) && std::isnan(expected));
      EXPECT_TRUE(is_unhurt || bits != 0U) << value << " for " << expected << " without a bit";
      EXPECT_FALSE(std::isinf(value));
    });
  }
}

// Numbers that no flight has, at the limits of the role and beyond: no result is infinite, and NaN only with
// a bit.
TEST_P(Contract, MissingResultSetsABitForAnyNumber) {
  const pcor::QuantityInfo& info = pcor::info_of(GetParam().role);
  for (const double number :
       {0.0, -0.0, -GetParam().good, info.minimum, info.maximum, 2.0 * info.minimum, 2.0 * info.maximum,
        1e-310, 1e30, -1e30, std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()}) {
    judge_each(number, [](double value, double expected, std::uint32_t bits) {
      EXPECT_FALSE(std::isinf(value));
      EXPECT_TRUE(!std::isnan(value) || std::isnan(expected) || bits != 0U) << "missing without a bit";
    });
  }
}

}  // namespace
