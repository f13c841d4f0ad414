#include <pcor/offline/regimes.hpp>

// An assertion of toml++ ends the program on input such as `[ = "x`. Without it the same line is refused.
#ifndef NDEBUG
#define NDEBUG
#endif
#include <toml++/toml.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <regex>
#include <system_error>

#include <pcor/offline/error.hpp>

#include "model_names.hpp"

namespace pcor {
namespace {

constexpr std::string_view intervals_format = "pcor-intervals/1";
constexpr double day = 86400.0;               // s
constexpr double longest_of_day = day / 2.0;  // s between two times of the day; more is a mistake
constexpr const char* wanted_time =
    "a date and time such as 2011-11-17T20:10:00Z, or a time of the day such as \"20:10:00\"";

double seconds_of(const toml::time& time) {
  return time.hour * 3600.0 + time.minute * 60.0 + time.second + time.nanosecond * 1e-9;
}

// Days from 1970-01-01 to a date of the Gregorian calendar. The year begins in March, so that the day of leap
// years is its last (Richards, "Calendars", Explanatory Supplement to the Astronomical Almanac, 2013).
std::int64_t days_since_1970(const toml::date& date) {
  const std::int64_t year = date.year - (date.month <= 2 ? 1 : 0);
  const std::int64_t month = (date.month + 9) % 12;  // March is 0
  return 365 * year + year / 4 - year / 100 + year / 400 + (153 * month + 2) / 5 + date.day - 1 - 719468;
}

// "20:10" or "20:10:00.5" as seconds of the day; negative if it is neither.
double time_of_day(const std::string& text) {
  static const std::regex pattern(R"(([01]\d|2[0-3]):([0-5]\d)(?::([0-5]\d)(\.\d+)?)?)");
  std::smatch parts;
  if (!std::regex_match(text, parts, pattern)) return -1.0;
  const auto whole = [&](std::size_t part) {
    return parts[part].matched ? static_cast<double>(std::stoi(parts[part])) : 0.0;
  };
  double fraction = 0.0, scale = 0.1;
  for (const char digit : parts[4].str()) {
    if (digit == '.') continue;
    fraction += scale * (digit - '0');
    scale /= 10.0;
  }
  return whole(1) * 3600.0 + whole(2) * 60.0 + whole(3) + fraction;
}

Names names_of_regimes() { return names_of(regime_facts, &RegimeFacts::name); }

// Reads a parsed file, and refuses what has no meaning with the place where it stands.
class Reader {
 public:
  explicit Reader(std::string_view name) : name_(name) {}

  UserIntervals read(std::string_view text) {
    toml::table root;
    try {
      root = toml::parse(text, name_);
    } catch (const toml::parse_error& error) {
      fail(error.source().begin, std::string(error.description()) + "; correct the syntax (TOML) here");
    }
    check_format(root);
    refuse_unknown(root, "", {"format", "flight", "add", "veto", "exclude"});
    if (const toml::node* flight = root.get("flight")) user_.flight = text_of(*flight, "'flight'");
    each(root, "add", {"regime", "begin", "end", "note", "pair"}, &Reader::add);
    each(root, "veto", {"regime", "begin", "end"}, &Reader::veto);
    each(root, "exclude", {"begin", "end", "reason"}, &Reader::exclude);
    return std::move(user_);
  }

 private:
  struct Span {
    double begin;
    double end;
  };

  [[noreturn]] void fail(toml::source_position place, const std::string& what) const {
    if (!place) place = {1, 1};
    throw Error(one_line(fmt::format("{}:{}:{}: {}", name_, place.line, place.column, what)));
  }

  [[noreturn]] void fail(const toml::node& node, const std::string& what) const {
    fail(node.source().begin, what);
  }

  void check_format(const toml::table& root) const {
    const toml::node* format = root.get("format");
    if (format == nullptr) {
      fail({1, 1}, fmt::format("the file does not say that it holds intervals; begin it with format = \"{}\"",
                               intervals_format));
    }
    const auto* text = format->as_string();
    if (text == nullptr || text->get() != intervals_format) {
      fail(*format, fmt::format("this is not a format of interval files that this program reads; write "
                                "format = \"{}\"",
                                intervals_format));
    }
  }

  // An error at the first key, in the order of the text, that is not `known`.
  void refuse_unknown(const toml::table& table, const std::string& title, const Names& known) const {
    const toml::key* first = nullptr;
    for (const auto& [key, node] : table) {
      const bool is_known = std::find(known.begin(), known.end(), key.str()) != known.end();
      if (!is_known && (first == nullptr || key.source().begin < first->source().begin)) first = &key;
    }
    if (first == nullptr) return;
    fail(first->source().begin,
         fmt::format("there is no key {}{}; {}", in_quotes(first->str()), title.empty() ? "" : " in " + title,
                     instead_of(first->str(), known)));
  }

