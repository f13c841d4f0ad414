#include "flight/registration.hpp"

#include <regex>

namespace pcor::internal {

std::string registration_in(const std::string& text) {
  static const std::regex of_usa(R"(\bN[1-9][0-9]{1,4}[A-Z]{0,2}\b)");
  static const std::regex of_others(R"(\b(([CDFGI]|4X|HB|OE|OH|OO|PH|SE|TF|VH)-[A-Z]{3,4})\b)");
  std::smatch found;
  if (std::regex_search(text, found, of_usa) || std::regex_search(text, found, of_others)) return found.str();
  return {};
}

}  // namespace pcor::internal
