#include <pcor/report/json.hpp>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include <pcor/base/utc.hpp>

namespace pcor {
namespace {

/// Ends of keys with their units; an end that is the end of another one follows it.
constexpr std::array<std::array<std::string_view, 2>, 9> units{{{"_hpa", "hPa"},
                                                                {"_degc", "degC"},
                                                                {"_deg", "deg"},
                                                                {"_hz", "Hz"},
                                                                {"_m_per_minute", "m/min"},
                                                                {"_m_s", "m/s"},
                                                                {"_m", "m"},
                                                                {"_k", "K"},
                                                                {"_s", "s"}}};

/// Unit of a number: the given one, or the one with which the last key of the path ends.
std::string_view unit_of(std::string_view path, std::string_view given) {
  if (!given.empty()) return given;
  while (path.size() > 2 && path.substr(path.size() - 2) == "[]") path.remove_suffix(2);
  const auto ends = [path](const auto& unit) {
    return path.size() > unit[0].size() && path.substr(path.size() - unit[0].size()) == unit[0];
  };
  const auto found = std::find_if(units.begin(), units.end(), ends);
  return found == units.end() ? "1" : (*found)[1];
}

}  // namespace

void JsonWriter::time(std::string_view key, double seconds, std::string_view meaning) {
  (*this)(key, utc_text(seconds, "%Y-%m-%dT%H:%M:%SZ"), meaning, "UTC");
}

void JsonWriter::begin_key(std::string_view key, std::string_view meaning, std::string_view unit) {
  begin_line();
  text_ += quoted(key) + ": ";
  meaning_ = meaning;
  unit_ = unit;
  path_ += (path_.empty() ? "" : ".") + std::string(key);
}

void JsonWriter::begin(char bracket) {
  text_ += bracket;
  ++depth_;
}

void JsonWriter::end(char bracket) {
  --depth_;
  if (text_.back() != '[' && text_.back() != '{') text_ += "\n" + std::string(2 * depth_, ' ');
  text_ += bracket;
}

void JsonWriter::begin_line() {
  if (text_.empty()) return;
  if (text_.back() != '[' && text_.back() != '{') text_ += ',';
  text_ += "\n" + std::string(2 * depth_, ' ');
}

void JsonWriter::write_scalar(std::string_view type, std::string_view text) {
  text_ += text;
  if (lists_keys_ && !path_.empty()) {
    const bool is_number = type == "number";
    keys_.push_back({path_, std::string(type), std::string(is_number ? unit_of(path_, unit_) : unit_),
                     std::string(meaning_)});
  }
}

std::string JsonWriter::quoted(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string JsonWriter::digits(double number) { return nlohmann::json(number).dump(); }

}  // namespace pcor
