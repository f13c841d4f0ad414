#include "base/phrasing.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>
#include <utility>

namespace pcor::internal {

std::string sentence(std::string text) {
  if (text.empty()) return text;
  if (text.substr(0, text.find(' ')).find('.') == std::string::npos)
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  if (std::string_view(".!?").find(text.back()) == std::string_view::npos) text += ".";
  return text;
}

std::vector<std::string> split_words(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::string join_list(const std::vector<std::string>& all, std::string_view word) {
  if (all.size() < 2) return all.empty() ? "" : all.front();
  return fmt::format("{} {} {}", fmt::join(all.begin(), all.end() - 1, ", "), word, all.back());
}

int decimals_of_error(double error) {
  const double rounded = std::stod(fmt::format("{:.1e}", error));
  return std::max(0, 1 - static_cast<int>(std::floor(std::log10(rounded) + 1e-9)));
}

Notes notes_of_flights(const std::vector<FlightNote>& notes, std::size_t flight_count) {
  constexpr std::size_t max_names = 3;
  std::vector<std::pair<Note, std::vector<std::string>>> flights_of;
  for (const auto& [flight, note] : notes) {
    auto found = std::find_if(flights_of.begin(), flights_of.end(),
                              [of = note](const auto& each) { return each.first == of; });
    if (found == flights_of.end()) found = flights_of.insert(found, {note, {}});
    std::vector<std::string>& flights = found->second;
    if (std::find(flights.begin(), flights.end(), flight) == flights.end()) flights.push_back(flight);
  }
  Notes all;
  for (const auto& [note, flights] : flights_of) {
    const std::string names = flights.size() > max_names ? std::to_string(flights.size()) + " flights"
                                                         : fmt::format("{}", fmt::join(flights, ", "));
    all.emplace_back(note.severity, flight_count == 1 ? note.text : names + ": " + note.text);
  }
  return all;
}

}  // namespace pcor::internal
