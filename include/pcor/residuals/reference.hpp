#pragma once

#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/samples.hpp>

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
/// The residual, what a model is off by, is in hPa and has the sign of the reference less the model. Most
/// references say what the static pressure really was: the residual is positive where delta-p of the model
/// should be larger. Others say something else that the pressures, the temperature and the speed of a model
/// let expect: a total pressure, a difference of heights, a speed over the ground.
///
/// A new one is a class in a file of its own in src/residuals/references, and a line in the list in
/// src/residuals/reference.cpp.
class Reference {
 public:
  virtual ~Reference() = default;

  /// What it is in words, for example "static system 'C-130 PSFRD/QCFR, equation 18'".
  virtual std::string description() const = 0;

  /// Its name in tables and in JSON results, as `--reference` takes it: "lams", "total:PSFRD+QCFR".
  virtual std::string name() const = 0;

  /// True where the residual is the static pressure of the reference less that of the model.
  virtual bool is_static_pressure() const { return true; }

  /// True where a static defect at the ports changes its residual: not of total pressures, in which it
  /// cancels.
  virtual bool sees_static_defect() const { return true; }

  /// The model that corrects it, whose parameters can be fitted together with those of the model that is held
  /// against it; null where it has none.
  virtual const ModelDefinition* model() const { return nullptr; }

  /// The same reference with another model of its own; null where it has none. It reads all that the other
  /// model reads.
  virtual std::shared_ptr<const Reference> with_model(const ModelDefinition&) const { return nullptr; }

  /// The variables of a flight that it reads for itself, beside those of the model that is held against it.
  virtual std::vector<std::string> variables() const { return {}; }

  /// True where it is made of the laser that the model names.
  virtual bool reads_laser() const { return false; }

  /// A text that is the same for two references whose `read` gives the same of a flight.
  virtual std::string inputs() const { return name(); }

  /// Reads its own variables. @throws Error if one is absent, has no value, or its unit does not fit.
  virtual ModelSamples read(const Flight& flight, const std::vector<double>& time,
                            std::vector<std::string>& notes) const;

  /// True where its residual is of one sample alone, not of many around it.
  virtual bool is_of_one_sample() const { return true; }

  /// Where its residual is a difference over so long a time, s: means over as much tell each
  /// something new, and what a diagnosis holds against a model. Zero where it is no such difference.
  virtual double window() const { return 0.0; }

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
std::shared_ptr<const Reference> static_system_reference(ModelDefinition system);

/// A variable that is a static pressure: of the avionics, or corrected already.
std::shared_ptr<const Reference> pressure_reference(std::string variable);

/// The total pressure of another pair of the aircraft, corrected by a model of its own: the residual is
/// (p + q) of the pair less (p + q) of the model, hPa. Static defects cancel; errors of transducers, pitot
/// tubes and total lines of either remain.
std::shared_ptr<const Reference> total_pressure_reference(ModelDefinition system);

/// The heights of GPS: by how much the height that pressure, temperature and humidity of the model say the
/// aircraft climbed within a minute (hydrostatic equation) departs from that of GPS, in hPa of the pressure
/// at its end. It sees the temperature and errors of the static pressure that change in a climb.
///
/// What it cannot know stays in its noise: the slope of surfaces of one pressure along the track, some metres
/// in a minute, and the noise of the heights. @param model names altitude and latitude, where it does
std::shared_ptr<const Reference> height_reference(const ModelDefinition& model);

/// The speed over the ground along the heading: the true airspeed of the model less the speed over the
/// ground, without what a wind of the quarter of an hour around it makes of that by the headings flown, in
/// hPa of delta-p that would change the airspeed as much. It sees the airspeed where headings are turned, as
/// in reverse headings and circles, and where it changes, as in speed runs.
///
/// What it cannot know stays in its noise: how the wind changes within the quarter of an hour. @param model
/// names heading and ground velocity, where it does
std::shared_ptr<const Reference> wind_reference(const ModelDefinition& model);

/// The texts that name a reference, with what each is: "lams (the laser ...), static:OTHER.toml (...) or
/// ...".
std::string reference_forms();

/// The reference that `text` names, see `reference_forms`.
///
/// @throws Error if the text is none of these, the file of a static system cannot be read, or the model of a
/// LAMS comparison has no `lams_airspeed`.
std::shared_ptr<const Reference> read_reference(const std::string& text, const ModelDefinition& model);

}  // namespace pcor
