#include "words/toml_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include <pcor/words/error.hpp>

namespace pcor::internal {
namespace {

// Days from 1970-01-01 to a date of the Gregorian calendar. The year begins in March, so that the day of leap
// years is its last (Richards, "Calendars", Explanatory Supplement to the Astronomical Almanac, 2013). It is
// counted from 400 years, of 146097 days, before the year 0, so that none is negative.
std::int64_t days_since_1970(const toml::date& date) {
  const std::int64_t year = date.year + 400 - (date.month <= 2 ? 1 : 0);
  const std::int64_t month = (date.month + 9) % 12;  // March is 0
  return 365 * year + year / 4 - year / 100 + year / 400 + (153 * month + 2) / 5 + date.day - 1 - 719468 -
         146097;
}

}  // namespace

std::vector<Entry> entries_of(const toml::table& table, const std::string& title) {
  std::vector<Entry> entries;
  for (const auto& [key, node] : table) {
    entries.push_back({std::string(key.str()), key.source().begin, &node, title});
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.place < b.place; });
  return entries;
}

std::optional<Entry> entry_of(const toml::table& table, std::string_view key) {
  const auto found = table.find(key);
  if (found == table.end()) return {};
  return Entry{std::string(key), found->first.source().begin, &found->second, ""};
}

std::string called(const Entry& entry) {
  return in_quotes(entry.key) + (entry.title.empty() ? "" : " in " + entry.title);
}

double seconds_of(const toml::time& time) {
  return time.hour * 3600.0 + time.minute * 60.0 + time.second + time.nanosecond * 1e-9;
}

double seconds_of(const toml::date_time& moment) {
  return static_cast<double>(days_since_1970(moment.date)) * 86400.0 + seconds_of(moment.time);
}

toml::table TomlReader::parse(std::string_view text) const {
  try {
    return toml::parse(text, name_);
  } catch (const toml::parse_error& error) {
    fail(error.source().begin, std::string(error.description()) + "; correct the syntax (TOML) here");
  }
}

std::string TomlReader::place_of(Place place) const {
  if (!place) place = {1, 1};
  return fmt::format("{}:{}:{}", name_, place.line, place.column);
}

void TomlReader::fail(Place place, const std::string& what) const {
  throw Error(one_line(place_of(place) + ": " + what));
}

void TomlReader::fail(const toml::node& node, const std::string& what) const {
  fail(node.source().begin, what);
}

void TomlReader::fail(const Entry& entry, const std::string& what) const { fail(*entry.node, what); }

void TomlReader::refuse(const Entry& entry, const Names& known) const {
  fail(entry.place, fmt::format("there is no {}; {}", unknown(entry), instead_of(entry.key, known)));
}

void TomlReader::each(const toml::table& table, const std::string& title, const Actions& actions) const {
  for (const Entry& entry : entries_of(table, title)) {
    const auto action = std::find_if(actions.begin(), actions.end(),
                                     [&](const auto& candidate) { return candidate.first == entry.key; });
    if (action == actions.end()) refuse(entry, names_of(actions, &Actions::value_type::first));
    action->second(entry);
  }
}

Entry TomlReader::format_of(const toml::table& root, std::string_view is, std::string_view format) const {
  if (const std::optional<Entry> entry = entry_of(root, "format")) return *entry;
  fail(Place{1, 1},
       fmt::format("the file does not say that it {}; begin it with format = \"{}\"", is, format));
}

}  // namespace pcor::internal
