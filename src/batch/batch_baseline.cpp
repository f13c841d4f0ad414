#include "batch/batch_kernel.hpp"
#include "batch/pack.hpp"

namespace pcor::internal {

void run_batch(const BatchJob& job) { run_batch_in<Pack<xsimd::default_arch>>(job); }

}  // namespace pcor::internal
