#pragma once

#include <cstddef>
#include <vector>

#include <pcor/batch/batch.hpp>
#include <pcor/residuals/samples.hpp>

namespace pcor {

namespace internal {

/// Columns at some indices, gathered one after another into `store`.
std::vector<Batch::Input> gathered(const std::vector<Batch::Input>& columns,
                                   const std::vector<std::size_t>& samples, std::vector<double>& store);

}  // namespace internal

/// Model on the samples of a flight, as inputs of its chain.
class ModelOnSamples {
 public:
  /// Only the roles named by the model are used: a diagnosis reads more of a flight.
  /// @throws Error if the model cannot be used on the samples.
  ModelOnSamples(const ModelDefinition& file, const ModelSamples& samples);

  const Batch& batch() const { return batch_; }
  const Chain& chain() const { return batch_.chain(); }
  const std::vector<Batch::Input>& columns() const { return columns_; }
  const Model& model() const { return model_; }

  /// Columns at some indices, gathered one after another into `store`.
  std::vector<Batch::Input> gathered(const std::vector<std::size_t>& samples, const double* parameters,
                                     std::vector<double>& store) const;

  /// Parameters of the file.
  const std::vector<double>& parameters() const { return chain().parameters(); }

  /// True for each parameter in which the sum of the effects at the static ports is exactly linear, and which
  /// changes no other result (`Chain::is_static_sum_linear`): `derivative_by` has its derivatives. Delta-p is
  /// linear in it if it has no minimum.
  std::vector<bool> linear_terms() const;

  /// Evaluates the chain for one sample up to delta-p of the model.
  template <class S>
  S corrected_static_pressure(std::size_t sample, const S* parameters, State<S>& state) const {
    NoQualityFlags flags;
    read(sample, parameters, state);
    chain().correct_inputs(state, parameters, flags);
    state[Quantity::static_defect] = chain().static_defect(state, parameters, flags);
    return state[Quantity::port_static_pressure] + state[Quantity::static_defect];
  }

  /// Evaluates the whole chain for one sample: corrected pressures, temperature, humidity and airspeed.
  template <class S>
  void air(std::size_t sample, const S* parameters, State<S>& state) const {
    NoQualityFlags flags;
    corrected_static_pressure(sample, parameters, state);
    chain().correct(state, state[Quantity::static_defect], flags);
    chain().air(state, parameters, flags);
  }

  /// Airspeed of one sample along the beam, m/s, as `Chain::airspeed_along_beam`; the rate of this airspeed,
  /// if the model reads it, is set to zero, since it depends on the result.
  double airspeed_along_beam(std::size_t sample, const double* parameters) const {
    State<double> state;
    read(sample, parameters, state);
    state[Quantity::airspeed_rate] = 0.0;
    return chain().airspeed_along_beam(state, parameters);
  }

  /// Total pressure of one sample at the ports, hPa: static plus dynamic, in which delta-p cancels.
  template <class S>
  S total_pressure(std::size_t sample, const S* parameters) const {
    State<S> state;
    NoQualityFlags flags;
    read(sample, parameters, state);
    chain().correct_inputs(state, parameters, flags);
    return state[Quantity::port_static_pressure] + state[Quantity::port_dynamic_pressure];
  }

  /// Static pressure of a block at the ports plus another quantity, hPa: with `static_defect` the corrected
  /// static pressure, with `port_dynamic_pressure` the total pressure.
  void port_pressure_plus(Quantity added, const std::vector<Batch::Input>& inputs, std::size_t count,
                          const double* parameters, double* out) const;

  /// Destination of the derivatives of delta-p with respect to a parameter of `linear_terms()`.
  Batch::Derivative derivative_by(std::size_t parameter, double* values) const;

  /// True if the columns that depend on coefficients were computed at these parameters.
  bool matches_parameters(const double* parameters) const;

  /// Parameters of the file; those on which columns depend have the values of the columns.
  std::vector<double> parameters_of_columns() const;

  bool is_missing_needed(std::size_t sample) const;
  bool is_missing_any(std::size_t sample) const;

 private:
  /// Column that depends on a coefficient, and the index of the coefficient among the parameters.
  struct ParameterDependence {
    const ParameterDependentColumn* column;
    std::size_t parameter;
  };

  template <class S>
  void read(std::size_t sample, const S* parameters, State<S>& state) const {
    for (const Batch::Input& column : columns_) state[column.quantity] = S(column.values[sample]);
    for (const ParameterDependence& each : dependences_) {
      state[each.column->quantity] +=
          S(each.column->slope[sample]) * (parameters[each.parameter] - S(each.column->at));
    }
  }

  Model model_;
  Batch batch_;
  std::vector<Batch::Input> columns_;
  std::vector<ParameterDependence> dependences_;
};

}  // namespace pcor
