#include "base/toml_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>

#include <pcor/base/error.hpp>

namespace pcor::internal {
namespace {

// Limits of a file. toml++ recurses once for each table level of a key, and readers look entries up one by
// one; toml++ limits nested values to 256 levels.
constexpr std::size_t max_dots = 16;  // per key
constexpr std::size_t max_entries = 10000;

// Position of the closing quote of the text that begins at `begin`; a text in single or double quotes ends
// with its line.
std::size_t end_of_quotes(std::string_view text, std::size_t begin) {
  const char mark = text[begin];
  const std::string_view three = text.substr(begin, 3);
  const std::string_view quotes = three == std::string(3, mark) ? three : three.substr(0, 1);
  for (std::size_t i = begin + quotes.size(); i < text.size(); ++i) {
    if (text.substr(i, quotes.size()) == quotes) return i + quotes.size() - 1;
    if (quotes.size() == 1 && text[i] == '\n') return i;
    if (mark == '"' && text[i] == '\\') ++i;
  }
  return text.size();
}

// Position of the first key with too many dots, if there is one.
std::optional<std::size_t> place_of_deep_key(std::string_view text) {
  std::size_t dots = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (letter == '"' || letter == '\'') i = end_of_quotes(text, i);
    if (letter == '#') i = std::min(text.find('\n', i), text.size());
    if (letter == '.' && ++dots > max_dots) return i;
    if (letter == '=' || letter == ',' || i == text.size() || text[i] == '\n') dots = 0;
  }
  return {};
}

// An empty text or list.
bool is_empty(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get().empty();
  return node.is_array() && node.as_array()->empty();
}

}  // namespace

std::vector<Entry> entries_of(const toml::table& table, const std::string& title) {
  std::vector<Entry> entries;
  for (const auto& [key, node] : table) {
    entries.push_back({std::string(key.str()), key.source().begin, &node, title});
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.position < b.position; });
  return entries;
}

std::optional<Entry> entry_of(const toml::table& table, std::string_view key, const std::string& title) {
  const auto found = table.find(key);
  if (found == table.end()) return {};
  return Entry{std::string(key), found->first.source().begin, &found->second, title};
}

std::string_view kind_of(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (node.is_array()) return "a list";
  if (node.is_string()) return "a text";
  if (node.is_number()) return "a number";
  return node.is_boolean() ? "true or false" : "a date or time";
}

std::string called(const Entry& entry) {
  return quote(entry.key) + (entry.title.empty() ? "" : " in " + entry.title);
}

double seconds_of(const toml::time& time) {
  return time.hour * 3600.0 + time.minute * 60.0 + time.second + time.nanosecond * 1e-9;
}

double seconds_of(const toml::date_time& moment) {
  std::tm midnight{};
  midnight.tm_year = moment.date.year - 1900;
  midnight.tm_mon = moment.date.month - 1;
  midnight.tm_mday = moment.date.day;
  return static_cast<double>(timegm(&midnight)) + seconds_of(moment.time);
}

toml::table TomlReader::parse(std::string_view text) const {
  for (const std::string_view begin : {"CDF", "\x89HDF"}) {
    if (text.substr(0, begin.size()) == begin)
      fail(Position{1, 1},
           "this is a netCDF file, and a text in TOML is required; check the order of the arguments");
  }
  if (const std::optional<std::size_t> deep = place_of_deep_key(text)) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(*deep), '\n');
    fail(Position{static_cast<toml::source_index>(line), 1},
         "a key has more than {} dots; use fewer nested tables", max_dots);
  }
  try {
    toml::table root = toml::parse(text, name_);
    refuse_crowd(root);
    return root;
  } catch (const toml::parse_error& error) {
    fail(error.source().begin, std::string(error.description()) + "; correct the syntax (TOML) here");
  }
}

void TomlReader::refuse_crowd(const toml::node& node) const {
  const auto refuse_above = [&](std::size_t entries) {
    if (entries > max_entries)
      fail(node, "{} has {} entries; give at most {}", kind_of(node), entries, max_entries);
  };
  if (const toml::table* const table = node.as_table()) {
    refuse_above(table->size());
    for (const auto& [key, entry] : *table) refuse_crowd(entry);
  }
  if (const toml::array* const array = node.as_array()) {
    refuse_above(array->size());
    for (const toml::node& entry : *array) refuse_crowd(entry);
  }
}

