#pragma once

#include <pcor/flight/flight.hpp>
#include <pcor/model/quantity.hpp>
#include <pcor/numerics/noise.hpp>

#include <string>
#include <vector>

namespace pcor::internal {

/// Segments in which a series keeps exactly one value for much longer than expected by chance.
///
/// The other runs of the series define the expected length. A sensor is frozen if its value is constant
/// for at least 20 samples; for 20 times the mean run of the twenty values before and the twenty after
/// (without the two longest); and much longer than usual in the flight: five times the median if the noise
/// within five minutes before and after exceeds the resolution, otherwise ten times the 90th percentile.
/// Hence flaps, a temperature that changes in small steps and an altitude in whole feet are not reported.
///
/// @param values NaN where missing, which does not end a run of one value
/// @param used true for samples that are evaluated, as those in flight; others end a run, but belong to a
/// frozen segment if they are adjacent and have its value
/// @param always_varies frozen and similarly long runs, at most ten, do not count as usual; one value from
/// beginning to end is frozen, too; a series of fewer than 50 runs is searched for runs of 300 samples
std::vector<Segment> find_frozen(const std::vector<double>& values, const std::vector<bool>& used,
                                 bool always_varies = false);

/// Segments of the values of a quantity in flight. A quantity that always varies is also frozen if it has
/// one value in a flight of 300 samples or more; liquid water of exactly zero, as outside cloud, is never
/// frozen.
std::vector<Segment> find_frozen(Quantity quantity, const std::vector<double>& values,
                                 const std::vector<bool>& flying);

/// Segments of records in which a variable is frozen in flight, found in its means over the records and, if
/// a sample loop watches the quantity and a record has several samples, in these as in the loop
/// (`SteadyValue`): after five seconds at one value if its noise is known and exceeds the resolution. A
/// record with any frozen sample belongs to a segment.
/// @param means of the records, NaN where missing
std::vector<Segment> find_frozen(const Flight& flight, const std::string& variable, Quantity quantity,
                                 const std::vector<double>& means, const std::vector<bool>& flying);

/// True where a speed, or a dynamic pressure, is at least `minimum`; a missing value is like the last one.
std::vector<bool> in_flight(const std::vector<double>& speed, double minimum);

/// "VLAMS is frozen, at 131.2 m/s from 2011-11-18 13:20:05 to 13:21:45 UTC (100 records)".
std::string frozen_text(const std::string& variable, Quantity quantity, const std::vector<double>& values,
                        const std::vector<double>& time, const std::vector<Segment>& frozen);

}  // namespace pcor::internal
