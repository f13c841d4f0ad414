#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <pcor/residuals/residuals.hpp>

namespace pcor::internal::manoeuvres {

using Flights = std::vector<std::shared_ptr<const FlightSamples>>;

/// The samples of some flights in the air at 60 m/s or more, one after another, with the air that their
/// pressures and temperatures speak of. NaN where a value is not known.
///
/// The ambient temperature is the recorded one, else that of a thermometer which feels all of the dynamic
/// heating, else that of the standard atmosphere: what is learnt with it goes back through the same relation.
class Flown {
 public:
  enum class Flaps { in, out };  ///< up to 5 %, or beyond 20 %

  Flown(const Flights& flights, Flaps which);

  std::vector<double> pressure;     ///< hPa
  std::vector<double> dynamic;      ///< hPa
  std::vector<double> temperature;  ///< ambient, K
  std::vector<double> humidity;     ///< vapour pressure over pressure, 1
  std::vector<double> mach;         ///< 1
  std::vector<double> airspeed;     ///< m/s
  std::vector<double> load;         ///< load factor, 1
  std::vector<double> flaps;        ///< percent; 0 where they are not recorded

  /// What the flights recorded of a quantity; all NaN where they did not.
  std::vector<double> column(Quantity quantity, ModelSamples FlightSamples::*samples) const;

  /// The same, of the model or else of the reference.
  std::vector<double> column(Quantity quantity) const;

  /// A series of each flight, e.g. of `FlightMotion`.
  template <class SeriesOf>
  std::vector<double> gathered(SeriesOf series_of) const {
    std::vector<double> values;
    values.reserve(places_.size());
    for (const Place& place : places_) values.push_back(value_at(series_of(*place.flight), place.sample));
    return values;
  }

 private:
  struct Place {
    const FlightSamples* flight;
    std::size_t sample;
  };

  static double value_at(const std::vector<double>& series, std::size_t sample);
  void add(const FlightSamples& flight, Flaps which);

  std::vector<Place> places_;
};

}  // namespace pcor::internal::manoeuvres
