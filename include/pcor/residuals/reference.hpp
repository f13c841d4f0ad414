#pragma once

#include <pcor/laws/model_file.hpp>

#include <optional>
#include <string>

namespace pcor {

/// What a model is held against.
///
/// Every kind says what the static pressure really was, so that what a model is off by, the residual, is
/// p(reference) - p(model) in hPa: positive where delta-p of the model should be larger.
struct Reference {
  enum class Kind {
    lams,           ///< delta-p from the laser airspeed, memo eq. 11, from the same pressures
    static_system,  ///< another static system of the aircraft, corrected by a model of its own
    pressure        ///< a variable that is a static pressure: of the avionics, or corrected already
  };

  Kind kind = Kind::lams;
  std::optional<ModelFile> system{};  ///< of a static system
  std::string variable{};             ///< of a pressure

  /// What it is in words, for example "static system 'C-130 PSFRD/QCFR, equation 18'".
  std::string description() const;
};

/// The reference that `text` names: "lams", "static:OTHER.toml" or "pressure:VARIABLE". An empty text is
/// LAMS where `model` has a laser airspeed.
///
/// @throws Error if the text is none of these, the file of a static system cannot be read, the model of a
/// LAMS comparison has no `lams_airspeed`, or the text is empty and there is no laser.
Reference read_reference(const std::string& text, const ModelFile& model);

}  // namespace pcor
