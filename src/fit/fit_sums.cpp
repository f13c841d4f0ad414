#include "fit/fit_sums.hpp"

#include "fit/loss_function.hpp"

namespace pcor::internal {

void FitSums::add(const FitSums& other) {
  squares += other.squares;
  bulk_squares += other.bulk_squares;
  relative_squares += other.relative_squares;
  wanted += other.wanted;
  wanted_squares += other.wanted_squares;
  samples += other.samples;
  outliers += other.outliers;
}

FitSums sums_at(FitFlights& flights, const Eigen::VectorXd& values, double deviation) {
  const auto sums_of = [&](std::size_t, FitFlight& fit) {
    // Delta-p of the reference from its unchanged file, so that R2 does not grow with a fitted reference.
    const std::vector<double> wanted = fit.residuals().target_defect(flights.task().start.data());
    const std::vector<double> all = fit.residuals().values(values.data());
    std::vector<double> residual;
    for (const std::size_t i : fit.kept()) residual.push_back(all[i]);
    FitSums sums;
    sums.samples = fit.kept().size();
    for (std::size_t i = 0; i < residual.size(); ++i) {
      const double relative = residual[i] / fit.static_pressure(i);
      const double defect = wanted[fit.kept()[i]];
      sums.squares += residual[i] * residual[i];
      sums.relative_squares += relative * relative;
      sums.wanted += defect;
      sums.wanted_squares += defect * defect;
    }
    sums.outliers = fit.outliers(values, tukey_width * deviation);
    const double bulk = robust_standard_deviation(residual);
    if (sums.samples > 0) sums.bulk_squares = bulk * bulk * static_cast<double>(sums.samples);
    return sums;
  };
  FitSums whole;
  for (const FitSums& part : flights.of_each(sums_of, values)) whole.add(part);
  flights.task().tell();
  return whole;
}

}  // namespace pcor::internal
