#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// Inputs of a model from a flight, including rates of change and the time since the first record. Without
/// `with_laser` the model is used as if it had no laser. Adds notes for the user to `notes`, one sentence
/// each.
/// @throws Error if the model cannot be used, a variable is absent or has no value, or its unit does not fit.
ModelSamples read_model_columns(const Flight& flight, const ModelDefinition& model, bool with_laser,
                                const std::vector<double>& time, Notes& notes);

/// Marks the records with flaps extended by more than `flaps_in`: by the recorded flaps, also on the ground,
/// otherwise inferred from the lift (`find_flaps_by_lift`), where slow records of the take-off and the
/// landing are not marked. Nullopt if the flaps are neither recorded nor determined by the lift.
/// @param model names the static and the dynamic pressure of the flight; other roles are optional
/// @throws Error if a variable cannot be read
std::optional<std::vector<bool>> flaps_extended(const Flight& flight, const ModelDefinition& model);

/// Finds and marks sensors that freeze in the air, among the inputs of a part of the samples, model or
/// reference, and adds notes. @param min_airspeed m/s; slower samples are not used
void mark_frozen(const Flight& flight, FlightSamples& samples, ModelSamples FlightSamples::*part,
                 double min_airspeed);

/// Recorded series with contradictory signs: series that should increase together change in opposite
/// directions, such as the vertical speed and the altitude if one is positive downward, or the heading and
/// the ground track if one is counted in the opposite direction. A sentence for each pair, without full stop.
///
/// The pairs are compared over 10 s in the air; they contradict each other if their correlation is below -0.5
/// in at least ten minutes in which both moved. A missing series is not compared.
/// @param samples with static pressure and airspeed @param min_airspeed m/s; slower samples are not used
Notes contradicting_signs(const FlightSamples& samples, double min_airspeed);

/// Text that is identical for two models with the same inputs from a flight: variables, units, and the
/// quantities that the chain needs. Law and coefficients count only if a column depends on them
/// (`find_parameter_dependent_columns`, `airspeed_along_beam`).
/// @throws Error if the model cannot be used on its roles
std::string inputs_of(const ModelDefinition& model, bool with_laser);

/// Key that is identical if `read_samples` returns the same samples of a flight, and different otherwise
/// except with probability 2^-64.
/// @throws Error as does `inputs_of`
std::uint64_t samples_key(const ModelDefinition& model, const Reference& reference, const MaskOptions& mask);

/// Samples with flaps extended, inferred from the lift of a flight that does not record the flaps.
struct FlapsByLift {
  std::vector<bool> out{};  ///< state of every sample
  double deficit = 0.0;     ///< median relative deficit of the angle of attack with flaps extended
  double deviation = 0.0;   ///< standard deviation of the deficit with flaps retracted
};

/// The angle of attack above the zero-lift angle is proportional to load factor over dynamic pressure, n/q;
/// with flaps extended it is smaller. The relation of the clean wing is fitted to the flight, with a weight
/// that decreases with time, and with the compressibility of the flight: first to samples above the maximum
/// speed with flaps, then to all samples that are likely clean. Its error consists of the error of the fit,
/// with correlated residuals, and 5 % of the lever in n/q.
///
/// A two-state model covers pieces of 20 s: in, for an hour on average, and out, for ten minutes. In the
/// state out the angle is too small by 12 to 80 %, uniformly distributed; in the state in it follows the
/// relation, except for its error and one piece in a thousand with any value. The likelihood ratio of a piece
/// is limited to a factor of 20, since neighbours share their errors, and above the speed limit of the flaps
/// the state out becomes less probable with speed. Flaps are out if the probability is at least 90 %. A
/// sample outside all pieces has the state of the nearest one if that is within 20 s, otherwise it is not
/// marked.
///
/// Nullopt if fewer than 15 pieces are above that speed, or the angle does not increase with n/q.
///
/// @param angle of attack, deg, or ADIFR/QCR, which is linear in it; of every sample
/// @param min_airspeed m/s; slower samples are not used and not marked
std::optional<FlapsByLift> find_flaps_by_lift(const FlightSamples& samples, const std::vector<double>& angle,
                                              double min_airspeed);

}  // namespace pcor::internal
