#include <pcor/base/format_estimate.hpp>

#include <fmt/format.h>

#include <cmath>

#include "base/phrasing.hpp"

namespace pcor {

std::string format_estimate(double value, double error, PlusSign sign, std::string_view plus_minus) {
  constexpr int max_decimals = 7;
  if (!std::isfinite(value)) return "unknown";
  const char* const plus = sign == PlusSign::always && !std::signbit(value) ? "+" : "";
  if (!(error > 0.0) || !std::isfinite(error)) return fmt::format("{}{:.4g}", plus, value);
  const int decimals = internal::decimals_of_error(error);
  if (decimals > max_decimals) return fmt::format("{}{:.3g} {} {:.2g}", plus, value, plus_minus, error);
  return fmt::format("{}{:.{}f} {} {:.{}f}", plus, value, decimals, plus_minus, error, decimals);
}

}  // namespace pcor
