#include <pcor/residuals/reference.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/base/suggest.hpp>
#include "residuals/references/height.hpp"
#include "residuals/references/lams.hpp"
#include "residuals/references/pressure.hpp"
#include "residuals/references/second_system.hpp"
#include "residuals/references/wind.hpp"

namespace pcor {

using namespace internal;

namespace {

using Pointer = std::shared_ptr<const Reference>;

Pointer read_lams(const std::string&, const ModelDefinition& model) {
  if (model.variables.count(Quantity::lams_airspeed) == 0) {
    throw Error(
        Error::Code::model,
        fmt::format("model '{}' names no laser (lams_airspeed); give another --reference: static:OTHER.toml, "
                    "pressure:PS, wind or height ('pcor inspect' proposes one)",
                    model.model.name));
  }
  return lams_reference();
}

/// Second system; its pressures must be named.
ModelDefinition read_system(const std::string& path) {
  ModelDefinition system = read_model(path);
  if (system.variables.count(Quantity::static_pressure) == 0) {
    throw Error(Error::Code::model, fmt::format("{}: the model of a second system must name its pressures; "
                                                "add static_pressure and dynamic_pressure to [variables]",
                                                path));
  }
  return system;
}

bool contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

/// Whether a text is two variables joined by +, and no file.
bool is_pair(const std::string& text) {
  return contains(text, "+") && !contains(text, "/") && !contains(text, ".toml") &&
         !std::filesystem::exists(text);
}

/// Model file, or two variables joined by +, which are not corrected.
Pointer read_total_pressure(const std::string& system, const ModelDefinition& model) {
  if (!is_pair(system)) return total_pressure_reference(read_system(system));
  const std::size_t plus = system.find('+');
  ModelDefinition pair;
  pair.model.name = system;
  pair.roles_from = model.roles_from;
  pair.variables = {{Quantity::static_pressure, system.substr(0, plus)},
                    {Quantity::dynamic_pressure, system.substr(plus + 1)}};
  return total_pressure_reference(std::move(pair));
}

/// Text form of a reference: "form" or, with an argument, "form:argument".
struct Form {
  std::string_view form;
  std::string_view argument;  ///< description; empty: without argument
  std::string_view meaning;
  Pointer (*read)(const std::string& argument, const ModelDefinition& model);
};

/// All references, in their order (`in_order`).
constexpr Form forms[]{
    {"lams", "", "the laser air-motion sensor", read_lams},
    {"static", "OTHER.toml", "a second static system, by its model",
     [](const std::string& file, const ModelDefinition&) {
       if (is_pair(file))
         throw Error(
             Error::Code::usage,
             fmt::format("static:{0} needs a model file; a pair of pressures is --reference total:{0}",
                         file));
       return static_system_reference(read_system(file));
     }},
    {"pressure", "VARIABLE", "a recorded static pressure",
     [](const std::string& variable, const ModelDefinition& model) {
       return pressure_reference(variable, model.variable_of(Quantity::static_pressure));
     }},
    {"total", "OTHER.toml", "the total pressure of a second system, by its model, or of STATIC+DYNAMIC",
     read_total_pressure},
    {"height", "", "hydrostatic heights against GPS in climbs",
     [](const std::string&, const ModelDefinition& model) { return height_reference(model); }},
    {"wind", "", "ground speeds in turns, reverse headings and speed runs",
     [](const std::string&, const ModelDefinition& model) { return wind_reference(model); }},
};

std::string usage_of(const Form& form) {
  return std::string(form.form) + (form.argument.empty() ? "" : fmt::format(":{}", form.argument));
}

/// The form that a text without the right one most likely means; otherwise all forms.
std::string nearest_form(const std::string& text) {
  if (text == "gps" || text == "GPS") return "height or wind";
  if (text == "laser") return "lams";
  const bool has_form = contains(text, ":");
  if (!has_form && is_pair(text)) return "total:" + text;
  if (!has_form && contains(text, ".toml")) return "static:" + text;
  std::vector<std::string> names;
  for (const Form& each : forms) names.emplace_back(each.form);
  const std::vector<std::string> meant = suggest(text.substr(0, text.find(':')), names);
  for (const Form& each : forms) {
    if (!meant.empty() && each.form == meant.front()) return usage_of(each);
  }
  if (!has_form && contains(text, "-")) return "static:" + text;  // a model like c130-psfrd-2003
  if (!has_form &&
      std::any_of(text.begin(), text.end(), [](unsigned char c) { return std::isupper(c) != 0; }))
    return "pressure:" + text;
  return reference_forms();
}

}  // namespace

ModelSamples Reference::read(const Flight&, const std::vector<double>&, Notes&) const { return {}; }

const Reference& first_of(const References& references) {
  if (references.empty())
    throw Error(Error::Code::usage, "there is no reference; give at least one, for example --reference lams");
  return *references.front();
}

Pointer lams_reference() { return std::make_shared<LamsReference>(); }

Pointer static_system_reference(ModelDefinition system) {
  return std::make_shared<SecondSystem>(std::move(system), ComparedPressure::static_pressure);
}

Pointer pressure_reference(std::string variable, std::string of_model) {
  return std::make_shared<PressureReference>(std::move(variable), std::move(of_model));
}

Pointer total_pressure_reference(ModelDefinition system) {
  return std::make_shared<SecondSystem>(std::move(system), ComparedPressure::total_pressure);
}

Pointer height_reference(const ModelDefinition& model) { return std::make_shared<HeightReference>(model); }

Pointer wind_reference(const ModelDefinition& model) { return std::make_shared<WindReference>(model); }

std::string reference_forms() {
  std::string text;
  for (const Form& each : forms) {
    if (&each != std::begin(forms)) text += &each + 1 == std::end(forms) ? " or " : ", ";
    text += fmt::format("{} ({})", usage_of(each), each.meaning);
  }
  return text;
}

std::vector<std::string> reference_beginnings() {
  std::vector<std::string> texts;
  for (const Form& each : forms) texts.push_back(std::string(each.form) + (each.argument.empty() ? "" : ":"));
  return texts;
}

Pointer read_reference(const std::string& text, const ModelDefinition& model) {
  const std::size_t colon = text.find(':');
  const std::string form = text.substr(0, colon);
  const std::string argument = colon == std::string::npos ? "" : text.substr(colon + 1);
  for (const Form& each : forms) {
    const bool fits = each.argument.empty() ? colon == std::string::npos : !argument.empty();
    if (each.form == form && fits) return each.read(argument, model);
  }
  throw Error(Error::Code::usage, fmt::format("unknown reference '{}'; give {}", text, nearest_form(text)));
}

}  // namespace pcor
