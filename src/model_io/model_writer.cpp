#include <pcor/model_io/model_definition.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/effects/catalogue.hpp>

#include "model_io/model_names.hpp"

namespace pcor {

using namespace internal;

namespace {

// Writes a model file in a layout that is independent of the layout of the file it was read from.
class Writer {
 public:
  std::string write(const ModelDefinition& file) {
    write_head(file);
    write_roles("variables", file.variables);
    write_roles("units", file.units);
    write_output(file);
    write_instrument(file);
    write_policy(file.model.policy);
    write_domain(file.model.domain);
    for (std::size_t i = 0; i < file.model.effects.size(); ++i) write_effect(file, i);
    write_law(file.law);
    write_covariance(file);
    write_uncertainty(file.uncertainty);
    write_provenance(file.provenance);
    return text_;
  }

 private:
  static constexpr std::size_t max_list = 90;

  // Positive zero only: a file restores negative zero as well.
  static bool is_zero(double value) { return value == 0.0 && !std::signbit(value); }

  static std::string number(double value, std::string_view what) {
    if (!std::isfinite(value)) {
      throw Error(Error::Code::definition,
                  fmt::format("the model cannot be written: {} is {}; give it a finite value", one_line(what),
                              value));
    }
    std::string digits = fmt::format("{}", value);  // shortest text that restores the same number
    if (digits.find_first_of(".e") == std::string::npos) digits += ".0";
    return digits;
  }

  static std::string text(std::string_view value) {
    std::string escaped = "\"";
    for (const char letter : value) {
      const auto code = static_cast<unsigned char>(letter);
      if (letter == '"' || letter == '\\') {
        escaped += '\\';
        escaped += letter;
      } else if (letter == '\n') {
        escaped += "\\n";
      } else if (letter == '\t') {
        escaped += "\\t";
      } else if (code < 0x20 || code == 0x7f) {
        escaped += fmt::format("\\u{:04X}", code);
      } else {
        escaped += letter;
      }
    }
    return escaped + '"';
  }

  static std::string key(std::string_view name) {
    const bool bare = !name.empty() && std::all_of(name.begin(), name.end(), [](char letter) {
      return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
             (letter >= '0' && letter <= '9') || letter == '-' || letter == '_';
    });
    return bare ? std::string(name) : text(name);
  }

  static std::string list(const std::vector<std::string>& items) {
    std::string one_row = fmt::format("[{}]", fmt::join(items, ", "));
    if (one_row.size() <= max_list) return one_row;
    return fmt::format("[\n  {},\n]", fmt::join(items, ",\n  "));
  }

  static std::string inline_table(const std::vector<std::string>& items) {
    return items.empty() ? "{}" : fmt::format("{{ {} }}", fmt::join(items, ", "));
  }

  // The heading of the lines that follow; without lines it is not written.
  void heading(std::string_view title) { heading_ = fmt::format("\n{}\n", title); }

  void line(std::string_view name, std::string_view value) {
    text_ += std::exchange(heading_, "") + fmt::format("{} = {}\n", name, value);
  }

  void line_unless_empty(std::string_view name, std::string_view value) {
    if (!value.empty()) line(name, text(value));
  }

  void write_head(const ModelDefinition& file) {
    line("format", text(model_format));
    line_unless_empty("name", file.model.name);
    line_unless_empty("aircraft", file.model.aircraft);
    line_unless_empty("roles", file.roles_from);
  }

  void write_roles(std::string_view title, const std::map<Quantity, std::string>& values) {
    heading(fmt::format("[{}]", title));
    for (const auto& [quantity, value] : values) line(info_of(quantity).name, text(value));
  }

  void write_output(const ModelDefinition& file) {
    heading("[output]");
    for (const auto& [standard_name, name] : file.output) line(key(standard_name), text(name));
  }

  void write_instrument(const ModelDefinition& file) {
    const Model& model = file.model;
    const auto has = [&](Quantity quantity) { return file.variables.count(quantity) != 0; };
    const LamsMounting& lams = model.lams;
    if (has(Quantity::lams_airspeed) || !is_zero(lams.elevation) || !is_zero(lams.azimuth) ||
        lams.approach != LamsApproach::simultaneous) {
      heading("[lams]");
      line("elevation", number(lams.elevation, "elevation of LAMS"));
      line("azimuth", number(lams.azimuth, "azimuth of LAMS"));
      line("approach", fmt::format("{}", static_cast<int>(lams.approach)));
    }
    if (has(Quantity::recovery_temperature) || model.recovery.coefficients != Model().recovery.coefficients ||
        !file.recovery_factor_name.empty()) {
      heading("[temperature]");
      line("recovery_factor", recovery_factor(file));
    }
    if (std::any_of(humidity_roles.begin(), humidity_roles.end(), has) || !model.moist) {
      heading("[humidity]");
      line("moist", model.moist ? "true" : "false");
    }
    write_radome(model);
  }

