// Compiled for AVX-512 with the extensions of most processors that have it, and run only on these. As in
// batch_avx2.cpp, this file must contain only the kernel.
#include "batch/batch_kernel.hpp"

#if defined(__AVX512F__) && defined(__AVX512CD__) && defined(__AVX512DQ__) && defined(__AVX512BW__)
// Headers of g++ 12 cause warnings on deliberately undefined values (GCC bug 105593).
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include "batch/pack.hpp"

namespace pcor::internal {
const BatchKernel run_batch_avx512 = &run_batch_in<Pack<xsimd::avx512bw>>;
}  // namespace pcor::internal

#else

namespace pcor::internal {
const BatchKernel run_batch_avx512 = nullptr;
}  // namespace pcor::internal

#endif
