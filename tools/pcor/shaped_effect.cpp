#include "shaped_effect.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <sstream>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/effects/static_surface.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/roles/add_effects.hpp>

namespace pcor::tool {
namespace {

double number_in(const std::string& text, const std::string& argument) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, status] = std::from_chars(text.data(), end, value);
  if (status != std::errc() || rest != end)
    throw Error(Error::Code::usage,
                fmt::format("{}: '{}' is not a number; write NAME=NUMBER", argument, text));
  return value;
}

int power_in(const std::string& text, const std::string& argument) {
  const double power = number_in(text, argument);
  if (power != std::floor(power) || std::abs(power) > max_power) {
    throw Error(Error::Code::usage, fmt::format("{}: a power must be a whole number from {} to {}, not {}",
                                                argument, -max_power, max_power, text));
  }
  return static_cast<int>(power);
}

void set_shape(ModelEffect& effect, const std::string& name, const std::string& value,
               const std::string& argument) {
  if (name == "static_pressure") {
    effect.scaling.static_pressure = power_in(value, argument);
    return;
  }
  if (name == "dynamic_pressure") {
    effect.scaling.dynamic_pressure = power_in(value, argument);
    return;
  }
  const EffectInfo& info = *effect_named(effect.id);
  std::vector<std::string_view> shapes;
  for (std::size_t i = 0; i < info.parameter_count(); ++i) {
    if (!info.parameters[i].shape) continue;
    const ParameterInfo& shape = info.parameters[i];
    if (shape.name == name) {
      effect.parameters[i] = number_in(value, argument);
      if (effect.parameters[i] >= shape.lower && effect.parameters[i] <= shape.upper) return;
      throw Error(Error::Code::usage, fmt::format("{}: {} = {} is outside [{}, {}]; give a value inside",
                                                  argument, name, value, shape.lower, shape.upper));
    }
    shapes.push_back(shape.name);
  }
  shapes.insert(shapes.end(), {"static_pressure", "dynamic_pressure"});
  throw Error(Error::Code::usage, fmt::format("{}: '{}' is not a shape parameter of the effect {}; use {}",
                                              argument, name, effect.id, fmt::join(shapes, ", ")));
}

}  // namespace

std::string argument_of(const ModelEffect& effect) {
  std::vector<std::string> shapes;
  if (!effect.is_formula()) {
    const EffectInfo& info = *effect_named(effect.id);
    for (std::size_t i = 0; i < info.parameter_count(); ++i) {
      const ParameterInfo& parameter = info.parameters[i];
      if (parameter.shape && effect.parameters[i] != parameter.typical)
        shapes.push_back(fmt::format("{}={}", parameter.name, effect.parameters[i]));
    }
  }
  if (effect.scaling.static_pressure != 0)
    shapes.push_back(fmt::format("static_pressure={}", effect.scaling.static_pressure));
  if (effect.scaling.dynamic_pressure != 0)
    shapes.push_back(fmt::format("dynamic_pressure={}", effect.scaling.dynamic_pressure));
  return effect.id + (shapes.empty() ? "" : ":") + fmt::format("{}", fmt::join(shapes, ","));
}

std::optional<ModelEffect> surface_argument(const std::string& argument, const Flight* flight,
                                            const ModelDefinition& model) {
  const std::size_t colon = argument.find(':');
  const std::string id = argument.substr(0, colon);
  if (surface_named(id) == nullptr) return std::nullopt;
  if (flight == nullptr)
    throw Error(Error::Code::usage,
                fmt::format("{}: the knots of a surface are chosen from a flight; give --flight IN.nc", id));
  const auto the_flight = [flight](std::size_t) -> const Flight& { return *flight; };
  if (colon == std::string::npos) return surface_over(1, the_flight, model, id);
  constexpr std::string_view requested = "splines=";
  const std::string shape = argument.substr(colon + 1);
  const double splines =
      shape.rfind(requested, 0) == 0 ? number_in(shape.substr(requested.size()), argument) : 0.0;
  if (!(splines >= SurfaceAxis::min_count && splines <= SurfaceAxis::max_count))
    throw Error(Error::Code::usage,
                fmt::format("{}: '{}' is not a key of a surface; give splines= and a number from {} to {}",
                            argument, shape, SurfaceAxis::min_count, SurfaceAxis::max_count));
  return surface_over(1, the_flight, model, id, static_cast<std::size_t>(splines));
}

ModelEffect shaped_effect(const std::string& argument) {
  std::istringstream text(argument);
  std::string id;
  std::getline(text, id, ':');
  ModelEffect effect = neutral_effect(id);
  for (std::string shape; std::getline(text, shape, ',');) {
    const std::size_t sign = shape.find('=');
    if (sign == std::string::npos)
      throw Error(Error::Code::usage,
                  fmt::format("{}: '{}' is not a shape; write {}:NAME=NUMBER", argument, shape, id));
    set_shape(effect, shape.substr(0, sign), shape.substr(sign + 1), argument);
  }
  return effect;
}

}  // namespace pcor::tool
