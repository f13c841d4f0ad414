#pragma once

namespace pcor::internal {

/// The probability that a chi-squared of `freedom` degrees exceeds `value`.
double chi_squared_tail(double value, double freedom);

/// The value that a chi-squared of `freedom` degrees exceeds with the probability `tail`.
double chi_squared_value(double tail, double freedom);

/// The value that a chi-squared of one degree exceeds as rarely as one of `freedom` degrees exceeds `value`:
/// so scores of groups of any size can be compared.
double chi2_one_dof(double value, double freedom);

}  // namespace pcor::internal
