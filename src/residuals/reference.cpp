#include <pcor/residuals/reference.hpp>

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>

#include <pcor/words/error.hpp>
#include "residuals/references/lams.hpp"
#include "residuals/references/pressure.hpp"
#include "residuals/references/static_system.hpp"

namespace pcor {

using namespace internal;

namespace {

using Pointer = std::shared_ptr<const Reference>;

Pointer read_lams(const std::string&, const ModelFile& model) {
  if (model.variables.count(Quantity::lams_airspeed) == 0) {
    throw Error(
        fmt::format("model '{}' has no lams_airspeed; give it its variable in the table [variables], or "
                    "another reference: --reference static:OTHER.toml or --reference pressure:VARIABLE",
                    model.model.name));
  }
  return lams_reference();
}

/// How a text names a reference: "form" or, where it takes an argument, "form:argument".
struct Form {
  std::string_view form;
  std::string_view argument;  ///< in words; empty: it takes none
  std::string_view meaning;
  Pointer (*read)(const std::string& argument, const ModelFile& model);
};

/// All references.
constexpr std::array<Form, 3> forms{{
    {"lams", "", "the laser air-motion sensor; the default", read_lams},
    {"static", "OTHER.toml", "a second static system, by its model",
     [](const std::string& file, const ModelFile&) { return static_system_reference(read_model(file)); }},
    {"pressure", "VARIABLE", "a recorded static pressure",
     [](const std::string& variable, const ModelFile&) { return pressure_reference(variable); }},
}};

}  // namespace

ModelSamples Reference::read(const Flight&, const std::vector<double>&, std::vector<std::string>&) const {
  return {};
}

const Reference& first_of(const References& references) {
  if (references.empty()) throw Error("nothing to hold the model against; give at least one reference");
  return *references.front();
}

void ReferenceOnSamples::mark_not_believed(std::vector<Mask>&, const std::vector<double>&,
                                           const MaskOptions&) const {}

Pointer lams_reference() { return std::make_shared<LamsReference>(); }

Pointer static_system_reference(ModelFile system) {
  return std::make_shared<StaticSystemReference>(std::move(system));
}

Pointer pressure_reference(std::string variable) {
  return std::make_shared<PressureReference>(std::move(variable));
}

std::string reference_forms() {
  std::string text;
  for (const Form& each : forms) {
    if (&each != &forms.front()) text += &each == &forms.back() ? " or " : ", ";
    text += each.form;
    if (!each.argument.empty()) text += fmt::format(":{}", each.argument);
    text += fmt::format(" ({})", each.meaning);
  }
  return text;
}

Pointer read_reference(const std::string& text, const ModelFile& model) {
  const std::size_t colon = text.find(':');
  const std::string form = text.substr(0, colon);
  const std::string argument = colon == std::string::npos ? "" : text.substr(colon + 1);
  for (const Form& each : forms) {
    const bool fits = each.argument.empty() ? colon == std::string::npos : !argument.empty();
    if (each.form == form && fits) return each.read(argument, model);
  }
  throw Error(fmt::format("unknown reference '{}'; give {}", text, reference_forms()));
}

ChosenReferences read_references(const std::vector<std::string>& texts, const ModelFile& model,
                                 const std::vector<std::filesystem::path>&) {
  ChosenReferences chosen;
  for (const std::string& text : texts) chosen.used.push_back(read_reference(text, model));
  if (texts.empty()) chosen.used.push_back(read_reference("lams", model));
  return chosen;
}

}  // namespace pcor
