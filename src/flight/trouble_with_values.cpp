#include "flight/trouble_with_values.hpp"

#include <pcor/base/error.hpp>

namespace pcor::internal {

std::string value_problem(const Flight& flight, const std::string& variable) {
  try {
    flight.require_values(variable);
  } catch (const Error& error) {
    if (error.code() == Error::Code::file) throw;
    return error.what();
  }
  return "";
}

}  // namespace pcor::internal
