#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/residuals/reference.hpp>
#include "residuals/masks.hpp"
#include "residuals/reference_on_samples.hpp"

namespace pcor::internal {

/// Laser on the samples of a flight: it implies a delta-p for the pressures of the model (memo eq. 11). Its
/// noise is added to the speed along the beam.
class LamsOnSamples final : public ReferenceOnSamples {
 public:
  LamsOnSamples(const FlightSamples& samples, const ModelOnSamples& model)
      : beam_(*samples.model.find(Quantity::lams_airspeed)), model_(model), samples_(samples.model) {}

  void residuals(const Block& block, const double* parameters, double* out) const override {
    std::vector<double> defect(block.samples.size());
    model_.batch().run(block.model,
                       {{Quantity::static_defect, defect.data()}, {Quantity::lams_static_defect, out}},
                       defect.size(), parameters);
    for (std::size_t i = 0; i < defect.size(); ++i) out[i] -= defect[i];
  }

  void residuals(const std::vector<std::size_t>& samples, const Jet* parameters, Jet* out) const override {
    for (const std::size_t sample : samples) *out++ = residual_at(sample, Jet(beam_[sample]), parameters);
  }

  const LamsOnSamples* laser() const override { return this; }

  Mask why_missing(std::size_t sample) const override {
    // The chain of the laser has more inputs than the model: a missing input of the model is reported for the
    // model, others for the reference.
    if (!model_.is_missing_any(sample)) return Mask::impossible;
    State<double> state;
    model_.corrected_static_pressure(sample, model_.parameters().data(), state);
    return std::isnan(state[Quantity::static_defect]) ? Mask::missing : Mask::reference;
  }

  void mark_implausible(std::vector<Mask>& masks, const std::vector<double>& airspeed) const override {
    if (airspeed.empty()) return;
    const std::vector<double>& p = *samples_.find(Quantity::static_pressure);
    std::vector<double> ratio = *samples_.find(Quantity::dynamic_pressure);
    for (std::size_t i = 0; i < ratio.size(); ++i) ratio[i] /= p[i];
    for (const std::size_t sample : find_unlocked(beam_, airspeed, ratio, used_samples(masks)))
      masks[sample] = Mask::laser_unlocked;
  }

  /// Noise-free speed along the beam, m/s, predicted from pressures and temperature. @param more is added to
  /// delta-p, hPa
  template <class S>
  S predicted_at(std::size_t sample, const S* parameters, const S& more = S(0.0)) const {
    State<S> state;
    NoQualityFlags flags;
    const Chain& chain = model_.chain();
    model_.corrected_static_pressure(sample, parameters, state);
    state[Quantity::static_defect] = state[Quantity::static_defect] + more;
    chain.correct(state, state[Quantity::static_defect], flags);
    // Cosine of the beam, without effects on its speed.
    const S along = state[Quantity::lams_airspeed] / chain.lams_airspeed(state, parameters);
    chain.air(state, parameters, flags);
    return along * state[Quantity::corrected_airspeed];
  }

  /// Derivative of the residual with respect to the speed along the beam, hPa per m/s, at the prediction with
  /// the files' parameters, for every sample.
  const std::vector<double>& sensitivity() const {
    std::call_once(is_found_, [this] {
      // From columns at a distant delay the speed would be extrapolated.
      const std::vector<double> parameters = model_.parameters_of_columns();
      const std::vector<Jet> constant(parameters.begin(), parameters.end());
      std::vector<double> found;
      for (std::size_t i = 0; i < beam_.size(); ++i) {
        const Jet beam(predicted_at(i, parameters.data()), 0);
        found.push_back(residual_at(i, beam, constant.data()).v[0]);
      }
      sensitivity_ = std::move(found);
    });
    return sensitivity_;
  }

 private:
  Jet residual_at(std::size_t sample, const Jet& beam, const Jet* parameters) const {
    State<Jet> state;
    NoQualityFlags flags;
    model_.corrected_static_pressure(sample, parameters, state);
    state[Quantity::lams_airspeed] = beam;
    return model_.chain().lams_static_defect(state, parameters, flags) - state[Quantity::static_defect];
  }

  const std::vector<double>& beam_;
  const ModelOnSamples& model_;
  const ModelSamples& samples_;
  mutable std::once_flag is_found_;
  mutable std::vector<double> sensitivity_;  // computed on first use
};

class LamsReference final : public Reference {
 public:
  std::string description() const override { return "LAMS"; }
  std::string name() const override { return "lams"; }
  bool reads_laser() const override { return true; }

  std::unique_ptr<ReferenceOnSamples> on(const FlightSamples& samples,
                                         const ModelOnSamples& model) const override {
    if (samples.model.find(Quantity::lams_airspeed) == nullptr)
      throw Error(Error::Code::model, "the model has no lams_airspeed, which the reference lams requires");
    return std::make_unique<LamsOnSamples>(samples, model);
  }
};

}  // namespace pcor::internal
