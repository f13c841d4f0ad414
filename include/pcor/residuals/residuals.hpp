#pragma once

#include <pcor/flight/flight.hpp>
#include <pcor/laws/model_file.hpp>
#include <pcor/regimes/regimes.hpp>
#include <pcor/residuals/reference.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// Why a sample takes no part in a comparison. The first reason that holds counts.
enum class Mask : std::uint8_t {
  none,            ///< it takes part
  excluded,        ///< the user excluded its time
  missing,         ///< a variable that the model reads has no value
  ground,          ///< the aircraft stands, taxis or rolls
  low_speed,       ///< airspeed below the limit
  flaps,           ///< flaps are out
  regime,          ///< the user excluded the regime
  reference,       ///< a variable of the reference has no value; the laser is off
  laser_unlocked,  ///< the laser airspeed is far from that of the pressures
  impossible,      ///< the values are there, but no delta-p follows from them
  count
};

inline constexpr std::size_t mask_count = static_cast<std::size_t>(Mask::count);

struct MaskFacts {
  std::string_view name;     ///< as in JSON, for example "low_speed"
  std::string_view meaning;  ///< in words that follow a number of samples
};

extern const std::array<MaskFacts, mask_count> mask_facts;

/// For messages: the reasons why samples are not used, the largest first: "1203 on the ground, 17 laser ...".
std::string mask_text(const std::array<std::size_t, mask_count>& counts);

/// Which samples take part in a comparison.
struct MaskOptions {
  double least_airspeed = 60.0;       ///< m/s; an aircraft flies above it
  double most_flaps = 5.0;            ///< percent, where the flight records flaps
  double most_laser_departure = 8.0;  ///< m/s between the laser airspeed and that of the pressures
  std::vector<Regime> exclude{};      ///< regimes that take no part, besides the ground
  std::optional<UserIntervals> intervals{};
};

/// What one model reads of a flight: recorded quantities as arrays, one value for each record.
struct ModelSamples {
  std::vector<Quantity> roles{};  ///< those that `Chain::build` is told of
  std::vector<std::pair<Quantity, std::vector<double>>> columns{};

  const std::vector<double>* find(Quantity quantity) const;
};

/// A flight as comparisons and fits see it: what was recorded, how it was flown, at one sample per record.
struct FlightSamples {
  std::string name{};          ///< for tables: the file's name, or what the flight is called
  std::string aircraft{};      ///< as the file says; may be empty
  double step = 1.0;           ///< s
  std::vector<double> time{};  ///< middles of the samples, s since 1970 UTC
  FlightMotion motion{};
  std::vector<double> flaps{};        ///< percent; empty: not recorded
  std::vector<Interval> intervals{};  ///< regimes
  ModelSamples model{};
  ModelSamples reference{};          ///< of a static system
  std::vector<double> pressure{};    ///< of a reference pressure, hPa
  std::vector<std::string> notes{};  ///< what a user should know, a sentence each
};

/// Reads what `model` and `reference` need of a flight, and finds its regimes.
///
/// How it was flown is taken from the roles of the model, and where it has none from the names that NCAR's
/// files use (GGALT, ROLL, THDG, PLWCC and the like).
/// @throws Error if a variable that is needed is absent, has no value, or its unit does not fit.
FlightSamples read_samples(const Flight& flight, const ModelFile& model, const Reference& reference,
                           const MaskOptions& options = {});

/// One model held against one reference on one flight.
///
/// The residual is p(reference) - p(model), hPa. Its parameters are those of the model, in the order of
/// `Chain::parameters`, and after them those of the reference's model where the reference is a static
/// system: both can be fitted.
class Residuals {
 public:
  /// @throws Error if the model, or that of the reference, cannot be used on the samples.
  Residuals(std::shared_ptr<const FlightSamples> samples, const ModelFile& model, const Reference& reference,
            const MaskOptions& options = {});
  Residuals(Residuals&&) noexcept;
  Residuals& operator=(Residuals&&) noexcept;
  ~Residuals();

  const FlightSamples& samples() const;
  std::size_t size() const;

  /// The parameters as the models' files have them.
  const std::vector<double>& parameters() const;

  /// True for each parameter in which the residual is exactly linear: those of effects of the catalogue at
  /// the static ports, where delta-p has no lower limit.
  const std::vector<bool>& is_linear() const;

  /// Which samples take part with the parameters of the files.
  const std::vector<Mask>& mask() const;
  std::array<std::size_t, mask_count> mask_counts() const;

  /// The residual of every sample, NaN where a value is missing. @param parameters all of them
  std::vector<double> values(const double* parameters) const;

  /// Residuals and their derivatives at some samples.
  ///
  /// @param samples `count` places of samples
  /// @param parameters all of them
  /// @param wanted the parameters whose derivatives are wanted
  /// @param residual `count` values, hPa
  /// @param derivatives `wanted.size()` columns of `count` values, one after another, hPa per unit of the
  ///        parameter
  /// Exact: linear ones from the model itself, others by dual numbers through the whole chain.
  void evaluate(const std::size_t* samples, std::size_t count, const double* parameters,
                const std::vector<std::size_t>& wanted, double* residual, double* derivatives) const;

  /// As `evaluate`, for LAMS, with the residual measured where the noise of the laser is added to it: the
  /// speed along the beam less the one that pressures and temperature ask for, times the sensitivity of
  /// delta-p to the airspeed (effects of the air, -gamma M^2 p / ((1 + 0.2 M^2) v)) at the parameters of the
  /// file. Equal to the residual to first order, hPa.
  ///
  /// Delta-p from LAMS is a gain times the noisy speed, and an effect before it (the recovery factor, the
  /// elevation of the beam) changes that gain: least squares of delta-p would shrink the gain to shrink the
  /// noise, and find an effect that is not there.
  void evaluate_speed(const std::size_t* samples, std::size_t count, const double* parameters,
                      const std::vector<std::size_t>& wanted, double* residual, double* derivatives) const;

  /// The speed along the beam, m/s, at which LAMS would agree with the model at every sample: what the laser
  /// would show where the model says that the air is, without its noise. NaN where missing; for LAMS.
  std::vector<double> predicted_beam_speed(const double* parameters) const;

  /// Delta-p that the reference asks for, p(reference) - p at the port, hPa; NaN where missing.
  std::vector<double> wanted_defect(const double* parameters) const;

  /// A quantity of the model's chain, for pictures and bands: e.g. mach, attack. NaN everywhere where the
  /// chain does not have it.
  std::vector<double> quantity(Quantity quantity, const double* parameters) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The names of all parameters in the order of `Residuals::parameters`, like "static-qp.a2"; those of the
/// reference's model begin with "reference:".
std::vector<std::string> residual_parameter_names(const ModelFile& model, const Reference& reference);

}  // namespace pcor