  void each(const toml::table& root, const std::string& key, const Names& known,
            void (Reader::*read_one)(const toml::table&, const std::string&)) {
    const toml::node* node = root.get(key);
    if (node == nullptr) return;
    const std::string title = "[[" + key + "]]";
    const toml::array* tables = node->as_array();
    if (tables == nullptr) fail(*node, fmt::format("'{}' is no list of tables; write {}", key, title));
    for (const toml::node& element : *tables) {
      const toml::table* table = element.as_table();
      if (table == nullptr) fail(element, fmt::format("'{}' is no list of tables; write {}", key, title));
      refuse_unknown(*table, title, known);
      (this->*read_one)(*table, title);
    }
  }

  void add(const toml::table& table, const std::string& title) {
    const Span span = span_of(table, title);
    Interval interval{regime_of(required(table, "regime", title)), span.begin, span.end, 0, "", true};
    if (const toml::node* note = table.get("note")) interval.note = text_of(*note, "'note' in " + title);
    if (const toml::node* pair = table.get("pair")) interval.pair = pair_of(*pair, interval.regime);
    user_.add.push_back(interval);
  }

  void veto(const toml::table& table, const std::string& title) {
    const Span span = span_of(table, title);
    Veto veto{{}, span.begin, span.end};
    if (const toml::node* regime = table.get("regime")) veto.regime = regime_of(*regime);
    user_.veto.push_back(veto);
  }

  void exclude(const toml::table& table, const std::string& title) {
    const Span span = span_of(table, title);
    const std::string reason = text_of(required(table, "reason", title), "'reason' in " + title);
    user_.exclude.push_back({span.begin, span.end, reason});
  }

  const toml::node& required(const toml::table& table, std::string_view key, const std::string& title) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) fail(table, fmt::format("{} has no '{}'; add {} = ...", title, key, key));
    return *node;
  }

  std::string text_of(const toml::node& node, const std::string& what) const {
    if (const auto* text = node.as_string()) return text->get();
    fail(node, what + " is not a text; give a text in quotes");
  }

  Regime regime_of(const toml::node& node) const {
    const std::string name = text_of(node, "'regime'");
    const Regime regime = regime_named(name);
    if (regime == Regime::count) {
      fail(node,
           fmt::format("there is no regime {}; {}", in_quotes(name), instead_of(name, names_of_regimes())));
    }
    return regime;
  }

  int pair_of(const toml::node& node, Regime regime) const {
    constexpr std::int64_t most = 10000;
    const auto* number = node.as_integer();
    if (number == nullptr || number->get() < 1 || number->get() > most) {
      fail(node, fmt::format("'pair' is not a whole number from 1 to {}; give one to both legs", most));
    }
    if (regime != Regime::reverse_heading) {
      fail(node, "'pair' is for the regime 'reverse heading' only; remove it");
    }
    return static_cast<int>(number->get());
  }

  Span span_of(const toml::table& table, const std::string& title) const {
    const toml::node& begin_node = required(table, "begin", title);
    const toml::node& end_node = required(table, "end", title);
    const Span span{time_of(begin_node), time_of(end_node)};
    const bool of_day = span.begin < day;
    if (of_day != (span.end < day)) {
      fail(end_node,
           "one of 'begin' and 'end' is a time of the day and the other has a date; give both alike");
    }
    if (of_day && span.end != span.begin) {
      const double duration = span.end - span.begin + (span.end < span.begin ? day : 0.0);
      if (duration > longest_of_day) {
        fail(end_node,
             "'end' is before 'begin', or more than 12 h after it; correct it, or give both with dates");
      }
    } else if (!(span.begin < span.end)) {
      fail(end_node, "'end' is not after 'begin'; correct one of them");
    }
    return span;
  }

  // Seconds since 1970 UTC, or of the day, which are fewer than a day.
  double time_of(const toml::node& node) const {
    if (const auto* moment = node.as_date_time()) {
      const toml::date_time& value = moment->get();
      const double minutes_east = value.offset ? value.offset->minutes : 0;
      const double seconds = static_cast<double>(days_since_1970(value.date)) * day + seconds_of(value.time) -
                             minutes_east * 60.0;
      if (seconds < day) fail(node, "the time is before 1970-01-02; correct the date");
      return seconds;
    }
    if (const auto* time = node.as_time()) return seconds_of(time->get());
    const auto* text = node.as_string();
    const double seconds = text == nullptr ? -1.0 : time_of_day(text->get());
    if (seconds < 0.0) fail(node, fmt::format("this is not a time; give {}", wanted_time));
    return seconds;
  }

  std::string name_;
  UserIntervals user_;
};

}  // namespace

UserIntervals read_intervals_text(std::string_view text, std::string_view name) {
  return Reader(name).read(text);
}

UserIntervals read_intervals(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) {
    throw Error(one_line(path.string() + ": there is no such file; give the path of a file of intervals"));
  }
  if (std::filesystem::is_directory(path, code)) {
    throw Error(one_line(path.string() + ": is a directory; give the path of a file of intervals"));
  }
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) throw Error(one_line(path.string() + ": cannot be read; check its permissions"));
  return read_intervals_text(text, path.string());
}

}  // namespace pcor
