#pragma once

namespace pcor::internal {

/// The probability that a chi-squared of `degrees_of_freedom` exceeds `value`.
double chi_squared_tail(double value, double degrees_of_freedom);

/// The value that a chi-squared of `degrees_of_freedom` exceeds with the probability `tail`.
double chi_squared_value(double tail, double degrees_of_freedom);

/// The value that a chi-squared of one degree exceeds as rarely as one of `degrees_of_freedom` exceeds
/// `value`: so scores of groups of any size can be compared.
double chi2_one_dof(double value, double degrees_of_freedom);

}  // namespace pcor::internal
