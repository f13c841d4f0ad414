#include <pcor/regimes/regimes.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "base/quoting.hpp"
#include "base/text_file.hpp"
#include "base/toml_reader.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr std::string_view intervals_format = "pcor-intervals/1";
constexpr double day_length = 86400.0;  // s

// Reads a parsed file; entries without a meaning are refused with their position.
class Reader final : TomlReader {
 public:
  explicit Reader(std::string_view name) : TomlReader(name) {}

  UserIntervals read(std::string_view text) const {
    const toml::table root = parse(text);
    require_format(root, "a file of intervals", intervals_format);
    refuse_unknown(root, "", {"format", "flight", "add", "veto", "exclude"});
    UserIntervals user;
    if (const toml::node* flight = root.get("flight")) user.flight = text_of(*flight, "'flight'");
    each(root, "add", {"regime", "begin", "end", "note", "pair"},
         [&](const toml::table& table, double begin, double end) {
           Interval interval{regime_of(required(table, "regime", "[[add]]")), begin, end};
           if (const toml::node* note = table.get("note"))
             interval.note = text_of(*note, "'note' in [[add]]");
           if (const toml::node* pair = table.get("pair")) interval.pair = pair_of(*pair, interval.regime);
           user.add.push_back(interval);
         });
    each(root, "veto", {"regime", "begin", "end"}, [&](const toml::table& table, double begin, double end) {
      Veto& veto = user.veto.emplace_back(Veto{{}, begin, end});
      if (const toml::node* regime = table.get("regime")) veto.regime = regime_of(*regime);
    });
    each(root, "exclude", {"begin", "end", "reason"},
         [&](const toml::table& table, double begin, double end) {
           const toml::node& reason = required(table, "reason", "[[exclude]]");
           user.exclude.push_back({begin, end, text_of(reason, "'reason' in [[exclude]]")});
         });
    return user;
  }

 private:
  // Calls `read_one` with each table of a list, and with its begin and end.
  template <class ReadOne>
  void each(const toml::table& root, const std::string& key, const Names& known,
            const ReadOne& read_one) const {
    const toml::node* node = root.get(key);
    if (node == nullptr) return;
    const std::string title = "[[" + key + "]]";
    const std::string otherwise = fmt::format("'{}' is not a list of tables; write {}", key, title);
    for (const toml::node& element : as<toml::array>(*node, otherwise)) {
      const auto& table = as<toml::table>(element, otherwise);
      refuse_unknown(table, title, known);
      const auto [begin, end] = span_of(table, title);
      read_one(table, begin, end);
    }
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
      fail(node, fmt::format("there is no regime {}; {}", quote(name),
                             suggestion_text(name, names_of(regime_info, &RegimeInfo::name))));
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

  // Begin and end of a table.
  std::pair<double, double> span_of(const toml::table& table, const std::string& title) const {
    const toml::node& begin_node = required(table, "begin", title);
    const toml::node& end_node = required(table, "end", title);
    const double begin = time_of(begin_node), end = time_of(end_node);
    const bool of_day = begin < day_length;
    if (of_day != (end < day_length)) {
      fail(end_node,
           "one of 'begin' and 'end' is a time of the day and the other has a date; give both in the same "
           "form");
    }
    const double duration = end - begin + (of_day && end < begin ? day_length : 0.0);
    if (of_day && duration > day_length / 2.0)
      fail(end_node,
           "'end' is before 'begin', or more than 12 h after it; correct it, or give both with dates");
    if (!(duration > 0.0)) fail(end_node, "'end' is not after 'begin'; correct one of them");
    return {begin, end};
  }

  // Seconds since 1970 UTC, or since midnight, which are less than a day.
  double time_of(const toml::node& node) const {
    const std::string* const text = node.is_string() ? &node.as_string()->get() : nullptr;
    const auto moment = text != nullptr ? moment_in<toml::date_time>(*text) : node.value<toml::date_time>();
    if (moment) {
      const double minutes_east = moment->offset ? moment->offset->minutes : 0;
      const double seconds = seconds_of(*moment) - minutes_east * 60.0;
      if (seconds < day_length) fail(node, "the time is before 1970-01-02; correct the date");
      return seconds;
    }
    std::optional<toml::time> time = node.value<toml::time>();
    if (text != nullptr)  // "20:10" and "20:10:00.5"
      time = moment_in<toml::time>(text->size() == 5 ? *text + ":00" : *text);
    if (!time)
      fail(node,
           "the value is not a time; give a date and time such as 2011-11-17T20:10:00Z, or a time of the day "
           "such as \"20:10:00\"");
    return seconds_of(*time);
  }
};

}  // namespace

UserIntervals read_intervals_text(std::string_view text, std::string_view name) {
  return Reader(name).read(text);
}

UserIntervals read_intervals(const std::filesystem::path& path) {
  return read_intervals_text(text_of_file(path, "a file of intervals"), path.string());
}

}  // namespace pcor
