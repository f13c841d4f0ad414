#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <pcor/flight/flight.hpp>

namespace pcor::test {

/// All values of a variable at its rate, in `unit` (default: the unit of the file).
inline std::vector<double> values_of(const Flight& flight, const std::string& name,
                                     const std::string& unit = "") {
  std::vector<double> values(flight.records() * static_cast<std::size_t>(flight.variable(name).rate));
  const UnitConversion conversion = unit.empty() ? UnitConversion() : flight.conversion(name, unit);
  flight.read(name, {0, flight.records()}, conversion, values.data());
  return values;
}

}  // namespace pcor::test
