#include "model_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pcor/offline/suggest.hpp>

namespace pcor {

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

Names names_of_parameters(const EffectFacts& facts) {
  Names names = names_of(facts.parameters, &ParameterFacts::name);
  names.resize(facts.parameter_count());
  return names;
}

const PublishedRecoveryFactor* published_recovery_factor(std::string_view name) {
  for (const PublishedRecoveryFactor& law : published_recovery_factors) {
    if (law.name == name) return &law;
  }
  return nullptr;
}

}  // namespace pcor
