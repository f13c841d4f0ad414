#include "diagnose/shape_uncertainty.hpp"

#include <algorithm>
#include <cmath>

#include <pcor/effects/catalogue.hpp>
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

constexpr double factor_sd = 0.3;  // exponent; half the difference of the slopes on either side of zero
constexpr double delay_sd = 0.15;  // s
// Ratio of an effect to its rms: smaller values use the logarithm of this one.
constexpr double min_ratio = 0.01;
constexpr Eigen::Index factors = 4;

/// Factors on the effect, one row for each bin: logarithms of dynamic pressure, static pressure and the
/// effect, and the sign of the effect.
Eigen::MatrixXd factors_of(const FlightColumns& flight, const Binning& bins, const Eigen::VectorXd& effect,
                           double rms) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(effect.size(), factors);
  Eigen::Index column = 0;
  for (const Quantity pressure : {Quantity::dynamic_pressure, Quantity::static_pressure}) {
    if (const std::vector<double>* const values = flight.samples->model.find(pressure)) {
      result.col(column) =
          bins.means(*values).unaryExpr([](double value) { return value > 0.0 ? std::log(value) : 0.0; });
    }
    ++column;
  }
  result.col(column) =
      effect.unaryExpr([rms](double value) { return std::log(std::max(std::abs(value) / rms, min_ratio)); });
  result.col(column + 1) = effect.cwiseSign();
  return result;
}

/// The rate of change from bin to bin, per second; zero in a segment of one bin.
Eigen::VectorXd rate_of(const Eigen::VectorXd& effect, const Binning& bins) {
  Eigen::VectorXd rate = Eigen::VectorXd::Zero(effect.size());
  for (const Segment& segment : bins.segments()) {
    for (std::size_t i = segment.first; i < segment.first + segment.count; ++i) {
      const std::size_t before = i > segment.first ? i - 1 : i;
      const std::size_t after = i + 1 < segment.first + segment.count ? i + 1 : i;
      if (after > before)
        rate[as_index(i)] =
            (effect[as_index(after)] - effect[as_index(before)]) / (bins.time()[after] - bins.time()[before]);
    }
  }
  return rate;
}

}  // namespace

bool has_uncertain_shape(const ModelEffect& effect) {
  const EffectLocation location = location_of(effect);
  if (location != EffectLocation::static_defect && location != EffectLocation::pitot) return false;
  const EffectInfo* const info = effect_named(effect.id);
  if (info == nullptr) return true;
  return std::none_of(info->needs.begin(), info->needs.end(),
                      [](Quantity input) { return input == Quantity::time || input == Quantity::date; });
}

std::vector<Eigen::MatrixXd> shape_uncertainty(const FlightPartition& partition,
                                               const std::vector<const FlightColumns*>& flights,
                                               const BinnedFlights& binned,
                                               const std::vector<Eigen::VectorXd>& effects) {
  const Eigen::Index count = as_index(effects.size());
  const std::size_t references = flights.back()->reference + 1;
  std::vector<Eigen::MatrixXd> result(flights.size());
  for (std::size_t f = 0; f < flights.size(); ++f)
    result[f] = Eigen::MatrixXd::Zero(binned.columns[f].rows(), shape_columns * count);
  for (Eigen::Index e = 0; e < count; ++e) {
    const auto effect_on = [&](std::size_t f) -> Eigen::VectorXd {
      return binned.columns[f] * effects[static_cast<std::size_t>(e)];
    };
    // Sum of the squares against each reference, and their number.
    const auto squares = partition.all_reduce_flights<Eigen::MatrixXd>([&](std::size_t f) {
      Eigen::MatrixXd of_references = Eigen::MatrixXd::Zero(2, as_index(references));
      of_references.col(as_index(flights[f]->reference)) << effect_on(f).squaredNorm(),
          static_cast<double>(binned.columns[f].rows());
      return of_references;
    });
    const double sum = squares.row(0).sum();
    if (!(sum > 0.0)) continue;
    const double rms = std::sqrt(sum / squares.row(1).sum());
    const auto sums = partition.all_reduce_flights<Eigen::VectorXd>([&](std::size_t f) -> Eigen::VectorXd {
      const Eigen::VectorXd effect = effect_on(f);
      return factors_of(*flights[f], binned.bins[f], effect, rms).transpose() * effect.cwiseAbs2();
    });
    const Eigen::RowVectorXd mean = sums.transpose() / sum;
    for (std::size_t f = 0; f < flights.size(); ++f) {
      if (!partition.is_local(f)) continue;
      const Eigen::VectorXd effect = effect_on(f);
      const Eigen::MatrixXd varying = factors_of(*flights[f], binned.bins[f], effect, rms).rowwise() - mean;
      auto columns = result[f].middleCols(shape_columns * e, shape_columns);
      columns.leftCols(factors) = factor_sd * (effect.asDiagonal() * varying);
      columns.col(factors) = delay_sd * rate_of(effect, binned.bins[f]);
      const Eigen::VectorXd of_reference = squares.col(as_index(flights[f]->reference));
      if (of_reference[0] > 0.0)
        columns.col(factors + 1).setConstant(std::sqrt(of_reference[0] / of_reference[1]));
    }
  }
  return result;
}

}  // namespace pcor::internal
