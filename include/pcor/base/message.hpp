#pragma once

#include <string>
#include <string_view>

namespace pcor {

/// A message as people get to see it: one line of at most 2000 letters, an ellipsis and the number of letters
/// where it has more. Control characters, which a terminal would obey, and bytes that are no UTF-8 become
/// \x1b and the like.
std::string sanitize_line(std::string_view message);

/// The same for a text, which keeps its lines and its length.
std::string shown_text(std::string_view text);

}  // namespace pcor
