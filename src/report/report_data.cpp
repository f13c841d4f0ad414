#include <fmt/format.h>
#include <openssl/evp.h>
#include <pcor/base/error.hpp>
#include <pcor/base/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "report/columns.hpp"
#include "report/report_data.hpp"

namespace pcor {

// Items and their parts whose JSON has the names of members.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReportLine, slope, offset, label)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReportBar, label, value, error)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReportCurve, label, x, y, error)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReportDot, value, error)
NLOHMANN_JSON_SERIALIZE_ENUM(ReportTone, {{ReportTone::none, ""},
                                          {ReportTone::good, "good"},
                                          {ReportTone::bad, "bad"},
                                          {ReportTone::open, "open"}})
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReportDotRow, label, dots, text, tone)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReportInterval, name, begin, end)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TimePanel, columns, axis, uncertainty, averaging_time)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BinnedPanel, columns, x_choices, autocorrelation_time, axis)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PlanePanel, x, y, colour)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PairPanel, x, y, lines)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RegimeTable, columns)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BarPanel, bars, axis, unit)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CurvePanel, curves, x_axis, axis, x_unit, unit)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TrackPanel, latitude, longitude, colour, diverging)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StripPanel, columns)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RegimePanel, columns, axis)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(QuantilePanel, columns, axis)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DotPanel, series, rows, lines, axis, unit, band)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WhatIfCoefficient, name, unit, given, start, minimum, maximum, fixed,
                                   argument)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WhatIfCommands, add, model, with, refit, stem)

// The page reads the products as bytes of little-endian doubles.
inline void to_json(nlohmann::json& json, const WhatIfSums& sums) {
  json = {{"products", internal::report::base64(sums.products.data(), sums.products.size() * sizeof(double))},
          {"samples", sums.samples}};
}

inline void to_json(nlohmann::json& json, const WhatIfWeights& weights) {
  json = {{"effects", weights.effects},
          {"parts", weights.parts},
          {"scores", WhatIfSums{weights.score_covariance, 0.0}}};
}

inline void to_json(nlohmann::json& json, const WhatIfEffect& effect) {
  json = {{"id", effect.id},
          {"title", effect.title},
          {"why", effect.why},
          {"standsFor", effect.stands_for ? nlohmann::json(*effect.stands_for) : nlohmann::json()},
          {"first", effect.first},
          {"count", effect.count},
          {"argument", effect.argument},
          {"isFormula", effect.is_formula},
          {"note", effect.note}};
}

}  // namespace pcor

