#!/bin/sh
# The kernels for wider registers share no code with the rest of the program: a function that an object of theirs
# offers for sharing could be chosen by the linker for all, and run on a processor without such registers.
#
#   kernel_symbols.sh LIBRARY.a
set -eu
object=$(mktemp)
names=$(mktemp)
trap 'rm -f "$object" "$names"' EXIT
check() {
  ar p "$1" "batch_$2.cpp.o" > "$object"
  nm -C "$object" > "$names"
  grep -q "xsimd::$3" "$names" || { echo "there is no kernel $2"; exit 1; }
  # W: weak functions. Only functions of the kernel's register type are unique to this kernel.
  if grep ' W ' "$names" | grep -v "xsimd::$3"; then
    echo "the object of the kernel $2 offers the functions above to the whole program"
    exit 1
  fi
}
check "$1" avx2 'fma3<xsimd::avx2>'
check "$1" avx512 'avx512bw'
