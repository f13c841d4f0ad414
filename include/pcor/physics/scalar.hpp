#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0)
#error "pcor finds missing values by NaN: compile without -ffast-math, -ffinite-math-only and -Ofast"
#endif

namespace pcor {

/// The scalars that the physics is written for.
///
/// Every formula of the library is a template over its scalar `S`: `double` in the real-time loop, a vector
/// pack in batch processing, an automatically differentiated number in a fit. A scalar has the four
/// operations, comparisons, construction from `double`, and `sqrt`, `exp`, `log`, `sin`, `cos`, `tan` by
/// argument-dependent lookup. Comparisons of a vector pack give one truth value for each lane, so formulas
/// choose with `select` instead of `if`. Formula effects also require `abs`, `log10`, `tanh` and `pow`.

/// Stops the compiler at a formula with integers, such as `moist_air(0)`, whose result would be truncated.
template <class S>
constexpr void require_scalar() {
  static_assert(!std::is_integral_v<S>, "pcor computes with floating-point numbers: write 0.0, not 0");
}

/// The type of an expression in a state of scalar `X` and parameters of scalar `P`.
template <class X, class P>
using Promoted = decltype(std::declval<X>() * std::declval<P>());

/// Returns `yes` if the condition holds, otherwise `no`.
template <class S>
constexpr S select(bool condition, const S& yes, const S& no) {
  return condition ? yes : no;
}

/// True if the condition holds in every lane.
constexpr bool all(bool condition) { return condition; }

/// True if the condition holds in some lane.
template <class Condition>
constexpr bool any(const Condition& condition) {
  return !all(!condition);
}

/// True if the value is not a number.
template <class S>
constexpr auto is_missing(const S& value) {
  return !(value == value);
}

/// Not a number, in the scalar `S`.
template <class S>
constexpr S missing() {
  require_scalar<S>();
  return S(std::numeric_limits<double>::quiet_NaN());
}

/// True if the value is neither infinite nor missing.
template <class S>
constexpr auto is_finite(const S& value) {
  return !is_missing(value - value);
}

static_assert(is_missing(std::numeric_limits<double>::quiet_NaN()) &&
                  !is_missing(std::numeric_limits<double>::infinity()),
              "pcor detects missing values by NaN, which these compiler options disable");

/// Value if finite, otherwise NaN.
template <class S>
constexpr S finite_or_missing(const S& value) {
  return select(is_finite(value), value, missing<S>());
}

/// `base` to the `exponent`, for a base above zero. A negative base gives NaN.
///
/// Accurate to a few units in the last place for results between 0.001 and 1000, the range of all powers of
/// the chain; `std::pow`, accurate for any size, takes nearly twice the time.
template <class S>
S power(const S& base, const S& exponent) {
  require_scalar<S>();
  if constexpr (std::is_floating_point_v<S>) {
    return std::exp2(exponent * std::log2(base));
  } else {
    return exp(exponent * log(base));
  }
}

/// `base` to a constant `exponent`.
template <class S, class = std::enable_if_t<!std::is_floating_point_v<S>>>
S power(const S& base, double exponent) {
  return exp(S(exponent) * log(base));
}

namespace detail {

// 2 artanh(s)/s as a polynomial in s^2, and (e^y - 1)/y as one in y, interpolated at the zeros of Chebyshev
// polynomials: within 2e-16 up to these limits, which air below Mach 0.847 does not pass.
inline constexpr double max_square = 0.0533;
inline constexpr std::array<double, 8> twice_artanh{
    1.9999999999999998, 0.6666666666673486, 0.39999999973182804, 0.2857143258165603,
    0.2222192846459124, 0.1819345637926683, 0.15131155731283713, 0.16152981762545976};
inline constexpr double max_exponent = 0.15;
inline constexpr std::array<double, 8> exponential_less_one{1.0,
                                                            0.5000000000000195,
                                                            0.16666666666393407,
                                                            0.04166666681223684,
                                                            0.00833332952814301,
                                                            0.001388942834516122,
                                                            0.00019799005809029933,
                                                            2.6515439600063568e-05};

template <std::size_t... pair>
constexpr double polynomial(double x, const std::array<double, 2 * sizeof...(pair)>& c,
                            std::index_sequence<pair...>) {
  const std::array<double, sizeof...(pair)> pairs{(c[2 * pair] + x * c[2 * pair + 1])...};
  if constexpr (pairs.size() == 1) {
    return pairs[0];
  } else {
    return polynomial(x * x, pairs, std::make_index_sequence<pairs.size() / 2>());
  }
}

// c[0] + c[1] x + ... + c[7] x^7: in pairs, and pairs of pairs, which a processor computes side by side.
constexpr double polynomial(double x, const std::array<double, 8>& c) {
  return polynomial(x, c, std::make_index_sequence<4>());
}

}  // namespace detail

/// (1 + part/whole)^exponent - 1, for part/whole above -1.
///
/// For `double` and the exponent R/c_p accurate to 1e-15 of the result in the range of flight, below Mach
/// 0.847; for c_p/R to 4e-15. Two polynomials, by ln(1 + x) = 2 artanh(x/(2 + x)), faster than two calls of
/// the library.
template <class S>
S power_less_one(const S& part, const S& whole, const S& exponent) {
  require_scalar<S>();
  if constexpr (std::is_same_v<S, double>) {
    const S s = part / (whole + whole + part);
    const S square = s * s;
    const S y = exponent * s * detail::polynomial(square, detail::twice_artanh);
    if (square <= detail::max_square && y >= 0.0 && y <= detail::max_exponent)
      return y * detail::polynomial(y, detail::exponential_less_one);
  }
  return power(S(1.0) + part / whole, exponent) - S(1.0);
}

/// The decimal logarithm of e.
inline constexpr double decimal_logarithm_of_e = 0.43429448190325182765;

/// Decimal logarithm, from the natural one: half the time of `std::log10`, within one part in 10^15 of it.
template <class S>
S decimal_logarithm(const S& x) {
  using std::log;
  return S(decimal_logarithm_of_e) * log(x);
}

/// Hyperbolic tangent, from one exponential.
template <class S>
S hyperbolic_tangent(const S& x) {
  using std::exp;
  return S(1.0) - S(2.0) / (exp(S(2.0) * x) + S(1.0));
}

}  // namespace pcor
