#include "residuals/predicted_pressures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

using pcor::Quantity;
using pcor::internal::predicted_by_height;
using pcor::internal::predicted_by_radome;

namespace {

using Series = std::vector<double>;

/// Part of the noise of a pressure that its prediction contains, by least squares.
double share_of_noise(const Series& noisy, const Series& predicted, const Series& truth) {
  double product = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    product += (noisy[i] - truth[i]) * (predicted[i] - truth[i]);
    squares += (noisy[i] - truth[i]) * (noisy[i] - truth[i]);
  }
  return product / squares;
}

/// A flight that climbs and speeds up, with slow turns of both flow angles.
struct Radome {
  Series dynamic_pressure{};  // truth, hPa
  pcor::ModelSamples samples{};

  explicit Radome(std::size_t size) {
    Series radome;
    Series attack;
    Series sideslip;
    Series pressure;
    for (std::size_t i = 0; i < size; ++i) {
      const double t = static_cast<double>(i);
      radome.push_back(60.0 + 20.0 * std::sin(t / 211.0));
      attack.push_back(3.0 + 4.0 * std::sin(t / 97.0));
      sideslip.push_back(2.0 * std::sin(t / 53.0));
      pressure.push_back(800.0 - 0.1 * t);
      dynamic_pressure.push_back(0.4 + 1.02 * radome[i] + 1.3 * attack[i] * attack[i] / radome[i] +
                                 0.7 * sideslip[i] * sideslip[i] / radome[i] -
                                 0.2 * radome[i] * radome[i] / pressure[i]);
    }
    samples.columns = {{Quantity::radome_dynamic_pressure, radome},
                       {Quantity::attack_differential_pressure, attack},
                       {Quantity::sideslip_differential_pressure, sideslip},
                       {Quantity::static_pressure, pressure}};
  }
};

TEST(RadomePrediction, ReproducesAPressureDeterminedByTheRadome) {
  const Radome flight(1000);
  const Series predicted = predicted_by_radome(flight.dynamic_pressure, flight.samples);
  for (std::size_t i = 0; i < predicted.size(); ++i)
    EXPECT_NEAR(predicted[i], flight.dynamic_pressure[i], 1e-6);  // hPa: normal equations in double precision
}

TEST(RadomePrediction, ExcludesTheNoiseOfTheTestedPressure) {
  const Radome flight(3000);
  std::mt19937 engine(7);
  std::normal_distribution<double> noise(0.0, 0.2);
  Series noisy = flight.dynamic_pressure;
  for (double& value : noisy) value += noise(engine);
  const Series predicted = predicted_by_radome(noisy, flight.samples);
  // Five coefficients of 3000 samples: 0.0017 on average.
  EXPECT_LT(std::abs(share_of_noise(noisy, predicted, flight.dynamic_pressure)), 0.01);
}

TEST(RadomePrediction, KeepsValuesWithoutRadomeData) {
  Radome flight(1000);
  flight.samples.columns[0].second[500] = std::numeric_limits<double>::quiet_NaN();
  flight.dynamic_pressure[500] = 77.0;
  EXPECT_EQ(predicted_by_radome(flight.dynamic_pressure, flight.samples)[500], 77.0);
  flight.samples.columns.erase(flight.samples.columns.begin());
  EXPECT_EQ(predicted_by_radome(flight.dynamic_pressure, flight.samples), flight.dynamic_pressure);
}

TEST(RadomePrediction, KeepsTheValuesOfAShortFlight) {
  const Radome flight(299);
  Series odd = flight.dynamic_pressure;
  odd[3] += 5.0;
  EXPECT_EQ(predicted_by_radome(odd, flight.samples), odd);
}

/// Heights of a flight that climbs and descends in waves, and the pressure of the ICAO atmosphere there.
struct Climbs {
  Series altitude{};  // m
  Series pressure{};  // hPa

  explicit Climbs(std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {
      altitude.push_back(3000.0 + 2000.0 * std::sin(static_cast<double>(i) / 400.0));
      pressure.push_back(1013.25 * std::pow(1.0 - 2.25577e-5 * altitude[i], 5.25588));
    }
  }
};

TEST(HeightPrediction, ReproducesTheStandardAtmosphere) {
  const Climbs flight(4000);
  const Series predicted = predicted_by_height(flight.pressure, flight.altitude, 1.0);
  // A polynomial of fourth degree in 4 km differs from ln p by 1e-6.
  for (std::size_t i = 0; i < predicted.size(); ++i) EXPECT_NEAR(predicted[i], flight.pressure[i], 0.005);
}

TEST(HeightPrediction, KeepsASlowDifferenceFromHeight) {
  Climbs flight(8000);
  for (std::size_t i = 0; i < flight.pressure.size(); ++i)
    flight.pressure[i] *= 1.0 + 0.003 * std::sin(static_cast<double>(i) / 1500.0);
  const Series predicted = predicted_by_height(flight.pressure, flight.altitude, 1.0);
  // A tenth of the wave of 2.4 hPa: the Gaussian lowers it by 2 %, and the height has a part of it by chance.
  for (std::size_t i = 600; i + 600 < predicted.size(); ++i)
    EXPECT_NEAR(predicted[i], flight.pressure[i], 0.25);
}

TEST(HeightPrediction, ExcludesNoiseOfOneMinute) {
  const Climbs flight(8000);
  std::mt19937 engine(7);
  std::normal_distribution<double> normal;
  const double memory = std::exp(-1.0 / 60.0);
  Series noisy = flight.pressure;
  double noise = 0.0;
  for (std::size_t i = 1; i < noisy.size(); ++i) {
    noise = memory * noise + 0.2 * std::sqrt(1.0 - memory * memory) * normal(engine);
    noisy[i] += noise;
  }
  const Series predicted = predicted_by_height(noisy, flight.altitude, 1.0);
  // 120 s over 300 s sqrt(2 pi) is 0.16; a flight has about 70 independent values.
  EXPECT_LT(share_of_noise(noisy, predicted, flight.pressure), 0.3);
}

TEST(HeightPrediction, KeepsTheValuesWithoutHeight) {
  Climbs flight(1000);
  EXPECT_EQ(predicted_by_height(flight.pressure, {}, 1.0), flight.pressure);
  flight.altitude[500] = std::numeric_limits<double>::quiet_NaN();
  flight.pressure[500] = 700.0;
  EXPECT_EQ(predicted_by_height(flight.pressure, flight.altitude, 1.0)[500], 700.0);
}

TEST(HeightPrediction, WrongHeightKeepsTheValues) {
  const Climbs flight(4000);
  Series other = flight.altitude;
  std::rotate(other.begin(), other.begin() + 700, other.end());
  EXPECT_EQ(predicted_by_height(flight.pressure, other, 1.0), flight.pressure);
}

}  // namespace