namespace pcor::internal::report {

namespace {

using nlohmann::json;

// Compact encoding of numbers near their predecessors: differences with the sign as the last bit, in bytes of
// seven bits whose last one has no eighth bit; a difference of zero is followed by a repeat count; all in
// base64.
std::string packed(const std::vector<std::uint32_t>& numbers) {
  constexpr std::uint64_t seven_bits = 127;
  std::vector<std::uint8_t> bytes;
  const auto put = [&bytes](std::uint64_t number) {
    for (; number > seven_bits; number >>= 7U)
      bytes.push_back(static_cast<std::uint8_t>((number & seven_bits) | 128U));
    bytes.push_back(static_cast<std::uint8_t>(number));
  };
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < numbers.size();) {
    const std::uint32_t number = numbers[i];
    put(number >= before ? 2 * std::uint64_t{number - before} : 2 * std::uint64_t{before - number} - 1);
    const bool is_same = number == before;
    before = number;
    const std::size_t next = ++i;
    while (is_same && i < numbers.size() && numbers[i] == number) ++i;
    if (is_same) put(i - next);
  }
  return base64(bytes.data(), bytes.size());
}

constexpr double all_steps = 65534.0;   // steps between the minimum and the maximum of a column
constexpr double steps_along = 4094.0;  // steps of a column used along axes only

// 65535 is missing; any other number n is `minimum` + n * `step`.
json quantised(const ReportColumn& column, double steps = all_steps) {
  constexpr std::uint32_t missing = 65535;
  double minimum = std::numeric_limits<double>::infinity(), maximum = -minimum;
  for (const double value : column.values)
    if (std::isfinite(value)) {
      minimum = std::min(minimum, value);
      maximum = std::max(maximum, value);
    }
  if (minimum > maximum) minimum = maximum = 0.0;
  const double step = maximum > minimum ? (maximum - minimum) / steps : 1.0;
  std::vector<std::uint32_t> numbers;
  numbers.reserve(column.values.size());
  for (const double value : column.values)
    numbers.push_back(std::isfinite(value) ? static_cast<std::uint32_t>(std::lround((value - minimum) / step))
                                           : missing);
  return {{"name", column.name}, {"title", column.title.empty() ? column.name : column.title},
          {"unit", column.unit}, {"least", minimum},
          {"step", step},        {"values", packed(numbers)}};
}

// Columns that items show, each with whether it needs the full resolution; along an axis the resolution is a
// pixel. A key of a new panel that names columns belongs in one of the two lists.
std::map<std::string, bool> shown_columns(const json& items) {
  std::map<std::string, bool> shown;
  for (const json& item : items) {
    const auto insert = [&](std::initializer_list<const char*> keys, bool is_full) {
      for (const char* const key : keys) {
        const json found = item.value(key, json::array());
        for (const json& name : found.is_array() ? found : json::array({found})) {
          if (!name.is_string() || name.get_ref<const std::string&>().empty()) continue;
          bool& full = shown[name];
          full = full || is_full;
        }
      }
    };
    insert({"x_choices", "latitude", "longitude", "x", "y"}, item["kind"] == "pair");
    insert({"columns", "uncertainty", "colour", "residual"}, true);
  }
  return shown;
}

void check_columns(const Report& report, const std::map<std::string, bool>& shown) {
  std::set<std::string> names;
  for (const ReportColumn& column : report.columns) {
    if (!names.insert(column.name).second || column.values.size() != report.time.size())
      throw Error(Error::Code::usage,
                  fmt::format("report: column '{}' occurs twice or has {} values for {} samples; correct it",
                              column.name, column.values.size(), report.time.size()));
  }
  for (const auto& [name, full] : shown) {
    if (names.count(name) == 0)
      throw Error(Error::Code::usage,
                  fmt::format("report: a picture shows column '{}', which is absent; add it", name));
  }
}

// Flights with the time of their samples: `start` in seconds since 1970, and the milliseconds between
// successive samples, beginning with the difference between the first one and the start.
json flights(const Report& report) {
  constexpr double max_time = std::numeric_limits<std::uint32_t>::max();
  const std::vector<std::size_t> bounds = flight_bounds(report);
  json all = json::array();
  for (std::size_t flight = 0; flight + 1 < bounds.size(); ++flight) {
    if (bounds[flight] == bounds[flight + 1]) continue;
    const double start = report.time[bounds[flight]];
    std::vector<std::uint32_t> steps;
    double before = 0.0;
    for (std::size_t i = bounds[flight]; i < bounds[flight + 1]; ++i) {
      const double milliseconds = std::round((report.time[i] - start) * 1000.0);
      if (!(milliseconds >= before && milliseconds <= max_time))
        throw Error(
            Error::Code::usage,
            fmt::format("report: times of flight {} do not increase or span over 49 days; begin a new "
                        "flight in flight_starts",
                        flight + 1));
      steps.push_back(static_cast<std::uint32_t>(milliseconds - before));
      before = milliseconds;
    }
    all.push_back({{"name", report.flight_names.empty() ? "" : report.flight_names.at(flight)},
                   {"start", start},
                   {"milliseconds", packed(steps)}});
  }
  return all;
}

// Samples at which the columns are kept, of those with a value in all columns: all if the report has up to
// 64,000 of them; otherwise every second (third ...) of each flight, and its last one.
std::vector<std::uint32_t> what_if_points(const WhatIfPanel& panel, const Report& report) {
  constexpr std::size_t max_points = 64000;
  const std::vector<std::size_t> bounds = flight_bounds(report);
  std::vector<std::vector<std::uint32_t>> known(bounds.size() - 1);
  std::size_t count = 0;
  for (std::size_t flight = 0; flight < known.size(); ++flight) {
    for (std::size_t i = bounds[flight]; i < bounds[flight + 1]; ++i) {
      if (std::all_of(panel.coefficients.begin(), panel.coefficients.end(),
                      [i](const WhatIfCoefficient& each) { return std::isfinite(each.column[i]); }))
        known[flight].push_back(static_cast<std::uint32_t>(i));
    }
    count += known[flight].size();
  }
  const std::size_t step = std::max<std::size_t>(1, (count + max_points - 1) / max_points);
  std::vector<std::uint32_t> points;
  for (const std::vector<std::uint32_t>& of_flight : known) {
    for (std::size_t k = 0; k < of_flight.size(); ++k)
      if (k % step == 0 || k + 1 == of_flight.size()) points.push_back(of_flight[k]);
  }
  return points;
}

// Points of the columns, and their values there.
json what_if_columns(const WhatIfPanel& panel, const Report& report) {
  const std::vector<std::uint32_t> points = what_if_points(panel, report);
  json columns = json::array();
  for (const WhatIfCoefficient& coefficient : panel.coefficients) {
    ReportColumn column;
    for (const std::uint32_t i : points) column.values.push_back(coefficient.column[i]);
    const json kept = quantised(column);
    columns.push_back({{"least", kept["least"]}, {"step", kept["step"]}, {"values", kept["values"]}});
  }
  return {{"points", packed(points)}, {"columns", std::move(columns)}};
}

// Content of an item, without its title.
struct ItemJson {
  const Report& report;

