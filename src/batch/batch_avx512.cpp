// Compiled for AVX-512 with the extensions that every processor for servers and desktops has beside it, and run
// only where the processor has them. As in batch_avx2.cpp, nothing but the kernel belongs here.
#include "batch/batch_kernel.hpp"

#if defined(__AVX512F__) && defined(__AVX512CD__) && defined(__AVX512DQ__) && defined(__AVX512BW__)
#include "batch/pack.hpp"

namespace pcor::internal {
const BatchKernel run_batch_avx512 = &run_batch_in<Pack<xsimd::avx512bw>>;
}  // namespace pcor::internal

#else

namespace pcor::internal {
const BatchKernel run_batch_avx512 = nullptr;
}  // namespace pcor::internal

#endif
