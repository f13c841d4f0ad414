#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcor {

/// Key of a JSON result.
struct JsonKey {
  /// Path, for example "flights[].name": [] is each entry of a list, NAME each name of values by name.
  std::string path;
  std::string type;  ///< "number", "text", "true or false", "object"
  std::string unit;  ///< unit of a number ("1": no unit); "UTC" for a time; empty for others
  std::string meaning;
};

/// Values by name, in order: an object in JSON.
template <class Value>
using Named = std::vector<std::pair<std::string, Value>>;

/// Writes described results as JSON, or lists the keys of their JSON.
///
/// The header of a result type defines a function that passes its fields in the order of the JSON: key,
/// value, meaning, and the unit unless the key ends with it.
///
///     template <class Field>
///     void describe(const Statistics& self, Field& field) {
///       field("samples", self.samples, "number of samples");
///       field("bias_hpa", self.bias, "mean residual");
///     }
///
/// A value is a number, a truth value, a text, an enumerator with `to_string`, a described type, a container
/// of these, values by name, an optional (without a value the key is absent) or a pointer (may be null). A
/// description must accept a default-constructed result: the list of keys is made from one.
///
/// JSON is indented by two, has the digits that restore a number, null for NaN and infinity, and U+FFFD for
/// invalid UTF-8.
class JsonWriter {
 public:
  /// @param lists_keys true: lists all keys, also those of empty lists and those that depend on a condition
  explicit JsonWriter(bool lists_keys = false) : lists_keys_(lists_keys) {}

  template <class Value>
  void operator()(std::string_view key, const Value& value, std::string_view meaning,
                  std::string_view unit = {}) {
    write_field(key, meaning, unit, [&] { write(value); });
  }
  template <class Value>
  void operator()(std::string_view key, const std::optional<Value>& value, std::string_view meaning,
                  std::string_view unit = {}) {
    if (has(value.has_value())) (*this)(key, value ? *value : Value{}, meaning, unit);
  }

  /// @param seconds since 1970 UTC, written as "2011-11-17T20:10:00Z"
  void time(std::string_view key, double seconds, std::string_view meaning);

  /// A list of objects. @param describe_one function (item, field)
  template <class Items, class Function>
  void list(std::string_view key, const Items& items, std::string_view meaning,
            const Function& describe_one) {
    write_field(key, meaning, {}, [&] {
      write_list(items, [&](const auto& item) { write_object([&] { describe_one(item, *this); }); });
    });
  }

  /// An object without a type. @param describe_it function (field)
  template <class Function>
  void object(std::string_view key, std::string_view meaning, const Function& describe_it) {
    write_field(key, meaning, {}, [&] { write_object([&] { describe_it(*this); }); });
  }

  /// Whether fields that depend on `condition` are described.
  bool has(bool condition) const { return condition || lists_keys_; }

  /// Values by name. @param names texts, or static metadata with a member `name`
  template <class Names, class Values>
  static auto named(const Names& names, const Values& values) {
    Named<typename Values::value_type> result;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if constexpr (std::is_convertible_v<typename Names::value_type, std::string_view>) {
        result.emplace_back(names[i], values[i]);
      } else {
        result.emplace_back(names[i].name, values[i]);
      }
    }
    return result;
  }

  /// A member of each item, by the name of the item.
  template <class Items, class Item, class Value>
  static Named<Value> named(const Items& items, Value Item::*member) {
    Named<Value> result;
    for (const Item& item : items) result.emplace_back(item.name, item.*member);
    return result;
  }

  /// Writes a value without a key.
  template <class Value>
  void write(const Value& value) {
    if constexpr (IsDescribed<Value>::value) {
      write_object([&] { describe(value, *this); });
    } else if constexpr (std::is_convertible_v<Value, std::string_view>) {
      write_scalar("text", quoted(value));
    } else if constexpr (std::is_pointer_v<Value>) {
      if (value == nullptr && !lists_keys_) return write_scalar("null", "null");
      write(value == nullptr ? std::remove_cv_t<std::remove_pointer_t<Value>>{} : *value);
    } else if constexpr (std::is_enum_v<Value>) {
      write_scalar("text", quoted(to_string(value)));
    } else if constexpr (std::is_same_v<Value, bool>) {
      write_scalar("true or false", value ? "true" : "false");
    } else if constexpr (std::is_floating_point_v<Value>) {
      write_scalar("number", digits(value));
    } else if constexpr (std::is_arithmetic_v<Value>) {
      write_scalar("number", std::to_string(value));
    } else if constexpr (IsNamed<Value>::value) {
      begin('{');
      if (lists_keys_) {
        (*this)("NAME", typename Value::value_type::second_type{}, meaning_, unit_);
      } else {
        for (const auto& [name, each] : value) (*this)(name, each, {});
      }
      end('}');
    } else {
      write_list(value, [&](const auto& item) { write(item); });
    }
  }

  const std::string& text() const { return text_; }
  const std::vector<JsonKey>& keys() const { return keys_; }

 private:
  /// Writes the key; `write_value` writes its value.
  template <class Function>
  void write_field(std::string_view key, std::string_view meaning, std::string_view unit,
                   const Function& write_value) {
    const std::size_t length = path_.size();
    begin_key(key, meaning, unit);
    write_value();
    path_.resize(length);
  }

  template <class Value, class = void>
  struct IsDescribed : std::false_type {};
  template <class Value>
  struct IsDescribed<
      Value, std::void_t<decltype(describe(std::declval<const Value&>(), std::declval<JsonWriter&>()))>>
      : std::true_type {};
  template <class Value, class = void>
  struct IsNamed : std::false_type {};
  template <class Value>
  struct IsNamed<Value, std::void_t<typename Value::value_type::second_type>> : std::true_type {};

  template <class Function>
  void write_object(const Function& describe_it) {
    begin('{');
    if (lists_keys_) write_scalar("object", "");
    describe_it();
    end('}');
  }

  template <class Items, class Function>
  void write_list(const Items& items, const Function& write_one) {
    begin('[');
    if (lists_keys_) {
      path_ += "[]";
      write_one(typename Items::value_type{});
    } else {
      for (const auto& item : items) {
        begin_line();
        write_one(item);
      }
    }
    end(']');
  }

  void begin_key(std::string_view key, std::string_view meaning, std::string_view unit);
  void begin(char bracket);
  void end(char bracket);
  void begin_line();
  void write_scalar(std::string_view type, std::string_view text);
  static std::string quoted(std::string_view text);
  static std::string digits(double number);

  bool lists_keys_;
  std::string text_{};
  std::size_t depth_ = 0;
  std::vector<JsonKey> keys_{};
  std::string path_{};
  std::string_view meaning_{};
  std::string_view unit_{};
};

/// JSON of a described result, and a line break.
template <class Result>
std::string to_json(const Result& result) {
  JsonWriter writer;
  writer.write(result);
  return writer.text() + "\n";
}

/// All keys of the JSON of a result type, in the order in which they are written.
template <class Result>
std::vector<JsonKey> json_keys(const Result& example = {}) {
  JsonWriter writer(true);
  writer.write(example);
  return writer.keys();
}

}  // namespace pcor
