#include <pcor/words/utc.hpp>

#include <cmath>
#include <ctime>

namespace pcor {

std::string utc_text(double seconds, const char* pattern) {
  const auto whole = static_cast<std::time_t>(std::floor(seconds));
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
