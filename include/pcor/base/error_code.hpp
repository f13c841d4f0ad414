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
    case Error::Code::model:
      return "model";
    case Error::Code::output:
      return "output";
    case Error::Code::other:
      break;
  }
  return "other";
}

}  // namespace pcor
