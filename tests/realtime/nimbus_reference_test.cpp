#include <gtest/gtest.h>

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>

#include <pcor/physics/air_data.hpp>
#include <pcor/physics/humidity.hpp>
#include <pcor/physics/recovery_factor.hpp>
#include <pcor/realtime/chain.hpp>
#include "support/reference_table.hpp"

namespace pcor {
namespace {

// The values of nimbus have nine digits. Half of the last one is the tolerance if its functions are exact;
// the test gives the reason for any wider tolerance.

const test::ReferenceTable& reference() {
  static const test::ReferenceTable table;
  return table;
}

RecoveryFactor recovery_factor(const std::string& name) {
  for (const PublishedRecoveryFactor& published : published_recovery_factors) {
    if (published.name == name) return published.law;
  }
  ADD_FAILURE() << "no recovery factor " << name;
  return {};
}

struct Air {
  double mach;
  double factor;
  double celsius;
  double airspeed;
};

Air air_at(std::size_t row, double e_over_p, const RecoveryFactor& recovery) {
  const MoistAir<double> constants = moist_air(e_over_p);
  Air air{};
  air.mach = mach_number(reference().at("Pm_hPa", row), reference().at("Qm_hPa", row), constants);
  air.factor = recovery(air.mach);
  const double thermometer = reference().at("rt_degC", row) + constants::ice_point;
  const double temperature = ambient_temperature(thermometer, air.mach, air.factor, constants);
  air.celsius = temperature - constants::ice_point;
  air.airspeed = true_airspeed(air.mach, temperature, constants);
  return air;
}

TEST(NimbusReference, HasAllRows) { EXPECT_EQ(reference().rows(), 2000U); }

TEST(NimbusReference, MachNumber) {
  for (std::size_t row = 0; row < reference().rows(); ++row) {
    const double p = reference().at("Pm_hPa", row);
    const double q = reference().at("Qm_hPa", row);
    EXPECT_NEAR(mach_number(p, q, dry_air<double>()), reference().at("mach_dry_fn", row), 6e-10) << row;
    const double moist = mach_number(p, q, moist_air(reference().at("e_over_p", row)));
    EXPECT_NEAR(moist, reference().at("mach_moist", row), 6e-10) << row;
  }
}

// nimbus rounds the constants of dry air, so its own differ by 3e-8 relative.
TEST(NimbusReference, ConstantsOfMoistAir) {
  for (std::size_t row = 0; row < reference().rows(); ++row) {
    const MoistAir<double> air = moist_air(reference().at("e_over_p", row));
    EXPECT_NEAR(air.gas_constant, reference().at("R_moist_J_kgK", row), 1e-5) << row;
    EXPECT_NEAR(air.specific_heat_volume, reference().at("Cv_moist_J_kgK", row), 2e-5) << row;
    EXPECT_NEAR(air.specific_heat_pressure, reference().at("Cp_moist_J_kgK", row), 3e-5) << row;
  }
}

// The airspeed has the gas constant's 3e-8: at 290 m/s 4e-6 m/s.
TEST(NimbusReference, TemperatureAndAirspeedInMoistAir) {
  const RecoveryFactor unheated = recovery_factor("rosemount-unheated-2014");
  const RecoveryFactor heated = recovery_factor("harco-heated-2022");
  for (std::size_t row = 0; row < reference().rows(); ++row) {
    const double e_over_p = reference().at("e_over_p", row);
    const Air cold = air_at(row, e_over_p, unheated);
    EXPECT_NEAR(cold.factor, reference().at("rf_unheated_moistM", row), 6e-10) << row;
    EXPECT_NEAR(cold.celsius, reference().at("AT_unheated_moist_degC", row), 6e-8) << row;
    EXPECT_NEAR(cold.airspeed, reference().at("TAS_unheated_moist_m_s", row), 4e-6) << row;
    const Air warm = air_at(row, e_over_p, heated);
    EXPECT_NEAR(warm.factor, reference().at("rf_heated_moistM", row), 6e-10) << row;
    EXPECT_NEAR(warm.celsius, reference().at("AT_heated_moist_degC", row), 6e-8) << row;
    EXPECT_NEAR(warm.airspeed, reference().at("TAS_heated_moist_m_s", row), 4e-6) << row;
  }
}

TEST(NimbusReference, TemperatureAndAirspeedInDryAir) {
  const RecoveryFactor unheated = recovery_factor("rosemount-unheated-2014");
  for (std::size_t row = 0; row < reference().rows(); ++row) {
    const Air air = air_at(row, 0.0, unheated);
    EXPECT_NEAR(air.factor, reference().at("rf_unheated_dryM", row), 6e-10) << row;
    EXPECT_NEAR(air.celsius, reference().at("AT_unheated_dry_degC", row), 6e-8) << row;
    EXPECT_NEAR(air.airspeed, reference().at("TAS_unheated_dry_m_s", row), 6e-7) << row;
  }
}

// nimbus and this program differ by up to 1.5e-7 relative over water, 2e-8 over ice: far within the 5e-4 and
// 2.5e-4 that the source states for the formulas.
TEST(NimbusReference, SaturationVapourPressure) {
  for (std::size_t row = 0; row < reference().rows(); ++row) {
    const double temperature = reference().at("Tk_K", row);
    const auto agrees = [row](double value, const char* column, double relative) {
      const double expected = reference().at(column, row);
      EXPECT_NEAR(value, expected, relative * expected) << column << ", row " << row;
    };
    agrees(vapor_pressure_over_water(temperature), "WaterVaporPressureOfWater_Tk_hPa", 2e-7);
    agrees(vapor_pressure_over_ice(temperature), "WaterVaporPressureOfIce_Tk_hPa", 3e-8);
    agrees(saturation_vapor_pressure(temperature), "WaterVaporPressure_Tk_hPa", 2e-7);
  }
}

ModelEffect effect(const char* id, double parameter) {
  ModelEffect result;
  result.id = id;
  result.parameters = {parameter};
  return result;
}

Model heated_thermometer() {
  Model model;
  model.recovery = recovery_factor("harco-heated-2022");
  model.policy.taper_below = 40.0;
  return model;
}

Model c130_right_pair() {
  Model model = heated_thermometer();
  model.effects = {effect("static-constant", 0.007372), effect("static-qp", 0.12774),
                   effect("static-attack", -6.8776e-4), effect("static-mach", -0.02994),
                   effect("static-alpha-quad", 0.001630)};
  return model;
}

Model c130_left_pair() {
  Model model = heated_thermometer();
  model.effects = {effect("static-constant", -4.389e-3), effect("static-qp", -2.966e-2),
                   effect("static-attack", -6.831e-5), effect("static-mach", 2.672e-2),
                   effect("static-alpha-quad", 2.447e-3)};
  return model;
}

Model gv_fuselage_pair() {
  Model model = heated_thermometer();
  model.effects = {effect("static-constant", -0.012255), effect("static-qp", 0.075372),
                   effect("static-mach3", -0.087508), effect("static-attack", 0.002148)};
  return model;
}

Chain chain_of(const Model& model) {
  BindingError error;
  const std::optional<Chain> chain =
      Chain::build(model,
                   {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::attack,
                    Quantity::recovery_temperature, Quantity::vapor_pressure},
                   &error);
  if (!chain) throw std::runtime_error(error.message());
  return *chain;
}

// One sample through the whole chain: PSFC, QCFC, MACHF, ATH1, TASF, with the vapour pressure that nimbus
// found, which never reaches saturation in these rows. On the C-130 nimbus pairs PSFC from the right static
// ports with QCFC from the left ones, so the test does.
//
// The pressures have the float of nimbus. Other results are computed from the pressures of the table, which
// have nine digits: 1e-8 of Mach number, 1e-6 K, 1e-5 m/s where q is smallest.
TEST(NimbusReference, WholeChain) {
  const Chain right = chain_of(c130_right_pair());
  const Chain left = chain_of(c130_left_pair());
  const Chain gv = chain_of(gv_fuselage_pair());
  for (std::size_t row = 0; row < reference().rows(); ++row) {
    const Chain& static_chain = reference().is_gv(row) ? gv : right;
    const Chain& dynamic_chain = reference().is_gv(row) ? gv : left;
    const double p = reference().at("Pm_hPa", row);
    const double q = reference().at("Qm_hPa", row);
    State<double> state;
    state[Quantity::static_pressure] = p;
    state[Quantity::dynamic_pressure] = q;
    state[Quantity::attack] = reference().at("attack_deg", row);
    state[Quantity::recovery_temperature] = reference().at("rt_degC", row) + constants::ice_point;
    state[Quantity::vapor_pressure] = reference().at("chain_EWX_hPa", row);
    QualityFlags flags;
    static_chain.correct_inputs(state, static_chain.parameters().data(), flags);
    const double static_defect = static_chain.static_defect(state, static_chain.parameters().data(), flags);
    const double dynamic_defect =
        dynamic_chain.static_defect(state, dynamic_chain.parameters().data(), flags);
    EXPECT_NEAR(p + static_defect, reference().at("chain_PSFC_hPa", row), 3e-5) << row;
    EXPECT_NEAR(q - dynamic_defect, reference().at("chain_QCFC_hPa", row), 3e-5) << row;

    state[Quantity::corrected_static_pressure] = reference().at("chain_PSFC_hPa", row);
    state[Quantity::corrected_dynamic_pressure] = reference().at("chain_QCFC_hPa", row);
    static_chain.air(state, static_chain.parameters().data(), flags);
    EXPECT_NEAR(state[Quantity::corrected_mach], reference().at("chain_MACHF", row), 1e-8) << row;
    EXPECT_NEAR(state[Quantity::ambient_temperature] - constants::ice_point,
                reference().at("chain_ATH1_degC", row), 1e-6)
        << row;
    EXPECT_NEAR(state[Quantity::corrected_airspeed], reference().at("chain_TASF_m_s", row), 1e-5) << row;
    EXPECT_FALSE(flags.has(Quality::humidity_limited)) << row;
  }
}

}  // namespace
}  // namespace pcor