  // Name of the published law if the coefficients still equal it.
  static std::string recovery_factor(const ModelDefinition& file) {
    const std::array<double, 4>& coefficients = file.model.recovery.coefficients;
    const PublishedRecoveryFactor* law = published_recovery_factor(file.recovery_factor_name);
    if (law != nullptr && law->law.coefficients == coefficients) return text(law->name);
    const std::string what = "the recovery factor";
    if (std::all_of(coefficients.begin() + 1, coefficients.end(), is_zero))
      return number(coefficients[0], what);
    std::vector<std::string> numbers;
    for (const double coefficient : coefficients) numbers.push_back(number(coefficient, what));
    return list(numbers);
  }

  void write_radome(const Model& model) {
    const std::pair<std::string_view, RadomeCalibration> angles[] = {{"attack", model.attack_radome},
                                                                     {"sideslip", model.sideslip_radome}};
    heading("[radome]");
    for (const auto& [name, radome] : angles) {
      if (is_zero(radome.offset) && is_zero(radome.slope) && is_zero(radome.slope_mach)) continue;
      std::vector<std::string> numbers{number(radome.offset, name), number(radome.slope, name)};
      if (!is_zero(radome.slope_mach)) numbers.push_back(number(radome.slope_mach, name));
      line(name, list(numbers));
    }
  }

  void write_policy(const Policy& policy) {
    const Policy none;
    heading("[policy]");
    if (!is_zero(policy.taper_below) || policy.taper_power != none.taper_power) {
      line("taper_below", number(policy.taper_below, "taper_below"));
      line("taper_power", number(policy.taper_power, "taper_power"));
    }
    if (policy.minimum != none.minimum) line("minimum", number(policy.minimum, "the minimum"));
    if (policy.min_dynamic_pressure != none.min_dynamic_pressure)
      line("least_dynamic_pressure", number(policy.min_dynamic_pressure, "least_dynamic_pressure"));
  }

  void write_domain(const std::vector<DomainRange>& domain) {
    heading("[domain]");
    for (const DomainRange& range : domain) {
      line(key(range.quantity), bounds({range.lower, range.upper}, "the domain of " + range.quantity));
    }
  }

  static std::string bounds(const Bounds& range, const std::string& what) {
    return fmt::format("[{}, {}]", number(range.lower, what), number(range.upper, what));
  }

  void write_effect(const ModelDefinition& file, std::size_t effect_number) {
    const ModelEffect& effect = file.model.effects[effect_number];
    const Names names = parameter_names(effect);
    if (names.size() != effect.parameters.size()) {
      throw Error(Error::Code::definition,
                  fmt::format("the model cannot be written: effect {} has {} parameters, not {}; give one "
                              "value for each",
                              quote(effect.id), names.size(), effect.parameters.size()));
    }
    std::vector<std::string> values, standard_errors, fixed, ranges;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string what = effect.id + "." + names[i];
      const ParameterFit fit = file.fit(effect_number, i);
      if (is_usual_shape(effect, i) && fit.fixed && !fit.standard_error && !fit.bounds) continue;
      values.push_back(names[i] + " = " + number(effect.parameters[i], what));
      if (fit.standard_error) {
        standard_errors.push_back(names[i] + " = " + number(*fit.standard_error, "the stderr of " + what));
      }
      if (fit.fixed) fixed.push_back(text(names[i]));
      if (fit.bounds) ranges.push_back(names[i] + " = " + bounds(*fit.bounds, "a bound of " + what));
    }
    heading("[[effect]]");
    line("id", text(effect.id));
    if (effect.is_surface()) {
      write_surface(effect);
    } else if (effect.is_formula()) {
      line("where", text(info_of(effect.location).name));
      line("formula", text(effect.formula));
    }
    if (!effect.scaling.is_none()) line("scaling", inline_table(powers(effect.scaling)));
    if (!effect.is_surface()) line("parameters", inline_table(values));
    if (!standard_errors.empty()) line("stderr", inline_table(standard_errors));
    if (!fixed.empty()) line("fixed", list(fixed));
    if (!ranges.empty()) line("bounds", inline_table(ranges));
    if (effect.is_formula() && !effect.is_surface()) {
      line_unless_empty("unit", effect.unit);
      line_unless_empty("source", effect.source);
    }
  }

