#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <string>
#include <vector>

#include <pcor/realtime/stages.hpp>

namespace pcor {

/// Vectorised chain over whole arrays: the computation of the sample loop, for comparisons and fits over
/// whole flights.
///
/// Formulas are those of the loop; results agree within 1e-13 (1e-7 for delta-p from LAMS by approach 2, the
/// tolerance of its iteration). There are no quality bits: undefined results are NaN. Samples are
/// independent, so a model with rates of change needs them as arrays: the `rates` that it reads,
/// `airspeed_rate` for the clock of the laser, and `wetness` for the thermometer in cloud.
class Batch {
 public:
  /// Values of a recorded quantity, in its unit, one for each sample.
  struct Input {
    Quantity quantity = Quantity::count;
    const double* values = nullptr;
  };

  /// Destination of the values of a quantity, one for each sample.
  struct Output {
    Quantity quantity = Quantity::count;
    double* values = nullptr;
  };

  /// Destination of the derivatives of the static defect with respect to a coefficient, hPa per its unit, one
  /// for each sample.
  struct Derivative {
    std::size_t effect = 0;     ///< index of the effect in the model
    std::size_t parameter = 0;  ///< index of the coefficient in the effect; the effects at the static ports
                                ///< must be linear in it (`Chain::is_static_sum_linear`)
    double* values = nullptr;
  };

  /// Prepares `model` for samples in which the quantities `recorded` are known.
  /// @throws Error if the model cannot be used on them.
  Batch(const Model& model, const std::vector<Quantity>& recorded, CorrectWith with = CorrectWith::model);

  const Chain& chain() const { return chain_; }

  /// True if `run` can compute the quantity: it is recorded, or a stage of the chain writes it.
  bool finds(Quantity quantity) const;

  /// Runs the chain over `samples` samples. Every recorded quantity of the chain (`Chain::inputs`) must be
  /// among the inputs; only the stages needed by the outputs are run. An output must not overlap an input or
  /// another output. `parameters` replaces the model's coefficients, in the order of `Chain::parameters`. May
  /// be called by several threads concurrently.
  /// @throws Error if an input is missing, or an output is not found.
  void run(const std::vector<Input>& inputs, const std::vector<Output>& outputs, std::size_t samples,
           const double* parameters = nullptr) const {
    compute(inputs, outputs, {}, samples, parameters);
  }

  /// Derivatives of delta-p of the model, hPa per unit of the coefficient, with respect to coefficients in
  /// which the effects at the static ports are linear, at the coefficients `parameters`. They include the
  /// taper, and are exact; zero where delta-p is raised to its minimum; NaN where delta-p is. Inputs as for
  /// `run`; `values` must not overlap an input or those of another derivative. May be called by several
  /// threads concurrently.
  /// @throws Error if an input is missing, or if the effects are not linear in a coefficient or have no such
  /// coefficient.
  void differentiate(const std::vector<Input>& inputs, const std::vector<Derivative>& derivatives,
                     std::size_t samples, const double* parameters = nullptr) const {
    compute(inputs, {}, derivatives, samples, parameters);
  }

 private:
  struct StageInfo {
    std::bitset<state_capacity> reads;
    std::bitset<state_capacity> writes;
  };

  std::string to_string(Quantity quantity) const;
  void compute(const std::vector<Input>& inputs, const std::vector<Output>& outputs,
               const std::vector<Derivative>& derivatives, std::size_t samples,
               const double* parameters) const;

  Chain chain_;
  CorrectWith with_;
  std::bitset<state_capacity> recorded_;
  std::array<StageInfo, Stages::count> stages_;
};

}  // namespace pcor
