#pragma once

#include <string>
#include <utility>
#include <vector>

namespace pcor::internal {

/// How texts put sentences, lists and errors.

/// With a capital letter, unless it begins with the name of a file or a parameter, and a full stop unless it
/// has one. Empty for an empty text.
std::string sentence(std::string text);

/// The words of a text, which blanks part.
std::vector<std::string> split_words(const std::string& text);

/// "a", "a and b", "a, b and c".
std::string join_list(const std::vector<std::string>& all);

/// A flight and what is to be said of it.
using FlightNote = std::pair<std::string, std::string>;

/// What is said of flights, once each: "first.nc, second.nc: ...", of more than three "16 flights: ...".
std::vector<std::string> notes_of_flights(const std::vector<FlightNote>& notes);

/// The decimals with which an error has two digits, the first of them that after rounding: 0.0996 is 0.10.
int decimals_of_error(double error);

}  // namespace pcor::internal
