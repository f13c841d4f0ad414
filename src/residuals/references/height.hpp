#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/physics/constants.hpp>
#include <pcor/physics/geodesy.hpp>
#include <pcor/physics/hydrostatic.hpp>
#include <pcor/physics/moist_air.hpp>
#include "residuals/references/windowed.hpp"
#include "roles/jumps.hpp"
#include "roles/pressure_height.hpp"
#include "roles/recorded_series.hpp"

namespace pcor::internal {

/// Climb duration between the compared heights, s: long enough that the climb is much larger than the noise
/// of GPS, and short enough that the slope of the isobars is negligible.
inline constexpr double height_window = 60.0;

/// Residual of sample i, with a and b half a window before and after it:
///
///     r_i = p_i g0/(R T)_i [ sum_a^b dH - (H_b - H_a) ],   dH = hydrostatic_step times the mean temperature
///
/// with the geopotential heights H of GPS: if the step of the model is too large, its pressure has fallen too
/// far. In hPa. The factor before the brackets, which converts the unit, uses the model file: if it changed
/// with the coefficients, a derivative would contain the residual, and so its noise.
class HeightOnSamples final : public WindowedResidual<HeightOnSamples, 3> {
 public:
  HeightOnSamples(const FlightSamples& samples, const ModelOnSamples& model)
      : WindowedResidual(model, samples, height_window),
        height_(*samples.reference.find(Quantity::altitude)),
        time_(samples.time),
        step_(samples.step) {
    const double* const parameters = model.parameters().data();
    for (std::size_t i = 0; i < time_.size(); ++i) {
      const auto [pressure, temperature, gas_constant] = parts_of(i, parameters);
      pressure_of_height_.push_back(pressure * constants::standard_gravity / (gas_constant * temperature));
    }
  }

  /// Static pressure, hPa; temperature, K; gas constant, J kg^-1 K^-1.
  template <class S>
  Parts<S> parts_of(std::size_t sample, const S* parameters) const {
    State<S> state;
    law().air(sample, parameters, state);
    return {state[Quantity::corrected_static_pressure], state[Quantity::ambient_temperature],
            moist_air(state[Quantity::humidity]).gas_constant};
  }

  template <class S>
  void find(const IndexRange span, const std::vector<Parts<S>>& parts,
            const std::vector<std::size_t>& samples, S* out) const {
    std::vector<S> risen(span.length(), S(0.0));  // height change, m, since the first sample
    std::vector<std::size_t> missing_steps(span.length(), 0);
    for (std::size_t k = 1; k < span.length(); ++k) {
      const auto& [pressure, temperature, gas_constant] = parts[k];
      const S rise = S(0.5) * (parts[k - 1][1] + temperature) *
                     hydrostatic_step(parts[k - 1][0], pressure, gas_constant);
      const double since_last = time_[span.first + k] - time_[span.first + k - 1];
      const bool known = is_finite(rise) && since_last < 1.5 * step_;
      risen[k] = known ? S(risen[k - 1] + rise) : risen[k - 1];
      missing_steps[k] = missing_steps[k - 1] + (known ? 0 : 1);
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
      out[i] = missing<S>();
      if (samples[i] < span.first + half_width() || samples[i] + half_width() >= span.end) continue;
      const std::size_t from = samples[i] - span.first - half_width();
      const std::size_t to = from + 2 * half_width();
      if (missing_steps[from] != missing_steps[to]) continue;
      const double climbed = height_[span.first + to] - height_[span.first + from];
      out[i] = S(pressure_of_height_[samples[i]]) * (risen[to] - risen[from] - S(climbed));
    }
  }

  std::vector<Batch::Input> columns() const override { return {{Quantity::altitude, height_.data()}}; }

 private:
  const std::vector<double>& height_;  // geopotential height, m
  const std::vector<double>& time_;
  double step_;
  std::vector<double> pressure_of_height_{};  // hPa/m
};

class HeightReference final : public WindowedReference<HeightOnSamples> {
 public:
  using WindowedReference::WindowedReference;

  std::string description() const override { return "hydrostatic height against GPS height"; }
  std::string name() const override { return "height"; }
  double window() const override { return height_window; }

  ModelSamples read(const Flight& flight, const std::vector<double>& time, Notes& notes) const override {
    RecordedSeries height = read_role(flight, file(), Quantity::altitude);
    const RecordedSeries latitude = read_role(flight, file(), Quantity::latitude);
    if (height.values.empty() || latitude.values.empty()) {
      throw Error(Error::Code::variable,
                  flight.path().string() +
                      ": no GPS height and latitude with units (GGALT, GGLAT and the like), which the "
                      "reference height requires; name them in the table [variables] of the model, or use "
                      "another reference, for example --reference static:OTHER.toml");
    }
    const HeightEvidence evidence =
        height_evidence(flight, height.values, static_pressures_of(flight, file()));
    if (evidence.kind == HeightEvidence::Kind::pressure_altitude) {
      throw Error(Error::Code::variable,
                  fmt::format("{}: {} is a pressure altitude, not a GPS height: {}; a fit to it would be "
                              "circular; name a GPS height as altitude in the table [variables] of the "
                              "model, or use another reference",
                              flight.path().string(), height.variable, to_string(evidence)));
    }
    if (const std::string problem = evidence.slope_problem(height.variable); !problem.empty())
      throw Error(Error::Code::unit, flight.path().string() + ": " + problem);
    const std::vector<Jump> jumps = find_jumps(height.values, time);
    for (const Jump& jump : jumps)
      notes.push_back(format_jump(height.variable, jump, time) + ", which are excluded");
    mask(jumps, height.values);
    for (std::size_t i = 0; i < height.values.size(); ++i)
      height.values[i] = geopotential_height(latitude.values[i], height.values[i]);
    ModelSamples samples;
    samples.columns = {{Quantity::altitude, std::move(height.values)}};
    samples.variables = {{Quantity::altitude, height.variable}};
    return samples;
  }
};

}  // namespace pcor::internal
