#pragma once

#include <memory>
#include <utility>

#include <pcor/realtime/chain.hpp>
#include <pcor/realtime/functor.hpp>

namespace pcor {

/// The stages of a chain as functors of the sample loop.

/// Pressures at the ports, and the quantities in which the laws stand: `Chain::measure`.
class MeasuredQuantities final : public Functor {
 public:
  explicit MeasuredQuantities(std::shared_ptr<const Chain> chain)
      : Functor(inputs_of(*chain), outputs_of(*chain)), chain_(std::move(chain)) {}

  void compute(State<double>& state, QualityFlags& flags) noexcept override {
    chain_->measure(state, chain_->parameters().data(), flags);
  }

 private:
  static std::vector<Quantity> outputs_of(const Chain& chain) {
    std::vector<Quantity> outputs{Quantity::port_static_pressure, Quantity::port_dynamic_pressure};
    for (const Quantity derived :
         {Quantity::dynamic_ratio, Quantity::mach, Quantity::attack_ratio, Quantity::sideslip_ratio,
          Quantity::attack, Quantity::sideslip, Quantity::vapor_pressure, Quantity::airspeed_rate}) {
      if (chain.derives(derived)) outputs.push_back(derived);
    }
    const auto completes = [&](Where where, Quantity quantity) {
      if (chain.acts(where) && chain.recorded(quantity)) outputs.push_back(quantity);
    };
    completes(Where::radome, Quantity::radome_dynamic_pressure);
    completes(Where::attack, Quantity::attack);
    completes(Where::sideslip, Quantity::sideslip);
    completes(Where::ambient_temperature, Quantity::ambient_temperature);
    return outputs;
  }

  static std::vector<Quantity> inputs_of(const Chain& chain) {
    std::vector<Quantity> inputs;
    for (const Quantity input : chain.inputs()) {
      if (chain.needs(input)) inputs.push_back(input);
    }
    for (const Rate& each : rates) {
      if (chain.derives(each.rate)) inputs.push_back(each.rate);
    }
    return inputs;
  }

  std::shared_ptr<const Chain> chain_;
};

/// Delta-p of the model, hPa: `Chain::static_defect`.
class StaticDefect final : public Functor {
 public:
  explicit StaticDefect(std::shared_ptr<const Chain> chain)
      : Functor({Quantity::port_static_pressure}, {Quantity::static_defect}), chain_(std::move(chain)) {}

  void compute(State<double>& state, QualityFlags& flags) noexcept override {
    state[Quantity::static_defect] = chain_->static_defect(state, chain_->parameters().data(), flags);
  }

 private:
  std::shared_ptr<const Chain> chain_;
};

/// `inputs` and what is recorded of temperature and humidity.
inline std::vector<Quantity> with_air_inputs(const Chain& chain, std::vector<Quantity> inputs) {
  for (const Quantity input : {Quantity::recovery_temperature, Quantity::ambient_temperature,
                               Quantity::vapor_pressure, Quantity::dew_point, Quantity::frost_point}) {
    if (chain.recorded(input)) inputs.push_back(input);
  }
  return inputs;
}

/// `inputs`, the speed along the beam, and the angles that turn it into an airspeed.
inline std::vector<Quantity> with_beam_inputs(const Chain& chain, std::vector<Quantity> inputs) {
  for (const Quantity input : {Quantity::lams_airspeed, Quantity::attack, Quantity::sideslip}) {
    if (chain.needs(input) || chain.recorded(input)) inputs.push_back(input);
  }
  return inputs;
}

/// Delta-p from LAMS, hPa: `Chain::lams_static_defect`.
class LamsStaticDefect final : public Functor {
 public:
  explicit LamsStaticDefect(std::shared_ptr<const Chain> chain)
      : Functor(with_air_inputs(*chain, with_beam_inputs(*chain, {Quantity::port_static_pressure})),
                {Quantity::lams_static_defect}),
        chain_(std::move(chain)) {}

  void compute(State<double>& state, QualityFlags& flags) noexcept override {
    state[Quantity::lams_static_defect] =
        chain_->lams_static_defect(state, chain_->parameters().data(), flags);
  }

 private:
  std::shared_ptr<const Chain> chain_;
};

/// Which delta-p corrects the pressures.
enum class CorrectWith { model, lams };

/// Corrected static and dynamic pressure, hPa: `Chain::correct`, with delta-p of the model, or with that of
/// LAMS where it is valid and the quality bit `corrected_with_lams` says so.
class CorrectedPressures final : public Functor {
 public:
  CorrectedPressures(std::shared_ptr<const Chain> chain, CorrectWith with)
      : Functor(inputs_of(with), {Quantity::corrected_static_pressure, Quantity::corrected_dynamic_pressure}),
        chain_(std::move(chain)),
        with_(with) {}

  void compute(State<double>& state, QualityFlags& flags) noexcept override {
    double defect = state[Quantity::static_defect];
    const double lams = state[Quantity::lams_static_defect];
    if (with_ == CorrectWith::lams && !is_missing(lams)) {
      defect = lams;
      flags.set(Quality::corrected_with_lams);
    }
    chain_->correct(state, defect, flags);
  }

 private:
  static std::vector<Quantity> inputs_of(CorrectWith with) {
    std::vector<Quantity> inputs{Quantity::port_static_pressure, Quantity::static_defect};
    if (with == CorrectWith::lams) inputs.push_back(Quantity::lams_static_defect);
    return inputs;
  }

  std::shared_ptr<const Chain> chain_;
  CorrectWith with_;
};

/// Humidity, Mach number, ambient temperature (K) and true airspeed (m/s) from the corrected pressures:
/// `Chain::air`.
class AirState final : public Functor {
 public:
  explicit AirState(std::shared_ptr<const Chain> chain)
      : Functor(with_air_inputs(*chain, {Quantity::corrected_static_pressure}), outputs_of(*chain)),
        chain_(std::move(chain)) {}

  void compute(State<double>& state, QualityFlags& flags) noexcept override {
    chain_->air(state, chain_->parameters().data(), flags);
  }

 private:
  static std::vector<Quantity> outputs_of(const Chain& chain) {
    std::vector<Quantity> outputs{Quantity::humidity, Quantity::corrected_mach, Quantity::corrected_airspeed};
    if (chain.derives_temperature()) outputs.push_back(Quantity::ambient_temperature);
    return outputs;
  }

  std::shared_ptr<const Chain> chain_;
};

/// Temperature (K) and dynamic pressure (hPa) from LAMS and the corrected pressures: `Chain::lams_air`.
class LamsAir final : public Functor {
 public:
  explicit LamsAir(std::shared_ptr<const Chain> chain)
      : Functor(with_beam_inputs(*chain, {Quantity::corrected_mach}),
                {Quantity::lams_temperature, Quantity::lams_dynamic_pressure}),
        chain_(std::move(chain)) {}

  void compute(State<double>& state, QualityFlags&) noexcept override {
    chain_->lams_air(state, chain_->parameters().data());
  }

 private:
  std::shared_ptr<const Chain> chain_;
};

}  // namespace pcor
