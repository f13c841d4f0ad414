#include <pcor/residuals/statistics.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "numerics/chi_squared.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "residuals/flight_statistics.hpp"

namespace pcor {

using namespace internal;

void ResidualSums::add(double residual, double noise) {
  ++samples;
  sum += residual;
  squares += residual * residual;
  noise_squares += noise * noise;
}

void ResidualSums::add(const ResidualSums& other) {
  samples += other.samples;
  sum += other.sum;
  squares += other.squares;
  noise_squares += other.noise_squares;
  sum_variance += other.sum_variance;
  if (by_gps.size() == 0)
    by_gps = other.by_gps;
  else if (other.by_gps.size() > 0)
    by_gps += other.by_gps;
}

bool ResidualSums::determines_level() const {
  return by_gps.size() == 0 || statistics().bias_error < max_defect_error;
}

Statistics ResidualSums::statistics(bool level_is_determined) const {
  Statistics result;
  result.samples = samples;
  if (samples == 0) {
    result.mean = result.bias = result.bias_error = result.rms = result.noise_rms = nan;
    return result;
  }
  const auto count = static_cast<double>(samples);
  result.mean = result.bias = sum / count;
  result.rms = std::sqrt(squares / count);
  result.noise_rms = std::sqrt(noise_squares / count);
  result.bias_error = std::sqrt(sum_variance) / count;
  if (by_gps.size() > 0) {
    const Eigen::Index nuisances = by_gps.cols() - 3;
    Eigen::MatrixXd products = by_gps;
    products.diagonal().head(nuisances).array() += 1.0;  // their priors
    const Eigen::MatrixXd reduced = products_after(products, nuisances);
    constexpr double max_bias = 5.0;  // rms; wind and zero of a part imitate a larger bias
    const bool has_rows = reduced(1, 1) > rank_limit * reduced(0, 0);
    const Eigen::Vector2d both = pseudo_solution(reduced.topLeftCorner(2, 2), Eigen::Vector2d::Ones());
    // A residual beyond the noise of GPS makes the error larger (Birge 1932, Physical Review 40, 207).
    const double birge = std::fmax(1.0, result.scatter() / result.noise_rms);
    result.bias_error = has_rows ? birge * std::sqrt(both.sum()) : nan;
    // Sign of a residual: positive if delta-p is too small. An undetermined level stays as measured.
    const double by_level = both.dot(reduced.col(2).head(2));
    if (!has_rows)
      result.bias = nan;
    else if (level_is_determined && result.bias_error < max_defect_error &&
             std::abs(by_level) < max_bias * result.rms)
      result.bias = by_level;
  }
  return result;
}

double Statistics::rms_over_noise() const { return noise_rms > 0.0 ? rms / noise_rms : nan; }

bool fails_more(const Statistics& a, const Statistics& b) {
  const auto failure = [](const Statistics& s) {
    const double excess = s.rms * s.rms - s.noise_rms * s.noise_rms;
    return std::isnan(excess) ? 0.0 : excess;
  };
  return failure(a) > failure(b);
}

double Statistics::scatter() const { return std::sqrt(std::max(rms * rms - mean * mean, 0.0)); }

std::string flaps_out_text(const Statistics& flaps_out, const std::string& of_what) {
  if (flaps_out.samples == 0) return "";
  return fmt::format(
      "excluded from {}: {} samples with flaps extended, residual {:+.2f}{}, scatter {:.2f} hPa", of_what,
      flaps_out.samples, flaps_out.bias,
      std::isnan(flaps_out.bias_error) ? " hPa (error unknown)"
                                       : fmt::format(" +- {:.2f} hPa (standard error)", flaps_out.bias_error),
      flaps_out.scatter());
}

bool HeldOutPart::is_off() const {
  constexpr double chance = 1.0 / 80.0;
  const double tail = 1.0 - std::pow(1.0 - chance, 1.0 / static_cast<double>(parts));
  const double limit = std::sqrt(chi_squared_value(tail, 1.0));  // standard errors; 2.5 for a single part
  constexpr double smallest = 1e-3;                              // hPa: smaller values are rounding of a file
  return statistics.samples > 0 && expected > 0.0 &&
         std::abs(statistics.bias) > std::max(limit * expected, smallest);
}

std::string HeldOutPart::text() const {
  return fmt::format(
      "held-out {}: mean residual {:+.3f} hPa, expected 0 +- {:.3f} hPa (rms {:.3f} hPa); the model lacks a "
      "change with time, between flights, or in a regime that was not fitted",
      flight, statistics.bias, expected, statistics.rms);
}

}  // namespace pcor
