#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pcor::internal {

/// How messages quote names, and what they suggest where one is wrong.

using Names = std::vector<std::string>;

/// Text on one line that a terminal shows literally: control characters, Unicode characters that begin a line
/// or change the direction of writing, and bytes that are not UTF-8 become \x1b and the like.
std::string one_line(std::string_view text);

/// First characters of a text; a text with more than `maximum` characters ends with an ellipsis and its
/// length.
std::string shortened(std::string_view text, std::size_t maximum = 100);

/// `text` on one line in quotation marks, shortened.
std::string quote(std::string_view text);

/// Advice for a wrong name: the most similar known names, otherwise all known names.
std::string suggestion_text(std::string_view wrong, const Names& known);

/// One of the names in each of a list of facts.
template <class Info, class Name>
Names names_of(const Info& info, Name name) {
  Names names;
  for (const auto& each : info) names.emplace_back(each.*name);
  return names;
}

}  // namespace pcor::internal
