#include "checks/verdict.hpp"

#include <fmt/format.h>

#include <cmath>

namespace pcor::internal {

CheckVerdict judge(const Estimated& number, double size) {
  constexpr double significant = 3.0;  // standard errors
  constexpr double likely = 2.0;
  const double magnitude = std::abs(number.value);
  if (magnitude > size && magnitude > significant * number.error) return CheckVerdict::inconsistent;
  if (magnitude + likely * number.error <= size) return CheckVerdict::consistent;
  return CheckVerdict::cannot_tell;
}

CheckVerdict together(CheckVerdict a, CheckVerdict b) {
  for (const CheckVerdict worst : {CheckVerdict::inconsistent, CheckVerdict::cannot_tell}) {
    if (a == worst || b == worst) return worst;
  }
  return CheckVerdict::consistent;
}

std::string with_error(const Estimated& number, const std::string& unit, int digits) {
  return fmt::format("{:+.{}f} +- {:.{}f}{}{}", number.value, digits, number.error, digits,
                     unit.empty() ? "" : " ", unit);
}

}  // namespace pcor::internal
