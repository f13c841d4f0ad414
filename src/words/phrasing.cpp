#include "words/phrasing.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

namespace pcor::internal {

std::string sentence(std::string text) {
  if (text.empty()) return text;
  if (text.substr(0, text.find(' ')).find('.') == std::string::npos)
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  if (std::string_view(".!?").find(text.back()) == std::string_view::npos) text += ".";
  return text;
}

std::string list_text(const std::vector<std::string>& all) {
  if (all.size() < 2) return all.empty() ? "" : all.front();
  return fmt::format("{} and {}", fmt::join(all.begin(), all.end() - 1, ", "), all.back());
}

int decimals_of_error(double error) {
  const double rounded = std::stod(fmt::format("{:.1e}", error));
  return std::max(0, 1 - static_cast<int>(std::floor(std::log10(rounded) + 1e-9)));
}

}  // namespace pcor::internal
