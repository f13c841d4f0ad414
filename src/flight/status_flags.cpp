#include "flight/status_flags.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <string_view>

#include "base/phrasing.hpp"

namespace pcor::internal {
namespace {

constexpr unsigned long all_bits = ~0UL;
constexpr double largest_span = 9007199254740992.0;  // 2^53, up to which a double holds all whole numbers

/// Whether a meaning, for example "data_bad_or_missing", marks an unusable sample.
bool says_unusable(const std::string& meaning) {
  constexpr std::array<std::string_view, 5> unusable{"_bad_", "_missing_", "_invalid_", "_major_",
                                                     "_out_of_range_"};
  std::string framed = "_" + meaning + "_";
  std::transform(framed.begin(), framed.end(), framed.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  const auto says = [&framed](std::string_view word) { return framed.find(word) != std::string::npos; };
  return !says("_not_") && std::any_of(unusable.begin(), unusable.end(), says);
}

/// Number of values of the integer type with this maximum; at most `largest_span`, which is also that of
/// floating-point types.
double span_of(double max_number) {
  const double bits = std::log2(max_number + 1.0);
  return bits <= 32.0 ? std::exp2(8.0 * std::ceil(bits / 8.0)) : largest_span;
}

/// The bits of a number of a type of that span, also of one that is written as if it had a sign. Nullopt for
/// a number that is not whole or, in a type of the largest span, negative.
std::optional<unsigned long> bits_of(double number, double span) {
  const double positive = number < 0.0 && span < largest_span ? number + span : number;
  if (!(positive >= 0.0 && positive < span) || positive != std::floor(positive)) return std::nullopt;
  return static_cast<unsigned long>(positive);
}

}  // namespace

StatusFlags::StatusFlags(const FlightFile& file, int variable, bool is_of_record)
    : variable_(variable),
      is_of_record_(is_of_record),
      span_(span_of(file.max_number(variable))),
      missing_(file.missing_values(variable)) {
  const std::vector<std::string> meanings = split_words(file.text_attribute(variable, "flag_meanings"));
  const std::vector<double> values = file.number_attribute(variable, "flag_values");
  const std::vector<double> masks = file.number_attribute(variable, "flag_masks");
  for (std::size_t i = 0; i < meanings.size(); ++i) {
    if (!says_unusable(meanings[i])) continue;
    const std::optional<unsigned long> mask = i < masks.size() ? bits_of(masks[i], span_) : all_bits;
    const std::optional<unsigned long> value = i < values.size()  ? bits_of(values[i], span_)
                                               : i < masks.size() ? mask
                                                                  : std::nullopt;
    if (mask && *mask != 0 && value) conditions_.push_back({*mask, *value});
  }
}

std::vector<StatusFlags> StatusFlags::of(const FlightFile& file, int variable) {
  std::vector<std::string> names{file.variable_name(variable) + "_FLAG"};
  const bool is_own_result = !file.text_attribute(FlightFile::whole_file, "pcor_model").empty();
  if (!is_own_result) {
    for (std::string& name : split_words(file.text_attribute(variable, "ancillary_variables")))
      names.push_back(std::move(name));
  }
  const std::vector<int> dimensions = file.dimensions_of(variable);
  std::vector<StatusFlags> all;
  for (const std::string& name : names) {
    const std::optional<int> number = file.find_variable(name);
    const bool is_known = std::any_of(
        all.begin(), all.end(), [&number](const StatusFlags& each) { return each.variable_ == number; });
    if (!number || is_known || !file.is_numeric(*number)) continue;
    const std::vector<int> flag_dimensions = file.dimensions_of(*number);
    const bool is_of_record = flag_dimensions.size() == 1 && dimensions.size() == 2 &&
                              flag_dimensions.front() == dimensions.front();
    if (flag_dimensions != dimensions && !is_of_record) continue;
    const StatusFlags flags(file, *number, is_of_record);
    if (!flags.conditions_.empty()) all.push_back(flags);
  }
  return all;
}

bool StatusFlags::unusable(double flag) const {
  const std::optional<unsigned long> bits = bits_of(flag, span_);
  if (!bits || std::find(missing_.begin(), missing_.end(), flag) != missing_.end()) return false;
  return std::any_of(conditions_.begin(), conditions_.end(), [&bits](const Condition& condition) {
    return (*bits & condition.mask) == condition.value;
  });
}

}  // namespace pcor::internal
