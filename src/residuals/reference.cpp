#include <pcor/residuals/reference.hpp>

#include <fmt/format.h>

#include <pcor/words/error.hpp>

namespace pcor {
namespace {

constexpr const char* static_prefix = "static:";
constexpr const char* pressure_prefix = "pressure:";

/// What follows `prefix` in `text`; nothing where the text does not begin with it.
std::optional<std::string> after(const std::string& text, const std::string& prefix) {
  if (text.compare(0, prefix.size(), prefix) != 0) return std::nullopt;
  return text.substr(prefix.size());
}

[[noreturn]] void fail_without_laser(const ModelFile& model, const char* what) {
  throw Error(fmt::format(
      "model '{}': {}; give lams_airspeed its variable in the table [variables], or another reference: "
      "--reference static:OTHER.toml or --reference pressure:VARIABLE",
      model.model.name, what));
}

}  // namespace

std::string Reference::description() const {
  switch (kind) {
    case Kind::lams:
      return "LAMS";
    case Kind::static_system:
      return fmt::format("static system '{}'", system->model.name);
    case Kind::pressure:
      return fmt::format("static pressure {}", variable);
  }
  return {};
}

Reference read_reference(const std::string& text, const ModelFile& model) {
  Reference reference;
  const bool has_laser = model.variables.count(Quantity::lams_airspeed) != 0;
  if (text.empty() || text == "lams") {
    if (!has_laser && text.empty())
      fail_without_laser(model, "it has no laser, so what is it to be held against");
    if (!has_laser) fail_without_laser(model, "it has no laser");
    return reference;
  }
  if (const auto file = after(text, static_prefix); file && !file->empty()) {
    reference.kind = Reference::Kind::static_system;
    reference.system = read_model(*file);
    return reference;
  }
  if (const auto variable = after(text, pressure_prefix); variable && !variable->empty()) {
    reference.kind = Reference::Kind::pressure;
    reference.variable = *variable;
    return reference;
  }
  throw Error(
      fmt::format("reference '{}': it is none; give lams, static:OTHER.toml or pressure:VARIABLE", text));
}

}  // namespace pcor
