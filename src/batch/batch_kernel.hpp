#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <pcor/batch/batch.hpp>
#include <pcor/realtime/stages.hpp>

namespace pcor::internal {

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
  }
}

}  // namespace pcor::internal
