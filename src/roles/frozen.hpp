#pragma once

#include <pcor/model/quantity.hpp>
#include <pcor/numerics/noise.hpp>

#include <string>
#include <vector>

namespace pcor::internal {

/// The stretches in which a series has one value exactly for much longer than chance lets it.
///
/// What a sensor does elsewhere tells what chance may do. It is frozen where it stands still for at least 20
/// samples, 20 times as long as on average over the twenty values before and the twenty after (but for the
/// two that last longest), and much longer than usual in the whole flight: where its noise, five minutes
/// before and after, is larger than its resolution, five times as long as the median of the samples; else ten
/// times as long as nine in ten of them. So a flap, a cloud that is not there, a temperature that creeps in
/// steps and an altitude in whole feet are not frozen, and of a coarse sensor only what is shorter than a
/// tenth of the flight is found.
///
/// @param values NaN where missing @param looked_at the samples that count
/// @param always_varies one value from beginning to end is frozen, too
std::vector<Segment> find_frozen(const std::vector<double>& values, const std::vector<bool>& looked_at,
                                 bool always_varies = false);

/// True for what no flying aircraft leaves at one value: flaps and liquid water may stay where they are.
bool always_varies(Quantity quantity);

/// "VLAMS is frozen, at 131.2 m/s from 2011-11-18 13:20:05 to 13:21:45 UTC (100 samples)".
std::string frozen_text(const std::string& variable, Quantity quantity, const std::vector<double>& values,
                        const std::vector<double>& time, const std::vector<Segment>& frozen);

}  // namespace pcor::internal
