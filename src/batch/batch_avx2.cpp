// Compiled for AVX2 and FMA, and run only on processors that have them. This file must contain only the
// kernel: the linker could choose its other inline functions for the whole program.
#include "batch/batch_kernel.hpp"

#if defined(__AVX2__) && defined(__FMA__)
#include "batch/pack.hpp"

namespace pcor::internal {
const BatchKernel run_batch_avx2 = &run_batch_in<Pack<xsimd::fma3<xsimd::avx2>>>;
}  // namespace pcor::internal

#else

namespace pcor::internal {
const BatchKernel run_batch_avx2 = nullptr;
}  // namespace pcor::internal

#endif
