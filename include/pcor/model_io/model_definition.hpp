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

/// The range that a parameter may take in a fit.
struct Bounds {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// What a model file says of a parameter beyond its value.
struct ParameterFit {
  bool fixed = false;                      ///< a refit leaves it as it is
  std::optional<double> standard_error{};  ///< in the parameter's unit
  std::optional<Bounds> bounds{};          ///< the file's own; without them those of the catalogue hold
};

/// One entry for each parameter of an effect, in their order.
using EffectFit = std::vector<ParameterFit>;

/// Where the law comes from and when it holds. Dates are ISO dates, such as 2011-11-02, or empty.
struct LawInfo {
  std::string source{};
  std::string valid_from{};
  std::string valid_to{};
  bool in_processing = false;  ///< the operator of the aircraft processes flights of these dates with it
  std::optional<double> rms_hpa{};
  std::string note{};

  /// True on a day from `valid_from` to `valid_to`, an ISO date.
  bool holds_on(const std::string& day) const {
    return (valid_from.empty() || valid_from <= day) && (valid_to.empty() || day <= valid_to);
  }
};

/// The covariance of the fitted parameters, which are named like "static-qp.a2". Empty where nothing was
/// fitted.
struct Covariance {
  std::vector<std::string> parameters{};
  std::vector<std::vector<double>> matrix{};
};

/// What the file states of single samples, as standard uncertainties: of roles, in their units, and of what
/// the law leaves of delta-p.
struct StatedUncertainty {
  std::map<Quantity, double> roles{};
  std::optional<double> static_defect{};        ///< hPa
  std::optional<double> static_defect_ratio{};  ///< a part of the static pressure
  /// Of sensors, in place of `ParameterInfo::doubt`, by the coefficients that would correct them, for
  /// example "lams-scale.scale". Zero where the sensor counts as exact.
  std::map<std::string, double> sensors{};
};

struct ProvenanceValue;
using ProvenanceList = std::vector<ProvenanceValue>;
/// How a model came to be: keys with their values, in order.
using Provenance = std::vector<std::pair<std::string, ProvenanceValue>>;

/// A value of the provenance: text, a number, true or false, or several of them. Dates and times of a file
/// are read as text.
struct ProvenanceValue : std::variant<std::string, double, std::int64_t, bool, ProvenanceList, Provenance> {
  using variant::variant;
};

/// A model as its file holds it: what the real-time part needs, and what only files, fits and people need.
struct ModelDefinition {
  Model model;

  std::map<Quantity, std::string> variables{};  ///< the netCDF variable of each role that is used
  /// Whose names complete the variables: a known aircraft, "faam-core", or a file that ends in .toml. Empty:
  /// by the flight's own attributes.
  std::string roles_from{};
  std::map<Quantity, std::string> units{};      ///< units of roles that the model states itself
  std::map<std::string, std::string> output{};  ///< new names of results, by their standard names
  std::string recovery_factor_name{};           ///< of a published law; empty where the file has numbers
  std::vector<EffectFit> fits{};                ///< one for each effect of the model, or fewer
  LawInfo law{};
  Covariance covariance{};
  StatedUncertainty uncertainty{};
  Provenance provenance{};

  /// The roles that have a variable, in the order of the enumeration.
  std::vector<Quantity> roles() const;

  /// What the result with that standard name is called in this model's output. An uncertainty without a name
  /// of its own has that of its result, with `_uncertainty` behind it.
  std::string output_name(std::string_view standard_name) const;

  /// What the file says of parameter number `parameter` of effect number `effect`.
  ParameterFit fit(std::size_t effect, std::size_t parameter) const;

  /// The bounds of that parameter: the file's, else the catalogue's, else none.
  Bounds bounds(std::size_t effect, std::size_t parameter) const;
};

/// How well the model is known, as a loop takes it: the file's covariance, the standard errors of parameters
/// that are not in it, independent of all others, and what the file states of single samples.
ModelUncertainty uncertainty_of(const ModelDefinition& file);

/// The names of an effect's parameters, of the catalogue or of a formula. @throws Error if the effect is
/// neither.
std::vector<std::string> parameter_names(const ModelEffect& effect);

/// The effect of the catalogue called `id` with its neutral parameters. @throws Error with what may have been
/// meant, if there is none.
ModelEffect neutral_effect(std::string_view id);

/// A surface with all coefficients zero, which a refit finds.
/// @param axes each is valid
ModelEffect surface_effect(const std::string& id, const std::array<SurfaceAxis, 2>& axes);

/// Reads a model file. @throws Error "file:line:column: what is wrong; what to do" for whatever the file says
/// that has no meaning: nothing in it is ignored.
ModelDefinition read_model(const std::filesystem::path& path);

/// As `read_model`, for the text of a file. Messages call it `name`.
ModelDefinition parse_model(std::string_view text, std::string_view name);

/// The text of a model file that restores `file` to the last bit. @throws Error if there is no such text: for
/// numbers that are not finite, an unknown effect, parameters that do not match their effect, and whatever
/// else `parse_model` refuses.
std::string write_model(const ModelDefinition& file);

/// Writes a model file, which appears whole or not at all and replaces an older one.
///
/// `inputs` are the files that models were read from. They may hold someone's comments and edits, so they are
/// never written over, under whatever name. @throws Error in that case, if the file cannot be written, and as
/// `write_model`.
void save_model(const ModelDefinition& file, const std::filesystem::path& path,
                const std::vector<std::filesystem::path>& inputs);

}  // namespace pcor
