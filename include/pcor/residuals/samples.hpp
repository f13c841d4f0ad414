#pragma once

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

/// A sensor that stands still for much longer than its noise allows.
struct FrozenSpan {
  Quantity quantity = Quantity::count;
  std::size_t first = 0;  ///< sample
  std::size_t count = 0;
};

/// A column that hangs on a coefficient, as the mean rate of the airspeed does on the seconds over which it
/// is the mean: how it changes with that coefficient.
struct ParameterDependentColumn {
  Quantity quantity = Quantity::count;
  std::string effect{};
  std::size_t parameter = 0;    ///< the number of the coefficient in its effect
  double at = 0.0;              ///< the value of the coefficient at which the column was found
  std::vector<double> slope{};  ///< of each sample, per unit of the coefficient
};

/// What a model or a reference reads of a flight: quantities as arrays, one value for each record.
struct ModelSamples {
  std::vector<Quantity> roles{};  ///< those that `Chain::build` is told of
  std::vector<std::pair<Quantity, std::vector<double>>> columns{};
  std::vector<std::pair<Quantity, std::string>> variables{};  ///< of the file, for what is recorded
  std::vector<FrozenSpan> frozen{};
  std::vector<ParameterDependentColumn> moving{};
  FastSeries along_beam{};  ///< airspeed along the laser's beam, m/s, where a rate of it is read

  const std::vector<double>* find(Quantity quantity) const;
  std::vector<double>* find(Quantity quantity);
};

/// A flight as comparisons and fits see it: what was recorded, how it was flown, at one sample per record.
struct FlightSamples {
  std::string name{};               ///< for tables: the file's name, or what the flight is called
  std::string aircraft{};           ///< as the file says; may be empty
  double step = 1.0;                ///< s
  std::vector<double> time{};       ///< middles of the samples, s since 1970 UTC
  std::vector<double> latitude{};   ///< deg, for pictures; empty: not recorded
  std::vector<double> longitude{};  ///< deg, for pictures; empty: not recorded
  FlightMotion motion{};
  std::vector<double> flaps{};        ///< percent; empty: not recorded
  std::string flaps_variable{};       ///< of the file
  std::vector<bool> flaps_by_lift{};  ///< where the lift says that flaps are out; empty: recorded, or unknown
  std::vector<Interval> intervals{};  ///< regimes
  ModelSamples model{};
  ModelSamples reference{};          ///< what the reference reads for itself
  std::vector<std::string> notes{};  ///< what a user should know, a sentence each
};

/// Reads what `model` and `reference` need of a flight, and finds its regimes.
///
/// How it was flown is taken from the roles of the model, and where it has none from the names that NCAR's
/// files use (GGALT, ROLL, THDG, PLWCC and the like). Regimes of an aircraft that is not known are found by
/// the criteria of the C-130, which a note says.
/// @throws Error if a variable that is needed is absent, has no value, or its unit does not fit.
FlightSamples read_samples(const Flight& flight, const ModelDefinition& model, const Reference& reference,
                           const MaskOptions& options = {});

}  // namespace pcor
