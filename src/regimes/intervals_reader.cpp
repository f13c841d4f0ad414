#include <pcor/regimes/regimes.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>

#include "base/quoting.hpp"
#include "base/text_file.hpp"
#include "base/toml_reader.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr std::string_view intervals_format = "pcor-intervals/1";
constexpr double day_length = 86400.0;           // s
constexpr double max_of_day = day_length / 2.0;  // s between two times of day; a longer interval is a mistake
constexpr const char* requested_time =
    "a date and time such as 2011-11-17T20:10:00Z, or a time of the day such as \"20:10:00\"";

// Formats "20:10" and "20:10:00.5".
std::optional<toml::time> time_of_day(const std::string& text) {
  return moment_in<toml::time>(text.size() == 5 ? text + ":00" : text);
}

Names names_of_regimes() { return names_of(regime_info, &RegimeInfo::name); }

// Reads a parsed file; entries without a meaning are refused with their position.
class Reader final : TomlReader {
 public:
  explicit Reader(std::string_view name) : TomlReader(name) {}

  UserIntervals read(std::string_view text) {
    const toml::table root = parse(text);
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

  void check_format(const toml::table& root) const {
    const Entry format = format_of(root, "holds intervals", intervals_format);
    if (format.node->value<std::string_view>() == intervals_format) return;
    fail(format, fmt::format("unknown format of an interval file; write format = \"{}\"", intervals_format));
  }

  // Refuses the first key, in the order of the text, that is not `known`.
  void refuse_unknown(const toml::table& table, const std::string& title, const Names& known) const {
    for (const Entry& entry : entries_of(table, title)) {
      if (std::find(known.begin(), known.end(), entry.key) == known.end()) refuse(entry, known);
    }
  }

  void each(const toml::table& root, const std::string& key, const Names& known,
            void (Reader::*read_one)(const toml::table&, const std::string&)) {
    const toml::node* node = root.get(key);
    if (node == nullptr) return;
    const std::string title = "[[" + key + "]]";
    const std::string otherwise = fmt::format("'{}' is not a list of tables; write {}", key, title);
    for (const toml::node& element : as<toml::array>(*node, otherwise)) {
      const auto& table = as<toml::table>(element, otherwise);
      refuse_unknown(table, title, known);
      (this->*read_one)(table, title);
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
    return as<std::string>(node, what + " is not a text; give a text in quotes");
  }

  Regime regime_of(const toml::node& node) const {
    const std::string name = text_of(node, "'regime'");
    const Regime regime = regime_named(name);
    if (regime == Regime::count) {
      fail(node,
           fmt::format("there is no regime {}; {}", quote(name), suggestion_text(name, names_of_regimes())));
    }
    return regime;
  }

  int pair_of(const toml::node& node, Regime regime) const {
    constexpr std::int64_t maximum = 10000;
    const auto* number = node.as_integer();
    if (number == nullptr || number->get() < 1 || number->get() > maximum) {
      fail(node, fmt::format("'pair' is not a whole number from 1 to {}; give one to both legs", maximum));
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
    const bool of_day = span.begin < day_length;
    if (of_day != (span.end < day_length)) {
      fail(end_node,
           "one of 'begin' and 'end' is a time of the day and the other has a date; give both in the same "
           "form");
    }
    if (of_day && span.end != span.begin) {
      const double duration = span.end - span.begin + (span.end < span.begin ? day_length : 0.0);
      if (duration > max_of_day) {
        fail(end_node,
             "'end' is before 'begin', or more than 12 h after it; correct it, or give both with dates");
      }
    } else if (!(span.begin < span.end)) {
      fail(end_node, "'end' is not after 'begin'; correct one of them");
    }
    return span;
  }

  // Seconds since 1970 UTC, or since midnight, which are less than a day.
  double time_of(const toml::node& node) const {
    if (const auto* moment = node.as_date_time()) {
      const toml::date_time& value = moment->get();
      const double minutes_east = value.offset ? value.offset->minutes : 0;
      const double seconds = seconds_of(value) - minutes_east * 60.0;
      if (seconds < day_length) fail(node, "the time is before 1970-01-02; correct the date");
      return seconds;
    }
    const std::optional<toml::time> time =
        node.is_string() ? time_of_day(node.as_string()->get()) : node.value<toml::time>();
    if (!time) fail(node, fmt::format("the value is not a time; give {}", requested_time));
    return seconds_of(*time);
  }

  UserIntervals user_;
};

}  // namespace

UserIntervals read_intervals_text(std::string_view text, std::string_view name) {
  return Reader(name).read(text);
}

UserIntervals read_intervals(const std::filesystem::path& path) {
  return read_intervals_text(text_of_file(path, "a file of intervals"), path.string());
}

}  // namespace pcor
