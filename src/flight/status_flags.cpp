#include "flight/status_flags.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string_view>

namespace pcor::internal {
namespace {

constexpr unsigned long all_bits = 0xFF'FF'FF'FFUL;

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// Whether one of the words of a meaning, "data_bad_or_missing", says that the sample is none.
bool says_unusable(const std::string& meaning) {
  constexpr std::array<std::string_view, 5> unusable{"_bad_", "_missing_", "_invalid_", "_major_",
                                                     "_out_of_range_"};
  const std::string framed = "_" + meaning + "_";
  return std::any_of(unusable.begin(), unusable.end(),
                     [&](std::string_view word) { return framed.find(word) != std::string::npos; });
}

/// The bits of a flag, also of one that is stored as a signed number.
unsigned long bits_of(double flag) { return static_cast<unsigned long>(static_cast<long>(flag)) & all_bits; }

std::optional<int> flags_variable(const FlightFile& file, int variable) {
  std::vector<std::string> names = words_of(file.text_attribute(variable, "ancillary_variables"));
  names.push_back(file.variable_name(variable) + "_FLAG");
  for (const std::string& name : names) {
    const std::optional<int> flags = file.find_variable(name);
    if (flags && file.is_numeric(*flags) && !file.text_attribute(*flags, "flag_meanings").empty() &&
        file.dimensions_of(*flags) == file.dimensions_of(variable))
      return flags;
  }
  return std::nullopt;
}

}  // namespace

std::optional<StatusFlags> StatusFlags::of(const FlightFile& file, int variable) {
  const std::optional<int> number = flags_variable(file, variable);
  if (!number) return std::nullopt;
  StatusFlags flags;
  flags.variable_ = *number;
  const std::vector<std::string> meanings = words_of(file.text_attribute(*number, "flag_meanings"));
  const std::vector<double> values = file.number_attribute(*number, "flag_values");
  const std::vector<double> masks = file.number_attribute(*number, "flag_masks");
  for (std::size_t i = 0; i < meanings.size(); ++i) {
    if (!says_unusable(meanings[i])) continue;
    if (i < masks.size()) {
      const unsigned long mask = bits_of(masks[i]);
      flags.conditions_.push_back({mask, i < values.size() ? bits_of(values[i]) : mask});
    } else if (i < values.size()) {
      flags.conditions_.push_back({all_bits, bits_of(values[i])});
    }
  }
  return flags.conditions_.empty() ? std::nullopt : std::optional(flags);
}

bool StatusFlags::unusable(double flag) const {
  if (!(std::abs(flag) <= static_cast<double>(all_bits))) return false;
  const unsigned long bits = bits_of(flag);
  return std::any_of(conditions_.begin(), conditions_.end(), [bits](const Condition& condition) {
    return (bits & condition.mask) == condition.value;
  });
}

}  // namespace pcor::internal
