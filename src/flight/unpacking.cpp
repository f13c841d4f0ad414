#include "flight/unpacking.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/base/shell_quote.hpp>

namespace pcor::internal {
namespace {

/// Scale factor or offset of packed values. @throws Error if the attribute exists and is not a number.
double packing_number(const FlightFile& file, int variable, const char* attribute, double otherwise) {
  const std::string text = file.text_attribute(variable, attribute);
  if (text.empty()) return otherwise;
  const std::vector<double> numbers = file.number_attribute(variable, attribute);
  const bool is_number = numbers.size() == 1 && std::isfinite(numbers.front());
  if (is_number && (numbers.front() != 0 || otherwise == 0)) return numbers.front();
  throw Error(
      Error::Code::variable,
      fmt::format("{}: the attribute {} of {} is \"{}\", which is not valid for packed values; correct it "
                  "with ncatted -a {} {}",
                  file.path().string(), attribute, file.variable_name(variable), text,
                  shell_quote(fmt::format("{},{},o,d,NUMBER", attribute, file.variable_name(variable))),
                  shell_path(file.path().string())));
}

}  // namespace

UnitConversion unpacking_of(const FlightFile& file, int variable) {
  return {packing_number(file, variable, "scale_factor", 1), packing_number(file, variable, "add_offset", 0)};
}

}  // namespace pcor::internal
