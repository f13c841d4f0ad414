#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <string>
#include <vector>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

class FitFlights;
struct Solution;

/// The prior of the coefficients of a surface: independent second differences along both axes of standard
/// deviation `size`, and each coefficient of `coefficient`, which keeps planes, which have no second
/// differences, from growing where the terms of the law do the same; these have no prior and keep what is
/// theirs.
struct SurfaceRoughness {
  std::string effect{};   ///< its name in the fit
  std::size_t first = 0;  ///< parameter
  std::size_t count = 0;
  Eigen::MatrixXd differences{};  ///< rows of `second_differences`
  double size = 0.03;             ///< standard deviation of a second difference
  double coefficient = 0.05;      ///< standard deviation of a coefficient
  /// Number of residuals for each independent one, at least 1. Least squares assumes independent residuals,
  /// so the prior gets this weight.
  double inflation = 10.0;
  double degrees_of_freedom = 0.0;  ///< number of coefficients that the flights determine

  bool has(std::size_t parameter) const { return parameter >= first && parameter < first + count; }

  /// Rows of the prior, each of variance 1.
  Eigen::MatrixXd rows() const;
};

/// Rows of second differences along both axes of a surface: zero for a plane.
Eigen::MatrixXd second_differences(const Surface& surface);

/// Finds both sizes of each surface by the marginal likelihood of the residuals at a solution, all others and
/// the law fitted too. The likelihood is that of least squares over the inflation, so that memory and drift
/// of the noise do not count as structure (Pauli, Racugno and Ventura 2011, Statistica Sinica 21, 149).
/// False where size and inflation of all hardly changed.
/// @param has_new_noise the noise is measured at the solution; otherwise it is that of the last measurement
bool find_roughness(FitFlights& flights, const Solution& solution, std::vector<SurfaceRoughness>& surfaces,
                    bool has_new_noise);

}  // namespace pcor::internal
