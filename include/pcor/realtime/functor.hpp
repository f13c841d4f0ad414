#pragma once

#include <utility>
#include <vector>

#include <pcor/model/quality.hpp>
#include <pcor/model/state.hpp>

namespace pcor {

/// Derived variable, or several computed together, once for every sample from others.
///
/// A functor declares its inputs and outputs; the loop orders functors by them. A quantity that is both is
/// modified in place, before other functors read it. `compute` must not allocate or throw; for missing or
/// impossible inputs it writes NaN and sets a quality bit.
class Functor {
 public:
  Functor(std::vector<Quantity> inputs, std::vector<Quantity> outputs)
      : inputs_(std::move(inputs)), outputs_(std::move(outputs)) {}
  Functor(const Functor&) = delete;
  Functor& operator=(const Functor&) = delete;
  virtual ~Functor() = default;

  const std::vector<Quantity>& inputs() const { return inputs_; }
  const std::vector<Quantity>& outputs() const { return outputs_; }

  /// Clears the state from earlier samples. Called at the start and after every gap.
  virtual void reset() noexcept {}

  /// Computes the outputs of one sample.
  virtual void compute(State<double>& state, QualityFlags& flags) noexcept = 0;

 private:
  std::vector<Quantity> inputs_;
  std::vector<Quantity> outputs_;
};

}  // namespace pcor
