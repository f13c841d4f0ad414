#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <pcor/model/model.hpp>
#include <pcor/model/quantity.hpp>
#include <pcor/model/uncertainty.hpp>

namespace pcor {

/// Bounds of a parameter in a fit.
struct Bounds {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// Metadata of a parameter in a model file.
struct ParameterFit {
  bool fixed = false;                      ///< not changed by a refit
  std::optional<double> standard_error{};  ///< unit of the parameter
  std::optional<Bounds> bounds{};          ///< bounds in the file; default: catalogue
};

/// One entry for each parameter of an effect, in their order.
using EffectFit = std::vector<ParameterFit>;

/// Source and validity of a model. Dates are ISO dates, such as 2011-11-02, or empty.
struct LawInfo {
  std::string source{};
  std::string valid_from{};
  std::string valid_to{};
  /// Used operationally for flights of these dates by the operator of the aircraft.
  bool operational = false;
  std::optional<double> rms_hpa{};
  std::string note{};

  /// True on a day from `valid_from` to `valid_to`, an ISO date.
  bool is_valid_on(const std::string& day) const {
    return (valid_from.empty() || valid_from <= day) && (valid_to.empty() || day <= valid_to);
  }
};

/// Covariance of the fitted parameters, with names like "static-qp.a2". Empty if no parameter was fitted.
struct Covariance {
  std::vector<std::string> parameters{};
  std::vector<std::vector<double>> matrix{};
};

/// Standard uncertainties of single samples stated in the file: of roles, in their units, and of delta-p
/// after the model.
struct StatedUncertainty {
  std::map<Quantity, double> roles{};
  std::optional<double> static_defect{};        ///< hPa
  std::optional<double> static_defect_ratio{};  ///< fraction of the static pressure
  /// Standard uncertainties of sensors, replacing `ParameterInfo::calibration_uncertainty`, by the
  /// corresponding coefficients, for example "lams-scale.scale". Zero for a sensor that is assumed to be
  /// exact.
  std::map<std::string, double> sensors{};
};

struct ProvenanceValue;
using ProvenanceList = std::vector<ProvenanceValue>;
/// Provenance of a model: keys with their values, in order.
using Provenance = std::vector<std::pair<std::string, ProvenanceValue>>;

/// Value in the provenance: text, a number, true or false, or a list. Dates and times of a file are read as
/// text.
struct ProvenanceValue : std::variant<std::string, double, std::int64_t, bool, ProvenanceList, Provenance> {
  using variant::variant;
};

/// Value of a key; nullptr if the key is missing or its value is not a T.
template <class T>
const T* find_entry(const Provenance& provenance, std::string_view key) {
  for (const auto& [name, value] : provenance) {
    if (name == key) return std::get_if<T>(&value);
  }
  return nullptr;
}

/// Sets a key to a value, at the end.
void set_entry(Provenance& provenance, const std::string& key, ProvenanceValue value);

/// Removes a key and its value, if present.
void erase_entry(Provenance& provenance, std::string_view key);

/// Contents of a model file: the model for the real-time part, and metadata for files, fits and users.
struct ModelDefinition {
  // Defined in the library: the defaults are long code in every file that copies a model.
  ModelDefinition();
  ModelDefinition(const ModelDefinition&);
  ModelDefinition(ModelDefinition&&) noexcept;
  ModelDefinition& operator=(const ModelDefinition&);
  ModelDefinition& operator=(ModelDefinition&&) noexcept;
  ~ModelDefinition();

  Model model;

  std::map<Quantity, std::string> variables{};  ///< netCDF variable of each used role
  /// Naming convention of the other variables: a known aircraft, "faam-core", or a file that ends in .toml.
  /// Empty: detected from the flight's attributes.
  std::string roles_from{};
  std::map<Quantity, std::string> units{};      ///< units of roles stated in the model file
  std::map<std::string, std::string> output{};  ///< new names of results, by their default names
  /// Key of a published formula; empty if the file contains numbers.
  std::string recovery_factor_name{};
  std::vector<EffectFit> fits{};  ///< one for each effect of the model, or fewer
  LawInfo law{};
  Covariance covariance{};
  StatedUncertainty uncertainty{};
  Provenance provenance{};

  /// Roles that have a variable, in the order of the enumeration.
  std::vector<Quantity> roles() const;

  /// Variable of a role; empty if the model names no variable for it.
  std::string variable_of(Quantity role) const;

  /// Output name of the result with that default name. An uncertainty without a separate name has the name of
  /// its result with the suffix `_uncertainty`.
  std::string output_name(std::string_view standard_name) const;

  /// Metadata of parameter number `parameter` of effect number `effect`.
  ParameterFit fit(std::size_t effect, std::size_t parameter) const;

  /// Bounds of that parameter: from the file, otherwise from the catalogue, otherwise infinite.
  Bounds bounds(std::size_t effect, std::size_t parameter) const;
};

/// Uncertainty of a model for a loop: covariance of the file, standard errors of parameters that are not in
/// the covariance (independent of all others), and standard uncertainties of single samples. If the file
/// states any of these, also the calibration of a thermometer of the recovery temperature, with the default
/// 0.3 K and 0.005 (recovery factor) unless the file states it: the uncertainty of the temperature would
/// otherwise be far too small.
ModelUncertainty uncertainty_of(const ModelDefinition& file);

/// Whether the model contains the effect `id`.
bool has_effect(const ModelDefinition& file, std::string_view id);

/// Names of an effect's parameters, from the catalogue or a formula. @throws Error if the effect is neither.
std::vector<std::string> parameter_names(const ModelEffect& effect);

/// Effect `id` of the catalogue with neutral parameters. @throws Error with suggestions, if the id is
/// unknown.
ModelEffect neutral_effect(std::string_view id);

/// Where an effect acts. @param effect a formula, a surface, or an effect whose id is in the catalogue
EffectLocation location_of(const ModelEffect& effect);

/// Whether an effect of the catalogue or a surface changes nothing: all its coefficients are neutral. Shape
/// parameters do not count. False for a formula.
bool is_neutral(const ModelEffect& effect);

/// Surface effect with all coefficients zero, to be fitted. @param axes each must be valid
ModelEffect surface_effect(const std::string& id, const std::array<SurfaceAxis, 2>& axes);

/// Reads a model file. @throws Error "file:line:column: what is wrong; what to do" for every invalid or
/// unknown key.
ModelDefinition read_model(const std::filesystem::path& path);

/// Parses the text of a model file, as `read_model`; `name` replaces the file name in messages.
ModelDefinition parse_model(std::string_view text, std::string_view name);

/// Text of a model file that restores `file` to the last bit. @throws Error if there is no such text: for
/// numbers that are not finite, an unknown effect, parameters that do not match their effect, and other
/// contents that `parse_model` refuses.
std::string write_model(const ModelDefinition& file);

/// Writes a model file atomically, replacing an older one.
///
/// `inputs` are the files from which models were read. They may contain comments and edits of a user, so they
/// are never overwritten, also by another path. @throws Error in that case, if the file cannot be written,
/// and as `write_model`.
void save_model(const ModelDefinition& file, const std::filesystem::path& path,
                const std::vector<std::filesystem::path>& inputs);

}  // namespace pcor
