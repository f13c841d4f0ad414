#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// The names of `known` that someone who wrote `wrong` may have meant, likeliest first, at most `most`.
///
/// Names are compared without regard to case by the number of single-letter changes (a swap of two
/// neighbours is one); among equals, the one that begins the same way comes first. A name with more changes
/// than half its letters is not suggested unless one is the beginning of the other, so the answer may be
/// empty; for more than 256 letters it is.
std::vector<std::string> suggest(std::string_view wrong, const std::vector<std::string>& known,
                                 std::size_t most = 3);

/// The suggestions as words to end a message with, for example "did you mean QCFR, QCR or QCX?"; empty when
/// there are none.
std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& known, std::size_t most = 3);

}  // namespace pcor
