// CMake requires a source file in addition to the headers.
