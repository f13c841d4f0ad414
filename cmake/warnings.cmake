# Compiler warnings of all targets. Clang runs without -Wshadow, which reports names of other files in a unity build.
add_library(pcor_warnings INTERFACE)
target_compile_options(pcor_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion $<IF:$<CXX_COMPILER_ID:Clang>,-Wno-overlength-strings,-Wshadow>
  -Wnon-virtual-dtor -Wold-style-cast $<$<BOOL:${PCOR_WARNINGS_AS_ERRORS}>:-Werror>)
