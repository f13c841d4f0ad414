#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pcor/base/note.hpp>

namespace pcor::internal {

/// How texts put sentences, lists and errors.

/// Text with an upper-case first character, unless it begins with the name of a file or a parameter, and with
/// a final full stop. An empty text is unchanged.
std::string sentence(std::string text);

/// The words of a text, which blanks part.
std::vector<std::string> split_words(const std::string& text);

/// "a", "a and b", "a, b and c"; or with another word before the last.
std::string join_list(const std::vector<std::string>& all, std::string_view word = "and");

/// Flight and a note about it.
using FlightNote = std::pair<std::string, Note>;

/// Notes on flights without repetition: "first.nc, second.nc: ..."; for more than three flights "16 flights:
/// ...". @param flight_count number of flights; if there is one, the notes do not name it
Notes notes_of_flights(const std::vector<FlightNote>& notes, std::size_t flight_count);

/// The decimals with which an error has two digits, the first of them that after rounding: 0.0996 is 0.10.
int decimals_of_error(double error);

}  // namespace pcor::internal
