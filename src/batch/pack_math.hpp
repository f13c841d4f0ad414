#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <xsimd/xsimd.hpp>

#include <pcor/physics/scalar.hpp>

namespace pcor::internal {

/// Power, exponential and logarithm of a vector register. xsimd provides the last two, but they take twice
/// the time on processors that cannot convert between numbers and 64-bit integers, as with AVX2.

namespace detail {

/// c[0] + c[1] x + c[2] x^2 + ..., the even and the odd powers at the same time.
template <class Register, std::size_t count>
Register polynomial(const Register& x, const std::array<double, count>& c) {
  static_assert(count % 2 == 0);
  const Register square = x * x;
  Register even(c[count - 2]);
  Register odd(c[count - 1]);
  for (std::size_t i = count - 2; i >= 2; i -= 2) {
    even = xsimd::fma(even, square, Register(c[i - 2]));
    odd = xsimd::fma(odd, square, Register(c[i - 1]));
  }
  return xsimd::fma(odd, x, even);
}

// ln 2 in two parts: a whole number of up to eleven bits times the first is exact.
inline constexpr double ln2_high = 0x1.62e42fefa3800p-1;
inline constexpr double ln2_low = 0x1.ef35793c76730p-45;

}  // namespace detail

/// e^x within 2 units in the last place; zero below -708, where results are no longer normal numbers.
template <class Arch>
[[gnu::always_inline]] inline xsimd::batch<double, Arch> exponential(const xsimd::batch<double, Arch>& x) {
  using Register = xsimd::batch<double, Arch>;
  using Bits = xsimd::batch<std::uint64_t, Arch>;
  static constexpr std::array<double, 14> series{1.0,
                                                 1.0,
                                                 1.0 / 2.0,
                                                 1.0 / 6.0,
                                                 1.0 / 24.0,
                                                 1.0 / 120.0,
                                                 1.0 / 720.0,
                                                 1.0 / 5040.0,
                                                 1.0 / 40320.0,
                                                 1.0 / 362880.0,
                                                 1.0 / 3628800.0,
                                                 1.0 / 39916800.0,
                                                 1.0 / 479001600.0,
                                                 1.0 / 6227020800.0};
  const Register half_ln2(0.34657359027997264);
  if (xsimd::all(xsimd::abs(x) <= half_ln2)) return detail::polynomial(x, series);
  // x = n ln 2 + r with whole n. Adding this number places n in the last bits.
  const Register large(0x1.8p52);
  const Register shifted = xsimd::fma(x, Register(0x1.71547652b82fep0), large);
  const Register n = shifted - large;
  const Register r = xsimd::fnma(n, Register(detail::ln2_low), xsimd::fnma(n, Register(detail::ln2_high), x));
  const Bits exponent = (xsimd::bitwise_cast<Bits>(shifted) + Bits(std::uint64_t{1023})) << 52;
  const Register result = detail::polynomial(r, series) * xsimd::bitwise_cast<Register>(exponent);
  const Register inf(std::numeric_limits<double>::infinity());
  return xsimd::select(x < Register(-708.0), Register(0.0), xsimd::select(x > Register(709.0), inf, result));
}

/// ln x within 2 units in the last place; minus infinity at zero and for x too small for a normal number.
template <class Arch>
[[gnu::always_inline]] inline xsimd::batch<double, Arch> logarithm(const xsimd::batch<double, Arch>& x) {
  using Register = xsimd::batch<double, Arch>;
  using Bits = xsimd::batch<std::uint64_t, Arch>;
  static constexpr std::array<double, 10> series{2.0 / 3.0,  2.0 / 5.0,  2.0 / 7.0,  2.0 / 9.0,  2.0 / 11.0,
                                                 2.0 / 13.0, 2.0 / 15.0, 2.0 / 17.0, 2.0 / 19.0, 2.0 / 21.0};
  constexpr std::uint64_t one = 0x3ff0000000000000;
  constexpr std::uint64_t root_of_half = 0x3fe6a09e667f3bcd;
  // x = 2^n m with m between the roots of a half and of two.
  const Bits bits = xsimd::bitwise_cast<Bits>(x) + Bits(one - root_of_half);
  const Register n = xsimd::bitwise_cast<Register>((bits >> 52) | Bits(std::uint64_t{0x4330000000000000})) -
                     Register(0x1p52 + 1023.0);
  const Register m =
      xsimd::bitwise_cast<Register>((bits & Bits(std::uint64_t{0x000fffffffffffff})) + Bits(root_of_half));
  // ln m = 2 artanh s, s = (m - 1)/(m + 1).
  const Register s = (m - Register(1.0)) / (m + Register(1.0));
  const Register square = s * s;
  const Register rest =
      xsimd::fma(n, Register(detail::ln2_low), s * square * detail::polynomial(square, series));
  const Register result = xsimd::fma(n, Register(detail::ln2_high), s + s + rest);
  const Register inf(std::numeric_limits<double>::infinity());
  const auto normal = (x >= Register(std::numeric_limits<double>::min())) & (x < inf);
  if (xsimd::all(normal)) return result;
  const Register quiet_nan(std::numeric_limits<double>::quiet_NaN());
  const Register special = xsimd::select(x < Register(0.0), quiet_nan, xsimd::select(x < inf, -inf, x));
  return xsimd::select(normal, result, special);
}

/// (1 + part/whole)^exponent - 1 within a few units in the last place.
///
/// If all lanes are in the range of flight, below Mach 0.847, two polynomials are used, as in
/// `pcor::power_less_one`; the polynomial of the exponential has a wider range here, to include the pressure
/// of a given airspeed.
template <class Arch>
[[gnu::always_inline]] inline xsimd::batch<double, Arch> power_less_one(
    const xsimd::batch<double, Arch>& part, const xsimd::batch<double, Arch>& whole,
    const xsimd::batch<double, Arch>& exponent) {
  using Register = xsimd::batch<double, Arch>;
  // (e^y - 1)/y for y from 0 to 0.5, within 2e-16.
  static constexpr std::array<double, 10> exponential_less_one{
      0.9999999999999999,     0.500000000000023,     0.1666666666651493,     0.041666666705435784,
      0.008333332830896939,   0.00138889262293704,   0.00019839584455276513, 2.4848478548539537e-05,
      2.6775176924987106e-06, 3.4637663589508023e-07};
  const Register s = part / (whole + whole + part);
  const Register square = s * s;
  const Register y = exponent * s * detail::polynomial(square, pcor::detail::twice_artanh);
  if (xsimd::all((square <= Register(pcor::detail::max_square)) & (y >= Register(0.0)) &
                 (y <= Register(0.5)))) {
    return y * detail::polynomial(y, exponential_less_one);
  }
  return exponential(exponent * logarithm(Register(1.0) + part / whole)) - Register(1.0);
}

}  // namespace pcor::internal
