#pragma once

#include <algorithm>
#include <cstddef>

#include <pcor/batch/batch.hpp>
#include <pcor/realtime/chain.hpp>

namespace pcor::internal {

/// What a kernel does: plain pointers, because its code may be compiled for another processor than the rest.
struct BatchJob {
  const Chain* chain = nullptr;
  const double* parameters = nullptr;
  bool finds_lams = false;  ///< delta-p from LAMS is asked for or corrects
  bool corrects_with_lams = false;
  bool finds_air = false;  ///< something after the corrected pressures is asked for
  const Batch::Input* inputs = nullptr;
  std::size_t input_count = 0;
  const Batch::Output* outputs = nullptr;
  std::size_t output_count = 0;
  std::size_t samples = 0;
};

using BatchKernel = void (*)(const BatchJob&);

/// The kernel for every processor, and that for x86 with AVX2 and FMA; null where the compiler has none.
void run_batch(const BatchJob& job);
extern const BatchKernel run_batch_avx2;

/// The chain over all samples of a job, `Pack::size` at a time.
template <class Pack>
void run_batch_in(const BatchJob& job) {
  const Chain& chain = *job.chain;
  NoQualityFlags flags;
  State<Pack> state;
  for (std::size_t at = 0; at < job.samples; at += Pack::size) {
    const std::size_t count = std::min(Pack::size, job.samples - at);
    for (std::size_t i = 0; i < job.input_count; ++i) {
      state[job.inputs[i].quantity] = Pack::load(job.inputs[i].values + at, count);
    }
    chain.measure(state, job.parameters, flags);
    Pack defect = chain.static_defect(state, job.parameters, flags);
    state[Quantity::static_defect] = defect;
    if (job.finds_lams) {
      const Pack lams = chain.lams_static_defect(state, job.parameters, flags);
      state[Quantity::lams_static_defect] = lams;
      if (job.corrects_with_lams) defect = select(is_missing(lams), defect, lams);
    }
    chain.correct(state, defect, flags);
    if (job.finds_air) {
      chain.air(state, job.parameters, flags);
      if (chain.has_lams()) chain.lams_air(state, job.parameters);
    }
    for (std::size_t i = 0; i < job.output_count; ++i) {
      state[job.outputs[i].quantity].store(job.outputs[i].values + at, count);
    }
  }
}

}  // namespace pcor::internal
