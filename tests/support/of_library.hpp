#pragma once

#include <dlfcn.h>

namespace pcor::test {

/// The function of that name in a shared library before which one of the test itself stands, `this_one`: so
/// that what is tested meets a library that fails.
template <class Function>
Function* of_library(Function* /*this_one*/, const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace pcor::test
