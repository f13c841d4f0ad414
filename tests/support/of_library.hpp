#pragma once

#include <dlfcn.h>

namespace pcor::test {

/// Function `name` of a shared library that a function of the test replaces to simulate a failing library.
/// The first argument, the replacement, determines the type.
template <class Function>
Function* of_library(Function* /*replacement*/, const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace pcor::test
