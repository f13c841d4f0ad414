#pragma once

#include <Eigen/Dense>
#include <vector>

namespace pcor::internal {

/// Part of the rows of a fit, for example half of a flight.
struct InformationPart {
  Eigen::MatrixXd information;  ///< products of the whitened columns of these rows with each other
  Eigen::VectorXd score;        ///< products of the columns with the residual after the fit
};

/// Part of some rows. @param products of whitened columns and residual with each other, the residual last
/// @param solution estimate of the fit
InformationPart part_of_rows(const Eigen::MatrixXd& products, const Eigen::VectorXd& solution);

/// Factor of the variance of whitened rows (Birge ratio squared): how much further apart the estimates from
/// parts of the rows are than their noise explains. If the noise model holds, the change S s of the estimate
/// by a part has the covariance S (M - M S M) S.
///
/// The factor is the mean of chi2 per degree of freedom of these changes, together with a prior: 1 with the
/// weight of four degrees of freedom, or of fewer if parts repeat each other, as two halves do. It is 1 or
/// more: agreement does not prove a smaller noise. S contains the prior of the coefficients. If nuisances of
/// a flight were eliminated from its rows, the factor is too small, since part of the scatter went with them.
///
/// @param parts M and s of each part @param covariance S, of the fit to all parts
/// @param count the first coefficients, whose changes are tested; the others are nuisances
/// @param before factor of the variance that the whitened rows contain already
/// Source: R. T. Birge, Phys. Rev. 40 (1932) 207, for one unknown.
double variance_factor(const std::vector<InformationPart>& parts, const Eigen::MatrixXd& covariance,
                       Eigen::Index count, double before);

}  // namespace pcor::internal