  template <class Panel>
  json operator()(const Panel& panel) const {
    return panel;
  }
  json operator()(const WhatIfPanel& panel) const {
    json item{{"residual", panel.residual},
              {"start", panel.start},
              {"isStartFitted", panel.is_start_fitted},
              {"coefficients", panel.coefficients},
              {"own", panel.model_coefficient_count},
              {"effects", panel.effects},
              {"x_choices", panel.x_choices},
              {"autocorrelation_time", panel.autocorrelation_time},
              {"weights", panel.weights},
              {"alike", panel.unweighted},
              {"outliers", panel.outliers},
              {"heldOut", panel.held_out},
              {"noise", panel.noise},
              {"noiseLabel", panel.noise_label},
              {"commands", panel.commands}};
    item.update(what_if_columns(panel, report));
    return item;
  }
  json operator()(const ReportTable&) const { return json::object(); }
  json operator()(const ReportText&) const { return json::object(); }
};

/// Escapes characters that a terminal or a page would interpret.
void show_texts(json& data) {
  if (data.is_string()) {
    data = pcor::sanitize_text(data.get_ref<const std::string&>());
  } else if (data.is_structured()) {
    for (json& each : data) show_texts(each);
  }
}

}  // namespace

const char* kind_of(const ReportItem& item) {
  constexpr const char* kinds[] = {"time",      "binned", "plane",   "pair",  "regimes",
                                   "bars",      "curves", "track",   "strip", "byregime",
                                   "quantiles", "dots",   "what-if", "table", "text"};
  static_assert(std::size(kinds) == std::variant_size_v<ReportItem>);
  return kinds[item.index()];
}

std::string base64(const void* bytes, std::size_t count) {
  std::string text((count + 2) / 3 * 4 + 1, '\0');  // EVP_EncodeBlock adds a final zero
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), static_cast<const unsigned char*>(bytes),
                  static_cast<int>(count));
  text.pop_back();
  return text;
}

std::string data_json(const Report& report) {
  json items = json::array();
  for (const ReportItem& item : report.items) {
    json one = std::visit(ItemJson{report}, item);
    if (!one.empty()) one["title"] = std::visit([](const auto& panel) { return panel.title; }, item);
    one["kind"] = kind_of(item);
    items.push_back(std::move(one));
  }
  const std::map<std::string, bool> shown = shown_columns(items);
  check_columns(report, shown);
  json columns = json::array();
  for (const ReportColumn& column : report.columns) {
    const auto found = shown.find(column.name);
    columns.push_back(quantised(column, found == shown.end() || found->second ? all_steps : steps_along));
  }
  json data{{"flights", flights(report)},
            {"columns", std::move(columns)},
            {"intervals", report.intervals},
            {"items", std::move(items)}};
  show_texts(data);
  std::string text = data.dump(-1, ' ', false, json::error_handler_t::replace);
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at))
    text.replace(at, 1, "\\u003c");
  return text;
}

}  // namespace pcor::internal::report
