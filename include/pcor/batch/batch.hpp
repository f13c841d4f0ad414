#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <string>
#include <vector>

#include <pcor/realtime/stages.hpp>

namespace pcor {

/// The chain over whole arrays at once, in vector registers: what the sample loop computes, for comparisons
/// and fits over whole flights.
///
/// The same formulas as in the loop, within 1e-13 of its values (1e-7 for delta-p from LAMS by approach 2,
/// which iterates to that). There are no quality bits: what cannot be
/// found is NaN. Nothing is remembered from one sample to the next, so a model with rates of change needs
/// them as arrays: `static_pressure_rate`, `dynamic_pressure_rate`, and
/// `airspeed_rate` for the clock of the laser, and `wetness` for the thermometer in cloud.
class Batch {
 public:
  /// The values of a recorded quantity, in its unit, one for each sample.
  struct Input {
    Quantity quantity = Quantity::count;
    const double* values = nullptr;
  };

  /// Where to put the values of a quantity, one for each sample.
  struct Output {
    Quantity quantity = Quantity::count;
    double* values = nullptr;
  };

  /// Prepares `model` for samples in which the quantities `recorded` are known.
  /// @throws Error if the model cannot be used on them.
  Batch(const Model& model, const std::vector<Quantity>& recorded, CorrectWith with = CorrectWith::model);

  const Chain& chain() const { return chain_; }

  /// True where `run` can give the quantity: it is recorded, or a stage of the chain writes it.
  bool finds(Quantity quantity) const;

  /// Runs the chain over `samples` samples. Every recorded quantity of the chain (`Chain::inputs`) has to be
  /// among the inputs; outputs are any that it finds, and only the stages that they need are run. An output
  /// may not overlap an input or another output. `parameters` takes the place of the model's coefficients, in
  /// the order of `Chain::parameters`. May be called by several threads at once.
  /// @throws Error if an input is missing, or an output is not found.
  void run(const std::vector<Input>& inputs, const std::vector<Output>& outputs, std::size_t samples,
           const double* parameters = nullptr) const;

 private:
  struct StageInfo {
    std::bitset<state_capacity> reads;
    std::bitset<state_capacity> writes;
  };

  std::string to_string(Quantity quantity) const;

  Chain chain_;
  CorrectWith with_;
  std::bitset<state_capacity> recorded_;
  std::array<StageInfo, Stages::count> stages_;
};

}  // namespace pcor
