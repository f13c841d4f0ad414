#include "checks/circle_fit.hpp"
#include "numerics/missing.hpp"

#include <cmath>

#include <pcor/physics/constants.hpp>

namespace pcor::internal {

CircleFit fit_circle(const std::vector<double>& airspeed, const std::vector<double>& heading,
                     const std::vector<double>& east_speed, const std::vector<double>& north_speed,
                     const std::vector<double>& time, double step) {
  const std::size_t count = time.size();
  std::vector<std::vector<double>> columns(4, std::vector<double>(2 * count));
  std::vector<double> wind(2 * count);
  std::vector<double> both_times(2 * count);
  CircleFit circle;
  double before = nan;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = heading[i] * constants::radians_per_degree;
    const double sine = std::sin(angle);
    const double cosine = std::cos(angle);
    const std::size_t north = count + i;
    columns[0][i] = 1.0;
    columns[1][north] = 1.0;
    columns[2][i] = -sine;
    columns[2][north] = -cosine;
    columns[3][i] = -airspeed[i] * cosine;
    columns[3][north] = airspeed[i] * sine;
    wind[i] = east_speed[i] - airspeed[i] * sine;
    wind[north] = north_speed[i] - airspeed[i] * cosine;
    both_times[i] = time[i];
    // Shifted in time, so that the noise model treats it as a separate series.
    both_times[north] = time[i] + 2.0 * (time.back() - time.front()) + 1000.0 * step;
    if (std::isfinite(heading[i])) {
      if (std::isfinite(before)) circle.turned += std::remainder(heading[i] - before, 360.0);
      before = heading[i];
    }
  }
  const LeastSquares fit = least_squares(columns, wind, both_times, step);
  circle.east_wind = fit.coefficients[0];
  circle.north_wind = fit.coefficients[1];
  circle.airspeed_error = fit.coefficients[2];
  circle.heading_error = {fit.coefficients[3].value / constants::radians_per_degree,
                          fit.coefficients[3].error / constants::radians_per_degree};
  circle.rms = fit.rms;
  circle.along.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = heading[i] * constants::radians_per_degree;
    circle.along[i] = fit.residuals[i] * std::sin(angle) + fit.residuals[count + i] * std::cos(angle);
  }
  return circle;
}

}  // namespace pcor::internal
