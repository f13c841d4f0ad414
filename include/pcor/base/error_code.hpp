#pragma once

#include <string_view>

#include <pcor/base/error.hpp>

namespace pcor {

/// The name of the code, such as "file".
constexpr std::string_view to_string(Error::Code code) {
  switch (code) {
    case Error::Code::file:
      return "file";
    case Error::Code::variable:
      return "variable";
    case Error::Code::unit:
      return "unit";
    case Error::Code::time:
      return "time";
    case Error::Code::samples:
      return "samples";
    case Error::Code::definition:
      return "definition";
    case Error::Code::model:
      return "model";
    case Error::Code::fit:
      return "fit";
    case Error::Code::usage:
      return "usage";
    case Error::Code::output:
      return "output";
    case Error::Code::system:
      break;
  }
  return "system";
}

}  // namespace pcor
