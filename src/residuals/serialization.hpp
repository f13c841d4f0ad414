#pragma once

#include <cereal/types/bitset.hpp>
#include <memory>

#include <pcor/residuals/samples.hpp>
#include <pcor/residuals/statistics.hpp>
#include "parallel/serialization.hpp"
#include "residuals/flight_statistics.hpp"

/// Serialization of flight data for other ranks.
namespace cereal {

template <class Archive>
void serialize(Archive& archive, pcor::Statistics& statistics) {
  archive(statistics.samples, statistics.mean, statistics.bias, statistics.bias_error, statistics.rms,
          statistics.noise_rms);
}

template <class Archive>
void serialize(Archive& archive, pcor::Interval& interval) {
  archive(interval.regime, interval.begin, interval.end, interval.pair, interval.note);
}

template <class Archive>
void serialize(Archive& archive, pcor::FlightMotion& motion) {
  archive(motion.time, motion.airspeed, motion.altitude, motion.vertical_speed, motion.roll, motion.pitch,
          motion.heading, motion.attack, motion.sideslip, motion.ground_speed, motion.ground_track,
          motion.liquid_water);
}

template <class Archive>
void serialize(Archive& archive, pcor::FrozenSpan& span) {
  archive(span.quantity, span.first, span.count);
}

template <class Archive>
void serialize(Archive& archive, pcor::ParameterDependentColumn& column) {
  archive(column.quantity, column.effect, column.parameter, column.at, column.slope);
}

template <class Archive>
void serialize(Archive& archive, pcor::FastSeries& series) {
  archive(series.values, series.in_record, series.min_period);
}

template <class Archive>
void serialize(Archive& archive, pcor::ModelSamples& samples) {
  archive(samples.roles, samples.columns, samples.variables, samples.frozen, samples.parameter_dependent,
          samples.along_beam);
}

template <class Archive>
void serialize(Archive& archive, pcor::FlightSamples& samples) {
  archive(samples.name, samples.aircraft, samples.step, samples.time, samples.latitude, samples.longitude,
          samples.motion, samples.flaps, samples.flaps_variable, samples.intervals, samples.model,
          samples.reference, samples.notes);
}

template <class Archive>
void serialize(Archive& archive, pcor::internal::ResidualSums& sums) {
  archive(sums.samples, sums.sum, sums.squares, sums.noise_squares, sums.sum_variance, sums.by_gps);
}

/// Shared samples of a flight, or null: each receiver gets its copy.
template <class Archive>
void save(Archive& archive, const std::shared_ptr<const pcor::FlightSamples>& samples) {
  archive(samples != nullptr);
  if (samples) archive(const_cast<pcor::FlightSamples&>(*samples));
}

template <class Archive>
void load(Archive& archive, std::shared_ptr<const pcor::FlightSamples>& samples) {
  bool is_there = false;
  archive(is_there);
  if (!is_there) return samples.reset();
  auto result = std::make_shared<pcor::FlightSamples>();
  archive(*result);
  samples = std::move(result);
}

}  // namespace cereal
