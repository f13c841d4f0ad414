#pragma once

#include <dlfcn.h>

namespace pcor::test {

/// The function `name` of a shared library that a function of the test, `this_one`, replaces, so that the
/// tested code meets a failing library.
template <class Function>
Function* of_library(Function* /*this_one*/, const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace pcor::test
