#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <pcor/batch/batch.hpp>
#include <pcor/realtime/stages.hpp>

namespace pcor::internal {

/// Derivative of the static defect with respect to a coefficient in which it is linear.
struct BatchDerivative : Batch::Derivative {
  const double* coefficients = nullptr;  ///< `BoundModel::unit_coefficients`; null for a surface
};

/// Arguments of a kernel: plain pointers, because its code may be compiled for another processor than the
/// rest.
struct BatchJob {
  const Chain* chain = nullptr;
  CorrectWith with = CorrectWith::model;
  const double* parameters = nullptr;
  std::array<bool, Stages::count> runs{};  ///< stages required by the outputs
  const Batch::Input* inputs = nullptr;
  std::size_t input_count = 0;
  const Batch::Output* outputs = nullptr;
  std::size_t output_count = 0;
  const BatchDerivative* derivatives = nullptr;
  std::size_t derivative_count = 0;
  std::size_t samples = 0;
};

using BatchKernel = void (*)(const BatchJob&);

/// Kernel for every processor, and those for x86 with AVX2 and FMA, and with AVX-512 and its extensions CD,
/// DQ and BW; nullptr if not supported by the compiler.
void run_batch(const BatchJob& job);
extern const BatchKernel run_batch_avx2;
extern const BatchKernel run_batch_avx512;

/// The kernels that this processor can run, the fastest first.
std::vector<BatchKernel> batch_kernels();

/// Stores the derivatives of `count` samples, from the state after the static defect.
template <class Pack>
void store_derivatives(const BatchJob& job, const State<Pack>& state, std::size_t at, std::size_t count) {
  const Chain& chain = *job.chain;
  Pack factor =
      select(is_missing(state[Quantity::static_defect]), missing<Pack>(), chain.taper_fraction(state));
  if (chain.has_minimum())
    factor = select(chain.is_at_minimum(state, job.parameters), Pack(0.0) * factor, factor);
  const Surface* last_surface = nullptr;
  std::array<Pack, SurfaceAxis::max_count> by_x;
  std::array<Pack, SurfaceAxis::max_count> by_y;
  for (std::size_t i = 0; i < job.derivative_count; ++i) {
    const BatchDerivative& each = job.derivatives[i];
    const Surface* const surface = chain.surface_of(each.effect);
    if (surface != nullptr && surface != last_surface) {
      by_x = Surface::splines(surface->axes[0], state[surface->axes[0].quantity]);
      by_y = Surface::splines(surface->axes[1], state[surface->axes[1].quantity]);
      last_surface = surface;
    }
    const Pack value = surface != nullptr ? by_x[each.parameter / surface->axes[1].count] *
                                                by_y[each.parameter % surface->axes[1].count] *
                                                state[Quantity::dynamic_pressure]
                                          : chain.effect_value(each.effect, state, each.coefficients);
    // Where the factor is zero, the derivative is zero even if an input of the effect is missing.
    select(factor == Pack(0.0), Pack(0.0), factor * value).store(each.values + at, count);
  }
}

/// The chain over all samples of a job, `Pack::size` at a time.
template <class Pack>
void run_batch_in(const BatchJob& job) {
  const Correction correction{*job.chain, job.with};
  NoQualityFlags flags;
  State<Pack> state;
  for (std::size_t at = 0; at < job.samples; at += Pack::size) {
    const std::size_t count = std::min(Pack::size, job.samples - at);
    for (std::size_t i = 0; i < job.input_count; ++i) {
      state[job.inputs[i].quantity] = Pack::load(job.inputs[i].values + at, count);
    }
    std::size_t number = 0;
    Stages::each([&](auto stage) {
      if (job.runs[number++]) stage.compute(correction, state, job.parameters, flags);
    });
    for (std::size_t i = 0; i < job.output_count; ++i) {
      state[job.outputs[i].quantity].store(job.outputs[i].values + at, count);
    }
    if (job.derivative_count > 0) store_derivatives(job, state, at, count);
  }
}

}  // namespace pcor::internal
