#pragma once

#include <string>

#include <pcor/base/error.hpp>
#include <pcor/flight/flight.hpp>

namespace pcor::internal {

/// Reason why an existing variable is not a time series with values; empty if it is. @throws Error if the
/// file is damaged
inline std::string value_problem(const Flight& flight, const std::string& variable) {
  try {
    flight.require_values(variable);
  } catch (const Error& error) {
    if (error.code() == Error::Code::file) throw;
    return error.what();
  }
  return "";
}

}  // namespace pcor::internal
