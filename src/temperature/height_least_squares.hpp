#pragma once

#include <Eigen/Dense>
#include <vector>

#include <pcor/temperature/temperature.hpp>
#include "temperature/height_record.hpp"

namespace pcor::internal {

/// The inverse of an information matrix whose unknowns have different units.
Eigen::MatrixXd scaled_inverse(const Eigen::MatrixXd& information);

/// Least squares on height (memo eq. 23 and 24): coefficients that minimise the distance of the integral from
/// the GPS height, about the mean height of each segment. Errors assume independent samples, as the memo
/// does.
TemperatureFit fit_height_by_least_squares(const std::vector<HeightRecord>& records, std::size_t terms);

/// Integrated autocorrelation time, in samples, of the least-squares height residuals: standard errors for
/// independent samples are too small by its square root.
double samples_as_one(const HeightRecord& record, const std::vector<double>& coefficients);

/// GPS height minus the integral with a correction, about its mean in each segment, m.
std::vector<double> height_differences(const HeightRecord& record, const std::vector<double>& coefficients);

}  // namespace pcor::internal
