#include <pcor/base/utc.hpp>

#include <fmt/format.h>

#include <cmath>
#include <ctime>

namespace pcor {

std::string utc_text(double seconds, const char* pattern) {
  constexpr double year_0 = -62167219200., year_10000 = 253402300800.;
  if (!(seconds >= year_0 && seconds < year_10000)) return fmt::format("{:g} s after 1970-01-01", seconds);
  constexpr double rounding = 1e-5;  // s, of times that are counted in milliseconds
  const auto whole = static_cast<std::time_t>(std::floor(seconds + rounding));
  std::tm fields{};
  gmtime_r(&whole, &fields);
  char text[128];
  return {text, std::strftime(text, sizeof text, pattern, &fields)};
}

double midnight_before(double seconds) {
  constexpr double day = 86400;
  return std::floor(seconds / day) * day;
}

}  // namespace pcor
