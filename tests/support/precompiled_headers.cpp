// Source file that CMake requires in addition to the headers.
