#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diagnose/manoeuvres/aircraft.hpp"
#include "diagnose/manoeuvres/atmosphere.hpp"
#include "diagnose/manoeuvres/path.hpp"

namespace pcor::internal::manoeuvres {

/// All that is known of one sample.
struct Instant;

/// Records what an aircraft would measure on a path, with the columns that its flights have.
class Recorder {
 public:
  /// @param flights at least one; the first says step, names and roles
  Recorder(const Flights& flights, const Flown& flown, const Aircraft& aircraft,
           const Atmosphere& atmosphere);

  /// Whether all flights have the quantity for the model.
  bool has(Quantity quantity) const;

  /// What is usual of a quantity of the model at a pressure, hPa; NaN where the flights do not have it.
  double usual(Quantity quantity, double pressure) const;

  std::shared_ptr<const FlightSamples> record(const std::string& name, const Path& path) const;

 private:
  /// A quantity that is recorded, and what is usual of it at every pressure.
  struct Column {
    Quantity quantity;
    Profile usual;
  };

  struct Columns {
    std::vector<Quantity> roles;
    std::vector<Column> columns;
  };

  static Columns columns_of(const Flights& flights, const Flown& flown, ModelSamples FlightSamples::*samples);
  const Column* find(Quantity quantity) const;
  std::vector<Instant> fly(const Path& path) const;
  ModelSamples samples_of(const Columns& columns, const std::vector<Instant>& instants) const;

  const Aircraft& aircraft_;
  const Atmosphere& atmosphere_;
  std::string registration_;
  double first_time_;
  double step_;
  bool has_flaps_;
  Columns model_;
  Columns reference_;
};

}  // namespace pcor::internal::manoeuvres
