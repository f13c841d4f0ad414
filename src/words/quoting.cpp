#include "words/quoting.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pcor/words/suggest.hpp>

namespace pcor::internal {

std::string one_line(std::string_view text) {
  std::string line;
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (code < 0x20 || code == 0x7f) {
      line += fmt::format("\\x{:02x}", code);
    } else {
      line += letter;
    }
  }
  return line;
}

std::string in_quotes(std::string_view text) { return "'" + one_line(text) + "'"; }

std::string instead_of(std::string_view wrong, const Names& known) {
  const std::string meant = did_you_mean(wrong, known);
  return meant.empty() ? fmt::format("use one of {}", fmt::join(known, ", ")) : meant;
}

}  // namespace pcor::internal
