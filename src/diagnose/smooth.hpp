#pragma once

#include <Eigen/Dense>
#include <vector>

namespace pcor::internal {

/// Smooth functions of one variable: quadratic splines with knots where the values are, or one column for
/// each value where there are only a few. The first column is the variable itself, centred and of unit
/// deviation, so a straight line is a part of them; a constant is not.
class Smooth {
 public:
  /// @param values those that occur; NaN are left out. @param columns how many there may be, at least 1
  Smooth(std::vector<double> values, std::size_t columns);

  /// 0 where the variable does not vary.
  std::size_t columns() const { return columns_; }
  double centre() const { return centre_; }
  double deviation() const { return deviation_; }

  /// The functions at one value.
  void evaluate(double value, double* out) const;

 private:
  std::size_t columns_ = 0;
  double centre_ = 0.0;
  double deviation_ = 0.0;
  std::vector<double> levels_{};  // of a variable with few values
  std::vector<double> knots_{};
};

}  // namespace pcor::internal
