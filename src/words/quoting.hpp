#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pcor::internal {

/// How messages quote names, and what they suggest where one is wrong.

using Names = std::vector<std::string>;

/// A message is one line, whatever is quoted in it.
std::string one_line(std::string_view text);

/// `text` on one line in quotation marks.
std::string in_quotes(std::string_view text);

/// What to do about a wrong name: what may have been meant, else all that there is.
std::string instead_of(std::string_view wrong, const Names& known);

/// One of the names in each of a list of facts.
template <class Facts, class Name>
Names names_of(const Facts& facts, Name name) {
  Names names;
  for (const auto& each : facts) names.emplace_back(each.*name);
  return names;
}

}  // namespace pcor::internal
