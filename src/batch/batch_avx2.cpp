// Compiled for AVX2 and FMA, and run only where the processor has them. Nothing but the kernel belongs here:
// other inline functions of this file could be chosen by the linker for the whole program.
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
