#pragma once

#include <pcor/base/note.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/samples.hpp>

#include <memory>
#include <string>
#include <vector>

namespace pcor {

// Defined in src/residuals: a model, and a reference, on the samples of one flight.
class ModelOnSamples;
class ReferenceOnSamples;

/// Measurement that a model is compared with.
///
/// The residual is in hPa and has the sign of reference minus model. Most references give the static
/// pressure: the residual is positive if delta-p of the model should be larger. Others give a quantity
/// predicted from the pressures, temperature and speed of the model: a total pressure, a difference of
/// heights, a ground speed.
///
/// A new reference is a class in a separate file in src/residuals/references, and a line in the list in
/// src/residuals/reference.cpp.
class Reference {
 public:
  virtual ~Reference() = default;

  /// Description, for example "static system 'C-130 PSFRD/QCFR, equation 18'".
  virtual std::string description() const = 0;

  /// Name in tables and JSON results, as for `--reference`: "lams", "total:PSFRD+QCFR".
  virtual std::string name() const = 0;

  /// True if the residual is the static pressure of the reference minus that of the model.
  virtual bool is_static_pressure() const { return true; }

  /// True if a static defect at the ports changes the residual: false for total pressures, in which it
  /// cancels.
  virtual bool sees_static_defect() const { return true; }

  /// Model that corrects the reference, whose parameters can be fitted with those of the compared model;
  /// nullptr if there is no such model.
  virtual const ModelDefinition* model() const { return nullptr; }

  /// Copy of the reference with another model; nullptr if the reference has no model. It reads all variables
  /// of the other model.
  virtual std::shared_ptr<const Reference> with_model(const ModelDefinition&) const { return nullptr; }

  /// Variables of a flight that the reference reads in addition to those of the compared model.
  virtual std::vector<std::string> variables() const { return {}; }

  /// True if the reference uses the laser named by the model.
  virtual bool reads_laser() const { return false; }

  /// Key of the inputs: equal for two references whose `read` gives equal results for a flight.
  virtual std::string inputs() const { return name(); }

  /// Reads the variables of the reference. @throws Error if one is absent, has no value, or its unit does not
  /// fit.
  virtual ModelSamples read(const Flight& flight, const std::vector<double>& time, Notes& notes) const;

  /// True if the residual depends on one sample only, not on a window of samples.
  virtual bool is_of_one_sample() const { return true; }

  /// Length of the window for a residual that is a difference in time, s: only means over this length are
  /// independent, and a diagnosis uses them. Zero for other residuals.
  virtual double window() const { return 0.0; }

  /// Evaluates the reference at every sample. Both arguments must outlive the result.
  virtual std::unique_ptr<ReferenceOnSamples> on(const FlightSamples& samples,
                                                 const ModelOnSamples& model) const = 0;
};

/// References used together. The first one determines every single figure that is reported.
using References = std::vector<std::shared_ptr<const Reference>>;

/// First reference. @throws Error if there are no references.
const Reference& first_of(const References& references);

/// LAMS: delta-p from the laser airspeed, memo eq. 11, from the same pressures as the model.
std::shared_ptr<const Reference> lams_reference();

/// Another static system of the aircraft, corrected by its model.
std::shared_ptr<const Reference> static_system_reference(ModelDefinition system);

/// Variable that is a static pressure: from the avionics, or already corrected.
/// @param of_model variable of the model's static pressure; the flight gets a warning if the reference is
/// computed from it or described as raw, and an error if it is described as another pressure, such as that of
/// the cabin. If empty, `variable` is not examined.
std::shared_ptr<const Reference> pressure_reference(std::string variable, std::string of_model = "");

/// Total pressure of another pair of the aircraft, corrected by its model: the residual is (p + q) of the
/// pair minus (p + q) of the model, hPa. Static defects cancel; errors of transducers, pitot tubes and total
/// lines of either remain.
std::shared_ptr<const Reference> total_pressure_reference(ModelDefinition system);

/// GPS heights: climb within a minute by the hydrostatic equation, from the pressure, temperature and
/// humidity of the model, minus the climb by GPS, in hPa of the pressure in its middle. Sensitive to the
/// temperature and to static-pressure errors that change in a climb.
///
/// The slope of isobaric surfaces along the track, a few metres per minute, and the height noise are part of
/// the noise. @param model names altitude and latitude, if it has them
std::shared_ptr<const Reference> height_reference(const ModelDefinition& model);

/// Ground speed along the heading: true airspeed of the model minus ground speed, after subtraction of the
/// best-fitting wind of the surrounding quarter of an hour, in hPa of delta-p that would change the airspeed
/// by the same amount. Sensitive to the airspeed if headings are reversed, as in reverse headings and
/// circles, and if it changes, as in speed runs.
///
/// Changes of the wind within the quarter of an hour are part of the noise. @param model names heading and
/// ground velocity, if it has them
std::shared_ptr<const Reference> wind_reference(const ModelDefinition& model);

/// Accepted forms of a reference, each with a description: "lams (the laser ...), static:OTHER.toml (...) or
/// ...".
std::string reference_forms();

/// Beginnings of these forms, such as "lams" or "static:", in the order of references (`in_order`).
std::vector<std::string> reference_beginnings();

/// Reference named by `text`, see `reference_forms`.
///
/// @throws Error if the text has another form, the file of a static system cannot be read, or the
/// model of a LAMS comparison has no `lams_airspeed`.
std::shared_ptr<const Reference> read_reference(const std::string& text, const ModelDefinition& model);

}  // namespace pcor