std::string TomlReader::position_of(Position position) const {
  if (!position) position = {1, 1};
  return fmt::format("{}:{}:{}", name_, position.line, position.column);
}

void TomlReader::fail(Position position, const std::string& what) const {
  throw Error(Error::Code::definition, one_line(position_of(position) + ": " + what));
}

void TomlReader::refuse(const Entry& entry, const Names& known) const {
  fail(entry.position, "there is no {}; {}", unknown(entry), suggestion_text(entry.key, known));
}

void TomlReader::refuse_unknown(const toml::table& table, const std::string& title,
                                const Names& known) const {
  for (const Entry& entry : entries_of(table, title)) {
    if (std::find(known.begin(), known.end(), entry.key) == known.end()) refuse(entry, known);
  }
}

void TomlReader::each(const toml::table& table, const std::string& title, const Actions& actions,
                      const std::map<std::string, std::string>& required) const {
  refuse_unknown(table, title, names_of(actions, &Actions::value_type::first));
  for (const auto& [key, action] : actions) {
    const std::optional<Entry> entry = entry_of(table, key, title);
    const auto missing = required.find(key);
    if (missing != required.end() && (!entry || is_empty(*entry->node))) fail(table, missing->second);
    if (entry) action(*entry);
  }
}

void TomlReader::require_format(const toml::table& root, std::string_view what,
                                std::string_view format) const {
  const std::optional<Entry> entry = entry_of(root, "format");
  if (!entry)
    fail(Position{1, 1}, "the file does not declare that it is {}; begin it with format = \"{}\"", what,
         format);
  if (const std::string given = text(*entry, quote(format)); given != format)
    fail(*entry, "{} is not the format of {}; write format = \"{}\"", quote(given), what, format);
}

std::string TomlReader::wrong_kind(const Entry& entry, const std::string& requested) {
  return fmt::format("{} is {}; give {}", called(entry), kind_of(*entry.node), requested);
}

double TomlReader::finite(const toml::node& node, const std::string& what) const {
  if (!node.is_number()) fail(node, "{} is {}; give a number", what, kind_of(node));
  const auto* whole = node.as_integer();
  const double value = whole ? static_cast<double>(whole->get()) : node.as_floating_point()->get();
  if (!std::isfinite(value)) fail(node, what + " is not finite; give a finite number");
  return value;
}

std::vector<double> TomlReader::numbers(const Entry& entry, const std::string& requested) const {
  std::vector<double> values;
  for (const toml::node& node : array(entry, requested)) {
    values.push_back(finite(node, "a number of " + called(entry)));
  }
  return values;
}

std::pair<double, double> TomlReader::range(const Entry& entry) const {
  const std::string requested = "[lower, upper]";
  const std::vector<double> ends = numbers(entry, requested);
  if (ends.size() != 2) fail(entry, "{} has {} numbers; give {}", called(entry), ends.size(), requested);
  if (!(ends[0] < ends[1]))
    fail(entry, "{}: the lower end {} is not below the upper end {}; give {}", called(entry), ends[0],
         ends[1], requested);
  return {ends[0], ends[1]};
}

std::vector<std::pair<const toml::node*, std::string>> TomlReader::texts(const Entry& entry,
                                                                         const std::string& requested) const {
  std::vector<std::pair<const toml::node*, std::string>> values;
  for (const toml::node& node : array(entry, requested)) {
    const std::string otherwise =
        fmt::format("{} holds {}; give {}", called(entry), kind_of(node), requested);
    values.emplace_back(&node, as<std::string>(node, otherwise));
  }
  return values;
}

std::string TomlReader::date(const Entry& entry) const {
  const std::string requested = "a date like \"2011-11-02\"";
  std::optional<toml::date> day = entry.node->value<toml::date>();
  if (!day) {
    const std::string written = text(entry, requested);
    day = moment_in<toml::date>(written);
    if (!day) fail(entry, "{}: {} is not a date; give {}", called(entry), quote(written), requested);
  }
  return fmt::format("{:04}-{:02}-{:02}", day->year, day->month, day->day);
}

}  // namespace pcor::internal
