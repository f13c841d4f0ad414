// Compiled for AVX-512 with the extensions that most processors with it have, and run only where the
// processor has them. As in batch_avx2.cpp, nothing but the kernel belongs here.
#include "batch/batch_kernel.hpp"

#if defined(__AVX512F__) && defined(__AVX512CD__) && defined(__AVX512DQ__) && defined(__AVX512BW__)
// The headers of g++ 12 warn of what they leave undefined on purpose (GCC bug 105593).
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
