#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "roles/usual_variables.hpp"

namespace pcor::internal {

/// A series of a flight with one sample per record; empty if the flight does not record it.
struct RecordedSeries {
  std::string variable{};
  std::vector<double> values{};  ///< NaN where missing
  std::string without_unit{};  ///< the first variable that was passed over because the file gives it no unit
};

/// Conversion that gives NaN beyond the limits of a series: undeclared marks of missing values, a dead
/// sensor, or another unit.
inline UnitConversion within_plausible_range(const UnitConversion& conversion, const QuantityInfo& info) {
  return conversion.within(info.minimum, info.maximum);
}

/// The values of a variable.
struct ReadValues {
  std::vector<double> values{};  ///< NaN where missing
  RejectedCounts excluded{};     ///< what is missing though the file does not mark it so
};

/// All values of a variable, converted, at `rate` samples in a record. @throws Error if it is absent.
ReadValues read_values(const Flight& flight, const std::string& variable, const UnitConversion& conversion,
                       int rate = 1);

/// The values of a few thousand records from the beginning, the middle and the end, converted.
std::vector<double> some_values(const Flight& flight, const std::string& variable,
                                const UnitConversion& conversion);

/// The middles of all records, s since 1970 UTC.
std::vector<double> record_times(const Flight& flight);

/// The first of the usual variables of a series that is there, has values and a unit that fits.
/// @param name of the series (`series_named`)
RecordedSeries read_usual(const Flight& flight, const VariableNaming& naming, std::string_view name);

/// The longitude, which no model names: the usual one, or the variable that is sure by the evidence.
RecordedSeries read_longitude(const Flight& flight, const ModelDefinition& model);

/// The series of a role: the model's variable in the unit that the model states, otherwise the usual
/// variable.
RecordedSeries read_role(const Flight& flight, const ModelDefinition& model, Quantity role);

/// Whether a flight has values of a variable with a convertible unit (the stated unit, otherwise the unit in
/// the file).
bool has_values(const Flight& flight, const std::string& variable, const std::string& unit,
                const std::string& stated = "");

/// Whether a flight has values of both pressures, or of the thermometer. The convention may state their
/// units.
bool has_values(const Flight& flight, const VariableNaming& naming, const PressurePair& pair);
bool has_values(const Flight& flight, const VariableNaming& naming, const Thermometer& thermometer);

/// The first of the pairs or thermometers of a convention that has values; nullptr without such a one.
template <class Entry>
const Entry* first_with_values(const Flight& flight, const VariableNaming& naming,
                               const std::vector<Entry>& entries) {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const Entry& entry) { return has_values(flight, naming, entry); });
  return found == entries.end() ? nullptr : &*found;
}

/// The first of the usual variables of a series that has values; empty without such a variable.
/// @param name of the series (`series_named`)
std::string first_with_values(const Flight& flight, const VariableNaming& naming, std::string_view name);

/// Name of the static pressure corrected by the flight's own processing; empty if not recorded.
std::string processed_static_pressure(const Flight& flight, const VariableNaming& naming);

}  // namespace pcor::internal
