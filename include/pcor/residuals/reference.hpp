#pragma once

#include <pcor/laws/model_file.hpp>
#include <pcor/residuals/samples.hpp>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace pcor {

namespace internal {
class ModelOnSamples;
class ReferenceOnSamples;
}  // namespace internal

/// What a model is held against.
///
/// Every one says what the static pressure really was, so that what a model is off by, the residual, is
/// p(reference) - p(model) in hPa: positive where delta-p of the model should be larger.
///
/// A new one is a class in a file of its own in src/residuals/references, and a line in the list in
/// src/residuals/reference.cpp.
class Reference {
 public:
  virtual ~Reference() = default;

  /// What it is in words, for example "static system 'C-130 PSFRD/QCFR, equation 18'".
  virtual std::string description() const = 0;

  /// The model that corrects it, whose parameters can be fitted together with those of the model that is held
  /// against it; null where it has none.
  virtual const ModelFile* model() const { return nullptr; }

  /// The same reference with another model of its own; null where it has none. It reads all that the other
  /// model reads.
  virtual std::shared_ptr<const Reference> with_model(ModelFile) const { return nullptr; }

  /// The variables of a flight that it reads for itself, beside those of the model that is held against it.
  virtual std::vector<std::string> variables() const { return {}; }

  /// True where it is made of the laser that the model names.
  virtual bool reads_laser() const { return false; }

  /// Reads its own variables. @throws Error if one is absent, has no value, or its unit does not fit.
  virtual ModelSamples read(const Flight& flight, const std::vector<double>& time,
                            std::vector<std::string>& notes) const;

  /// What it says of every sample. Both arguments must outlive the result.
  virtual std::unique_ptr<internal::ReferenceOnSamples> on(const FlightSamples& samples,
                                                           const internal::ModelOnSamples& model) const = 0;
};

/// What a model is held against at once. The first one decides wherever a single figure is told.
using References = std::vector<std::shared_ptr<const Reference>>;

/// The first. @throws Error if there is none.
const Reference& first_of(const References& references);

/// LAMS: delta-p from the laser airspeed, memo eq. 11, from the same pressures as the model.
std::shared_ptr<const Reference> lams_reference();

/// Another static system of the aircraft, corrected by a model of its own.
std::shared_ptr<const Reference> static_system_reference(ModelFile system);

/// A variable that is a static pressure: of the avionics, or corrected already.
std::shared_ptr<const Reference> pressure_reference(std::string variable);

/// The texts that name a reference, with what each is: "lams (the laser ...), static:OTHER.toml (...) or
/// ...".
std::string reference_forms();

/// The reference that `text` names, see `reference_forms`.
///
/// @throws Error if the text is none of these, the file of a static system cannot be read, or the model of a
/// LAMS comparison has no `lams_airspeed`.
std::shared_ptr<const Reference> read_reference(const std::string& text, const ModelFile& model);

/// What a model is held against, and what it could have been.
struct ChosenReferences {
  References used{};
  std::vector<std::string> not_used{};  ///< where no text named any: which else there are, and why not these
};

/// The references that `texts` name; without texts LAMS.
///
/// @throws Error as `read_reference`, or if there is no text and the flights and the model allow none.
ChosenReferences read_references(const std::vector<std::string>& texts, const ModelFile& model,
                                 const std::vector<std::filesystem::path>& flights);

}  // namespace pcor
