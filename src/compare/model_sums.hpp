#pragma once

#include <Eigen/Dense>
#include <array>
#include <cereal/types/map.hpp>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <pcor/compare/compare.hpp>
#include "numerics/binned_residual.hpp"
#include "residuals/flight_statistics.hpp"
#include "residuals/serialization.hpp"

/// Serialization of statistics for other ranks.
namespace cereal {

template <class Archive>
void serialize(Archive& archive, pcor::FlightResiduals& r) {
  archive(r.samples, r.mask, r.values, r.flaps_out, r.reference_defects, r.model_defects, r.static_pressure,
          r.corrected_pressures, r.total_pressure, r.reference_total_pressure, r.mach, r.dynamic_ratio);
}

template <class Archive>
void serialize(Archive& archive, pcor::WorstInterval& worst) {
  archive(worst.flight, worst.begin, worst.end, worst.statistics, worst.regimes);
}

}  // namespace cereal

namespace pcor::internal {

/// Number of variables by whose bands residuals are summed: altitude, Mach number, attack, sideslip.
inline constexpr std::size_t banding_count = 4;

/// Sums over the residuals of one model, for one or several flights.
struct ModelSums {
  ResidualSums all{};
  ResidualSums flaps_out{};
  double reference_defect = 0.0;  // delta-p of the reference
  double reference_defect_squares = 0.0;
  PairMoments pressures{};           // model and reference
  Eigen::VectorXd by_uncertainty{};  // change of the residuals by each uncertainty of the reference
  std::array<ResidualSums, regime_count> regimes{};
  std::array<std::map<long, ResidualSums>, banding_count> bands{};
  std::vector<WorstInterval> worst{};  // `worst_count` entries at most

  void add(const ModelSums& other);

  /// Visits the sums over all samples, over each regime and over each band, in this order.
  template <class Visit>
  void each_part(const Visit& visit) {
    visit(all);
    for (ResidualSums& regime : regimes) visit(regime);
    for (auto& bands_of_variable : bands) {
      for (auto& [band, sums] : bands_of_variable) visit(sums);
    }
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(all, flaps_out, reference_defect, reference_defect_squares, pressures, by_uncertainty, regimes,
            bands, worst);
  }
};

/// Residual of one model on a flight in bins, and the records of each summed part.
struct SummedRecords {
  BinnedResidual residual{};
  std::vector<std::vector<std::size_t>> parts{};  // order as in `ModelSums::each_part`
};

/// Sums over the residuals of one model on a flight.
/// @param records receives the records of the parts, which the errors require
ModelSums sums_of(const FlightResiduals& flight, std::size_t model, const NoiseFloor& noise,
                  SummedRecords& records);

/// Statistics of a model from its sums. @param flights statistics of each flight
ModelComparison comparison_of(const std::string& name, const Reference& reference, ModelSums sums,
                              std::vector<PartStatistics> flights);

}  // namespace pcor::internal
