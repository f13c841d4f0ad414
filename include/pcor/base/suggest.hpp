#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// Names of `known` that resemble `wrong`, sorted by increasing distance, at most three.
///
/// Distance: number of single-character changes, case-insensitive (a swap of two neighbours is one); ties are
/// ordered by the length of the common prefix. A name with more changes than half its length is suggested
/// only if one is a prefix of the other, so the result may be empty; it is empty for more than 256
/// characters.
std::vector<std::string> suggest(std::string_view wrong, const std::vector<std::string>& known);

/// Suggestions as the end of a message, for example "did you mean QCFR, QCR or QCX?"; empty without
/// suggestions.
std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& known);

}  // namespace pcor
