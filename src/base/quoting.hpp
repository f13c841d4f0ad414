#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pcor::internal {

/// How messages quote names, and what they suggest where one is wrong.

using Names = std::vector<std::string>;

/// A message is one line, read as it stands, whatever is quoted in it: control characters, which a terminal
/// may obey, those of Unicode that begin a line or turn the direction of writing, and bytes that are no UTF-8
/// become \x1b and the like.
std::string one_line(std::string_view text);

/// The first letters of a text; where it has more than `most`, an ellipsis and how many it has.
std::string shortened(std::string_view text, std::size_t most = 100);

/// `text` on one line in quotation marks, shortened.
std::string quote(std::string_view text);

/// What to do about a wrong name: what may have been meant, else all that there is.
std::string suggestion_text(std::string_view wrong, const Names& known);

/// One of the names in each of a list of facts.
template <class Info, class Name>
Names names_of(const Info& info, Name name) {
  Names names;
  for (const auto& each : info) names.emplace_back(each.*name);
  return names;
}

}  // namespace pcor::internal
