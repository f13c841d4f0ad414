#!/bin/sh
# The kernel for AVX2 shares no code with the rest of the program: a function that its object offers for sharing
# could be chosen by the linker for all, and run on a processor without AVX2.
#
#   batch_kernel_symbols.sh LIBRARY.a
set -eu
object=$(mktemp)
trap 'rm -f "$object"' EXIT
ar p "$1" batch_avx2.cpp.o > "$object"
# W: weak functions. Those of the kernel's own register type exist nowhere else.
if nm -C "$object" | grep ' W ' | grep -v 'xsimd::fma3<xsimd::avx2>'; then
  echo "the object of the AVX2 kernel offers the functions above to the whole program"
  exit 1
fi
