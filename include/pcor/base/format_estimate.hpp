#pragma once

#include <string>
#include <string_view>

namespace pcor {

/// Sign of a positive number in a text.
enum class PlusSign { always, never };

/// "-0.537 +- 0.012": the error with two significant digits, the value with as many decimals. The error is
/// omitted unless it is positive and finite; a value that is not finite is "unknown".
std::string format_estimate(double value, double error, PlusSign sign = PlusSign::always,
                            std::string_view plus_minus = "+-");

}  // namespace pcor
