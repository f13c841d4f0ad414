#pragma once

#include <array>
#include <cstddef>

#include <pcor/model/effect.hpp>
#include <pcor/model/quantity.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor {

/// One variable of a surface: `count` uniform cubic B-splines, whose sum is 1 from `lower` to `upper`.
struct SurfaceAxis {
  Quantity quantity = Quantity::count;
  double lower = 0.0;
  double upper = 1.0;
  std::size_t count = min_count;

  static constexpr std::size_t min_count = 4;
  static constexpr std::size_t max_count = 12;

  bool is_valid() const {
    return quantity < Quantity::count && lower < upper && count >= min_count && count <= max_count;
  }

  /// The interval between two knots.
  double step() const { return (upper - lower) / static_cast<double>(count - 3); }
};

/// A pressure coefficient as a smooth function of two quantities, which is part of delta-p:
///
///     dynamic_pressure * sum_ij c_ij B_i(x) B_j(y)
///
/// B are uniform cubic B-splines (Eilers and Marx 1996, Statistical Science 11, 89). Outside the envelope of
/// the knots the coefficient keeps its value at the edge. The coefficients are the parameters of the effect,
/// with the index of x varying slowest.
struct Surface {
  std::array<SurfaceAxis, 2> axes{};

  std::size_t parameter_count() const { return axes[0].count * axes[1].count; }

  /// Value of the surface at (x, y), hPa: dynamic pressure (hPa) times the sum of B_i(x) B_j(y) c_ij, with
  /// c_ij in the order of `coefficients`, the second axis varying fastest. Outside the envelope x and y are
  /// set to its edge, so the pressure coefficient is constant there. NaN gives NaN.
  template <class S, class P>
  Promoted<S, P> value(const S& x, const S& y, const S& dynamic_pressure, const P* coefficients) const {
    using R = Promoted<S, P>;
    const auto by_x = splines(axes[0], x);
    const auto by_y = splines(axes[1], y);
    R sum(0.0);
    for (std::size_t i = 0; i < axes[0].count; ++i) {
      R row(0.0);
      for (std::size_t j = 0; j < axes[1].count; ++j) row = row + R(*coefficients++) * R(by_y[j]);
      sum = sum + row * R(by_x[i]);
    }
    return sum * R(dynamic_pressure);
  }

  /// Values of the cubic B-splines of an axis at x; x outside the axis is set to its end. NaN gives NaN.
  template <class S>
  static std::array<S, SurfaceAxis::max_count> splines(const SurfaceAxis& axis, const S& x) {
    const S inside = select(x < S(axis.lower), S(axis.lower), select(x > S(axis.upper), S(axis.upper), x));
    const S position = (inside - S(axis.lower)) * S(1.0 / axis.step());
    std::array<S, SurfaceAxis::max_count> values{};
    for (std::size_t i = 0; i < axis.count; ++i) {
      const S from = position - S(static_cast<double>(i) - 1.0);  // the middle of spline i
      const S distance = select(from < S(0.0), S(-from), from);
      const S to_edge = S(2.0) - distance;
      const S near = S(2.0 / 3.0) + distance * distance * (S(0.5) * distance - S(1.0));
      const S far = to_edge * to_edge * to_edge * S(1.0 / 6.0);
      values[i] = select(distance < S(1.0), near, select(to_edge < S(0.0), S(0.0), far));
    }
    return values;
  }

  /// Distance of a sample from the envelope in intervals of knots; zero inside, and for missing values.
  double distance(double x, double y) const { return beyond(axes[0], x) + beyond(axes[1], y); }

  static double beyond(const SurfaceAxis& axis, double x) {
    if (x < axis.lower) return (axis.lower - x) / axis.step();
    return x > axis.upper ? (x - axis.upper) / axis.step() : 0.0;
  }
};

}  // namespace pcor
