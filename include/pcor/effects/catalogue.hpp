#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <tuple>

#include <pcor/effects/adif_drift.hpp>
#include <pcor/effects/aircraft_step.hpp>
#include <pcor/effects/clock_skew.hpp>
#include <pcor/effects/flaps_gear.hpp>
#include <pcor/effects/ground_effect.hpp>
#include <pcor/effects/humidity_error.hpp>
#include <pcor/effects/humidity_neglected.hpp>
#include <pcor/effects/lams_azimuth.hpp>
#include <pcor/effects/lams_cloud.hpp>
#include <pcor/effects/lams_elevation.hpp>
#include <pcor/effects/lams_induction.hpp>
#include <pcor/effects/lams_pod_flex.hpp>
#include <pcor/effects/lams_scale.hpp>
#include <pcor/effects/line_head.hpp>
#include <pcor/effects/load_factor.hpp>
#include <pcor/effects/pitot_angle.hpp>
#include <pcor/effects/psfd_bias.hpp>
#include <pcor/effects/psfd_drift.hpp>
#include <pcor/effects/psfd_gain.hpp>
#include <pcor/effects/psfd_thermal.hpp>
#include <pcor/effects/qcf_drift.hpp>
#include <pcor/effects/qcf_gain.hpp>
#include <pcor/effects/qcf_lag.hpp>
#include <pcor/effects/qcf_zero.hpp>
#include <pcor/effects/qcr_angle.hpp>
#include <pcor/effects/recovery_factor.hpp>
#include <pcor/effects/roll_static.hpp>
#include <pcor/effects/speedbrake_thrust.hpp>
#include <pcor/effects/static_alpha.hpp>
#include <pcor/effects/static_alpha_quad.hpp>
#include <pcor/effects/static_attack.hpp>
#include <pcor/effects/static_beta_even.hpp>
#include <pcor/effects/static_beta_odd.hpp>
#include <pcor/effects/static_constant.hpp>
#include <pcor/effects/static_lag.hpp>
#include <pcor/effects/static_leak.hpp>
#include <pcor/effects/static_mach.hpp>
#include <pcor/effects/static_mach2.hpp>
#include <pcor/effects/static_mach3.hpp>
#include <pcor/effects/static_qp.hpp>
#include <pcor/effects/static_transonic.hpp>
#include <pcor/effects/temp_calibration.hpp>
#include <pcor/effects/temp_deice_heat.hpp>
#include <pcor/effects/temp_drift.hpp>
#include <pcor/effects/temp_lag.hpp>
#include <pcor/effects/temp_offset.hpp>
#include <pcor/effects/temp_wetting.hpp>
#include <pcor/effects/time_drift.hpp>
#include <pcor/effects/total_lag.hpp>
#include <pcor/effects/transducer_thermal.hpp>
#include <pcor/model/state.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor {

/// All effects of the library. To add one: write its file in `effects/` and add it here.
using Catalogue = std::tuple<effects::StaticLag,            //
                             effects::RecoveryFactorError,  //
                             effects::LamsElevation,        //
                             effects::StaticConstant,       //
                             effects::StaticAlpha,          //
                             effects::StaticAttack,         //
                             effects::StaticAlphaQuad,      //
                             effects::StaticQp,             //
                             effects::StaticMach,           //
                             effects::StaticMach2,          //
                             effects::StaticMach3,          //
                             effects::StaticBetaOdd,        //
                             effects::StaticBetaEven,       //
                             effects::StaticTransonic,      //
                             effects::FlapsGear,            //
                             effects::SpeedbrakeThrust,     //
                             effects::GroundEffect,         //
                             effects::LoadFactor,           //
                             effects::RollStatic,           //
                             effects::TimeDrift,            //
                             effects::AircraftStep,         //
                             effects::PitotAngle,           //
                             effects::QcfLag,               //
                             effects::QcfZero,              //
                             effects::QcfGain,              //
                             effects::QcfDrift,             //
                             effects::PsfdBias,             //
                             effects::PsfdGain,             //
                             effects::PsfdDrift,            //
                             effects::TransducerThermal,    //
                             effects::PsfdThermal,          //
                             effects::TotalLag,             //
                             effects::StaticLeak,           //
                             effects::LineHead,             //
                             effects::QcrAngle,             //
                             effects::AdifDrift,            //
                             effects::LamsAzimuth,          //
                             effects::LamsPodFlex,          //
                             effects::LamsScale,            //
                             effects::LamsInduction,        //
                             effects::LamsCloud,            //
                             effects::ClockSkew,            //
                             effects::TempOffset,           //
                             effects::TempDrift,            //
                             effects::TempLag,              //
                             effects::TempDeiceHeat,        //
                             effects::TempWetting,          //
                             effects::TempCalibration,      //
                             effects::HumidityNeglected,    //
                             effects::HumidityError>;

inline constexpr std::size_t catalogue_size = std::tuple_size_v<Catalogue>;

namespace detail {

template <class... Effect>
constexpr std::array<EffectInfo, sizeof...(Effect)> info_of_effects(const std::tuple<Effect...>*) {
  return {Effect::info()...};
}

template <class S, class P>
using EffectFunction = Promoted<S, P> (*)(const State<S>&, const P*);

template <class S, class P, class Effect>
Promoted<S, P> effect_value(const State<S>& state, const P* parameters) {
  return Promoted<S, P>(Effect::value(state, parameters));
}

template <class S, class P, class... Effect>
constexpr std::array<EffectFunction<S, P>, sizeof...(Effect)> functions_of_effects(
    const std::tuple<Effect...>*) {
  return {&effect_value<S, P, Effect>...};
}

}  // namespace detail

/// Metadata of every effect, in the order of the catalogue.
inline constexpr std::array<EffectInfo, catalogue_size> effect_info =
    detail::info_of_effects(static_cast<const Catalogue*>(nullptr));

/// Functions of all effects, for a state of scalar `S` and parameters of scalar `P`.
template <class S, class P>
inline constexpr auto effect_functions =
    detail::functions_of_effects<S, P>(static_cast<const Catalogue*>(nullptr));

/// Metadata of the effect `id` of the catalogue; null if there is no effect with that id.
constexpr const EffectInfo* effect_named(std::string_view id) {
  for (const EffectInfo& info : effect_info) {
    if (info.id == id) return &info;
  }
  return nullptr;
}

/// Index of an effect of the catalogue in `effect_info` and `effect_functions`.
/// @param info element of `effect_info`
constexpr std::size_t index_of(const EffectInfo& info) {
  return static_cast<std::size_t>(&info - effect_info.data());
}

}  // namespace pcor