  void write_surface(const ModelEffect& effect) {
    std::vector<std::string> axes;
    for (const SurfaceAxis& axis : effect.surface->axes)
      axes.push_back(fmt::format("{} = {}", key(info_of(axis.quantity).name),
                                 bounds({axis.lower, axis.upper}, "an axis of " + effect.id)));
    line("axes", inline_table(axes));
    const std::size_t columns = effect.surface->axes[1].count;
    std::string rows;
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
      rows += i % columns == 0 ? "  [" : ", ";
      rows += number(effect.parameters[i], effect.id);
      if (i % columns == columns - 1) rows += "],\n";
    }
    line("coefficients", "[\n" + rows + "]");
  }

  // Whether a shape has its default value, which the file omits.
  static bool is_usual_shape(const ModelEffect& effect, std::size_t parameter) {
    if (effect.is_formula()) return false;
    const ParameterInfo& info = effect_named(effect.id)->parameters[parameter];
    const double value = effect.parameters[parameter];
    return info.shape && value == info.typical && std::signbit(value) == std::signbit(info.typical);
  }

  static std::vector<std::string> powers(const Scaling& scaling) {
    std::vector<std::string> powers;
    if (scaling.static_pressure != 0)
      powers.push_back(fmt::format("static_pressure = {}", scaling.static_pressure));
    if (scaling.dynamic_pressure != 0)
      powers.push_back(fmt::format("dynamic_pressure = {}", scaling.dynamic_pressure));
    return powers;
  }

  void write_law(const LawInfo& law) {
    heading("[law]");
    line_unless_empty("source", law.source);
    line_unless_empty("valid_from", law.valid_from);
    line_unless_empty("valid_to", law.valid_to);
    if (law.operational) line("in_processing", "true");
    if (law.rms_hpa) line("rms_hpa", number(*law.rms_hpa, "rms_hpa of the law"));
    line_unless_empty("note", law.note);
  }

  // Includes the values at which the covariance was found, so that a later change of them is detected.
  void write_covariance(const ModelDefinition& file) {
    const Covariance& covariance = file.covariance;
    if (covariance.parameters.empty() && covariance.matrix.empty()) return;
    heading("[covariance]");
    std::vector<std::string> names, values;
    for (const std::string& name : covariance.parameters) {
      names.push_back(text(name));
      values.push_back(number(parameter_value(file.model, name), name));
    }
    line("parameters", list(names));
    line("values", list(values));
    std::string rows;
    for (const std::vector<double>& row : covariance.matrix) {
      std::vector<std::string> numbers;
      for (const double value : row) numbers.push_back(number(value, "the covariance"));
      rows += fmt::format("  [{}],\n", fmt::join(numbers, ", "));
    }
    line("matrix", "[\n" + rows + "]");
  }

  void write_uncertainty(const StatedUncertainty& uncertainty) {
    heading("[uncertainty]");
    const auto stated = [this](std::string_view name, double value) {
      line(name, number(value, fmt::format("the uncertainty of {}", name)));
    };
    for (const auto& [role, value] : uncertainty.roles) stated(info_of(role).name, value);
    for (const auto& [coefficient, value] : uncertainty.sensors) stated(key(coefficient), value);
    if (uncertainty.static_defect) stated("static_defect", *uncertainty.static_defect);
    if (uncertainty.static_defect_ratio) stated("static_defect_ratio", *uncertainty.static_defect_ratio);
  }

  void write_provenance(const Provenance& provenance) {
    heading("[provenance]");
    for (const auto& [name, value] : provenance) line(key(name), provenance_value(value));
  }

  static std::string provenance_value(const ProvenanceValue& value) {
    if (const auto* words = std::get_if<std::string>(&value)) return text(*words);
    if (const auto* real = std::get_if<double>(&value)) return number(*real, "a number of its provenance");
    if (const auto* whole = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *whole);
    if (const auto* truth = std::get_if<bool>(&value)) return *truth ? "true" : "false";
    std::vector<std::string> items;
    if (const auto* values = std::get_if<ProvenanceList>(&value)) {
      for (const ProvenanceValue& item : *values) items.push_back(provenance_value(item));
      return list(items);
    }
    for (const auto& [name, item] : std::get<Provenance>(value)) {
      items.push_back(key(name) + " = " + provenance_value(item));
    }
    return inline_table(items);
  }

  std::string text_;
  std::string heading_;
};

}  // namespace

std::string write_model(const ModelDefinition& file) {
  std::string text = Writer().write(file);
  try {
    parse_model(text, "its text");
  } catch (const Error& error) {
    throw Error(error.code(), std::string("the model cannot be written: ") + error.what());
  }
  return text;
}

}  // namespace pcor
