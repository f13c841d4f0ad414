# The warnings under which every file of the project compiles.
add_library(pcor_warnings INTERFACE)
target_compile_options(pcor_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor -Wold-style-cast
  $<$<BOOL:${PCOR_WARNINGS_AS_ERRORS}>:-Werror>)
