#pragma once

// Only for the sources of readers, which alone shall know toml++.
// An assertion of toml++ ends the program on input such as `[ = "x`. Without it the same line is refused.
#ifndef NDEBUG
#define NDEBUG
#endif
#include <fmt/format.h>
#include <toml++/toml.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/quoting.hpp"

namespace pcor::internal {

/// A key of a table with its value.
struct Entry {
  std::string key;
  toml::source_position position;  // position of the key
  const toml::node* node;
  std::string title;  // title of the table
};

/// The entries of a table in the order of the text; toml++ sorts them by name.
std::vector<Entry> entries_of(const toml::table& table, const std::string& title = "");

/// The entry of that key, if the table has it.
std::optional<Entry> entry_of(const toml::table& table, std::string_view key, const std::string& title = "");

/// Kind of a node for messages: "a table", "a number".
std::string_view kind_of(const toml::node& node);

/// A key as messages call it: in quotes, with the title of its table.
std::string called(const Entry& entry);

/// Date, time or both, written in TOML syntax in a text, such as 2011-11-02 or 20:10:00.5; nullopt if the
/// text is not one.
template <class Moment>
std::optional<Moment> moment_in(std::string_view text) {
  if (text.find_first_not_of("0123456789-:.+TZ") != std::string_view::npos) return {};
  try {
    return toml::parse("moment = " + std::string(text))["moment"].value<Moment>();
  } catch (const toml::parse_error&) {
    return {};
  }
}

/// Seconds since midnight.
double seconds_of(const toml::time& time);

/// Seconds since 1970 of a date and time without regard to its offset.
double seconds_of(const toml::date_time& moment);

/// Base of the readers of TOML files: entries without a meaning are refused with their position.
class TomlReader {
 protected:
  using Position = toml::source_position;
  using Action = std::function<void(const Entry&)>;
  using Actions = std::vector<std::pair<std::string, Action>>;

  /// Messages call the file `name`.
  explicit TomlReader(std::string_view name) : name_(name) {}
  ~TomlReader() = default;

  /// The tables of a text. Refused are a syntax error, a key of more than 16 dots, and a table or list of
  /// more than 10,000 entries.
  toml::table parse(std::string_view text) const;

  /// "file:line:column"; the beginning of the file for an unknown position.
  std::string position_of(Position position) const;

  /// Name of the file for messages.
  const std::string& name() const { return name_; }

  [[noreturn]] void fail(Position position, const std::string& what) const;
  [[noreturn]] void fail(const toml::node& node, const std::string& what) const {
    fail(node.source().begin, what);
  }

  /// An error at the value of `entry`; for an error at the key use its `position`.
  [[noreturn]] void fail(const Entry& entry, const std::string& what) const { fail(*entry.node, what); }

  /// Formats the text with these values, and fails with it.
  template <class Where, class First, class... Others>
  [[noreturn]] void fail(const Where& where, fmt::format_string<const First&, const Others&...> text,
                         const First& first, const Others&... others) const {
    fail(where, fmt::format(text, first, others...));
  }

  /// An error at a key that is not among the `known` ones.
  [[noreturn]] void refuse(const Entry& entry, const Names& known) const;

  /// Name of the key for `refuse`.
  virtual std::string unknown(const Entry& entry) const { return "key " + called(entry); }

  /// Refuses the first key, in the order of the text, that is not `known`.
  void refuse_unknown(const toml::table& table, const std::string& title, const Names& known) const;

  /// Refuses keys without an action, then calls the actions in their own order: of a section that depends on
  /// another after that of the other. @param required error for each key that must be given, and not be empty
  void each(const toml::table& table, const std::string& title, const Actions& actions,
            const std::map<std::string, std::string>& required = {}) const;

  /// Requires the entry `format` of a file with this value. @param what the file is, with an article
  void require_format(const toml::table& root, std::string_view what, std::string_view format) const;

  /// Content of a node: a table, an array, a text and the like. Any other kind is the error `otherwise`.
  template <class Value>
  const Value& as(const toml::node& node, const std::string& otherwise) const {
    const auto* value = node.as<Value>();
    if (value == nullptr) fail(node, otherwise);
    if constexpr (toml::is_container<Value>) {
      return *value;
    } else {
      return value->get();
    }
  }

  /// Value of an entry. Any other kind than the `requested` one is an error.
  template <class Value>
  const Value& value(const Entry& entry, const std::string& requested) const {
    return as<Value>(*entry.node, wrong_kind(entry, requested));
  }
  bool boolean(const Entry& entry) const { return value<bool>(entry, "true or false"); }
  std::int64_t whole_number(const Entry& entry, const std::string& requested = "a whole number") const {
    return value<std::int64_t>(entry, requested);
  }
  std::string text(const Entry& entry, const std::string& requested = "a text in quotes") const {
    return value<std::string>(entry, requested);
  }
  const toml::table& table(const Entry& entry, const std::string& requested) const {
    return value<toml::table>(entry, requested);
  }
  const toml::table& table(const Entry& entry) const { return table(entry, "a table [" + entry.key + "]"); }
  const toml::array& array(const Entry& entry, const std::string& requested) const {
    return value<toml::array>(entry, requested);
  }

  /// A finite number; `what` is what messages call it.
  double finite(const toml::node& node, const std::string& what) const;
  double number(const Entry& entry) const { return finite(*entry.node, called(entry)); }
  std::vector<double> numbers(const Entry& entry, const std::string& requested) const;

  /// The two ends of [lower, upper], of which the lower one is below the upper one.
  std::pair<double, double> range(const Entry& entry) const;

  /// The texts of a list, each with its position.
  std::vector<std::pair<const toml::node*, std::string>> texts(const Entry& entry,
                                                               const std::string& requested) const;

  /// A date such as 2011-11-02, which the file may have in quotes.
  std::string date(const Entry& entry) const;

  /// That an entry is of the wrong kind, and what is `requested`.
  static std::string wrong_kind(const Entry& entry, const std::string& requested);

 private:
  void refuse_crowd(const toml::node& node) const;

  std::string name_;
};

}  // namespace pcor::internal
