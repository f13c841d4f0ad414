#pragma once

#include <pcor/base/note.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/regimes/regimes.hpp>
#include <pcor/residuals/masks.hpp>
#include <pcor/roles/fast_series.hpp>

#include <string>
#include <utility>
#include <vector>

namespace pcor {

class Reference;

/// Time range of a frozen sensor: constant readings for much longer than its noise permits.
struct FrozenSpan {
  Quantity quantity = Quantity::count;
  std::size_t first = 0;  ///< sample
  std::size_t count = 0;
};

/// Column that depends on a coefficient, such as the mean rate of the airspeed on its averaging time, with
/// its derivative.
struct ParameterDependentColumn {
  Quantity quantity = Quantity::count;
  std::string effect{};
  std::size_t parameter = 0;    ///< index of the coefficient in its effect
  double at = 0.0;              ///< value of the coefficient for the column
  std::vector<double> slope{};  ///< derivative of each sample with respect to the coefficient
};

/// Inputs of a model or a reference from a flight: quantities as arrays, one value for each record.
struct ModelSamples {
  std::vector<Quantity> roles{};  ///< roles for `Chain::build`
  std::vector<std::pair<Quantity, std::vector<double>>> columns{};
  std::vector<std::pair<Quantity, std::string>> variables{};  ///< names in the file, for recorded quantities
  std::vector<FrozenSpan> frozen{};
  std::vector<ParameterDependentColumn> parameter_dependent{};
  FastSeries along_beam{};  ///< airspeed along the laser's beam, m/s, if its rate is used

  const std::vector<double>* find(Quantity quantity) const;
  std::vector<double>* find(Quantity quantity);
};

/// Flight data for comparisons and fits: recorded values and regimes, at one sample per record.
struct FlightSamples {
  std::string name{};               ///< file name or title, for tables
  std::string aircraft{};           ///< stated in the file; may be empty
  double step = 1.0;                ///< s
  std::vector<double> time{};       ///< centre times of the samples, s since 1970 UTC
  std::vector<double> latitude{};   ///< deg, only for figures; empty: not recorded
  std::vector<double> longitude{};  ///< deg, only for figures; empty: not recorded
  FlightMotion motion{};
  /// Percent. Inferred from the lift if they are not recorded: 0 or 100; empty: unknown.
  std::vector<double> flaps{};
  std::string flaps_variable{};       ///< name in the file; empty: flaps are inferred or unknown
  std::vector<Interval> intervals{};  ///< regimes
  ModelSamples model{};
  ModelSamples reference{};  ///< inputs of the reference
  Notes notes{};             ///< notes for the user, one sentence each
};

/// Reads the inputs of `model` and `reference` from a flight, and detects its regimes.
///
/// The motion is read from the roles of the model, otherwise from variables with NCAR names (GGALT, ROLL,
/// THDG, PLWCC and the like). Regimes of an unknown aircraft are detected with the criteria of the C-130,
/// with a note.
/// @throws Error if a required variable is absent, has no value, or its unit does not fit.
FlightSamples read_samples(const Flight& flight, const ModelDefinition& model, const Reference& reference,
                           const MaskOptions& options = {});

}  // namespace pcor
