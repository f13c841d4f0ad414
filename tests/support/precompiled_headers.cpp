// What CMake asks for beside the headers themselves.
