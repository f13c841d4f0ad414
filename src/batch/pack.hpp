#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <xsimd/xsimd.hpp>

#include <pcor/physics/scalar.hpp>
#include "batch/pack_math.hpp"

namespace pcor::internal {

/// One truth value for each lane of a pack.
template <class Arch>
class PackMask {
 public:
  using Register = xsimd::batch_bool<double, Arch>;

  PackMask(bool every_lane) : first_(every_lane), second_(every_lane) {}
  PackMask(const Register& first, const Register& second) : first_(first), second_(second) {}
  const Register& first() const { return first_; }
  const Register& second() const { return second_; }

  friend PackMask operator!(const PackMask& a) { return {~a.first_, ~a.second_}; }
  friend PackMask operator&&(const PackMask& a, const PackMask& b) {
    return {a.first_ & b.first_, a.second_ & b.second_};
  }
  friend PackMask operator||(const PackMask& a, const PackMask& b) {
    return {a.first_ | b.first_, a.second_ | b.second_};
  }
  friend bool all(const PackMask& a) { return xsimd::all(a.first_ & a.second_); }
  friend bool any(const PackMask& a) { return xsimd::any(a.first_ | a.second_); }

 private:
  Register first_;
  Register second_;
};

/// Consecutive samples side by side in vector registers of the instruction set `Arch`: a scalar of the
/// physics, see scalar.hpp. Two registers, so that the processor computes on one while it waits for the
/// other.
///
/// As a type of the instruction set, it gives every template instance a distinct name, so that code for
/// different processors can be linked together.
template <class Arch>
class Pack {
 public:
  using Register = xsimd::batch<double, Arch>;
  using Mask = PackMask<Arch>;

  static constexpr std::size_t size = 2 * Register::size;

  Pack() = default;
  // Copies register by register: g++ 12 would copy such a class in pieces of 16 bytes through memory, and a
  // subsequent read of a whole register would stall.
  Pack(const Pack& other) : first_(other.first_.data), second_(other.second_.data) {}
  Pack& operator=(const Pack& other) {
    first_.data = other.first_.data;
    second_.data = other.second_.data;
    return *this;
  }
  Pack(double every_lane) : first_(every_lane), second_(every_lane) {}
  Pack(const Register& first, const Register& second) : first_(first), second_(second) {}

  /// The `count` values from `values` on, at least one; the last of them again in the lanes beyond.
  static Pack load(const double* values, std::size_t count) {
    std::array<double, size> padded;
    if (count < size) {
      padded.fill(values[count - 1]);
      std::copy_n(values, count, padded.begin());
      values = padded.data();
    }
    return {Register::load_unaligned(values), Register::load_unaligned(values + Register::size)};
  }

  /// Writes the first `count` lanes to `values`.
  void store(double* values, std::size_t count) const {
    std::array<double, size> padded;
    double* const all = count < size ? padded.data() : values;
    first_.store_unaligned(all);
    second_.store_unaligned(all + Register::size);
    if (count < size) std::copy_n(all, count, values);
  }

  friend Pack operator-(const Pack& a) { return {-a.first_, -a.second_}; }
  friend Pack operator+(const Pack& a, const Pack& b) { return {a.first_ + b.first_, a.second_ + b.second_}; }
  friend Pack operator-(const Pack& a, const Pack& b) { return {a.first_ - b.first_, a.second_ - b.second_}; }
  friend Pack operator*(const Pack& a, const Pack& b) { return {a.first_ * b.first_, a.second_ * b.second_}; }
  friend Pack operator/(const Pack& a, const Pack& b) { return {a.first_ / b.first_, a.second_ / b.second_}; }

  friend Mask operator<(const Pack& a, const Pack& b) { return {a.first_ < b.first_, a.second_ < b.second_}; }
  friend Mask operator>(const Pack& a, const Pack& b) { return {a.first_ > b.first_, a.second_ > b.second_}; }
  friend Mask operator<=(const Pack& a, const Pack& b) {
    return {a.first_ <= b.first_, a.second_ <= b.second_};
  }
  friend Mask operator>=(const Pack& a, const Pack& b) {
    return {a.first_ >= b.first_, a.second_ >= b.second_};
  }
  friend Mask operator==(const Pack& a, const Pack& b) {
    return {a.first_ == b.first_, a.second_ == b.second_};
  }

  friend Mask is_missing(const Pack& a) { return {xsimd::isnan(a.first_), xsimd::isnan(a.second_)}; }
  friend Pack select(const Mask& condition, const Pack& yes, const Pack& no) {
    return {xsimd::select(condition.first(), yes.first_, no.first_),
            xsimd::select(condition.second(), yes.second_, no.second_)};
  }

  friend Pack exp(const Pack& a) { return {exponential(a.first_), exponential(a.second_)}; }
  friend Pack log(const Pack& a) { return {logarithm(a.first_), logarithm(a.second_)}; }
  friend Pack power_less_one(const Pack& part, const Pack& whole, const Pack& exponent) {
    return {internal::power_less_one(part.first_, whole.first_, exponent.first_),
            internal::power_less_one(part.second_, whole.second_, exponent.second_)};
  }
  friend Pack log10(const Pack& a) { return decimal_logarithm(a); }
  friend Pack sqrt(const Pack& a) { return {xsimd::sqrt(a.first_), xsimd::sqrt(a.second_)}; }
  friend Pack abs(const Pack& a) { return {xsimd::abs(a.first_), xsimd::abs(a.second_)}; }
  // Computed lane by lane: the reduction of large angles in xsimd is a separate function, which the kernel
  // for AVX2 must not share with the rest of the program.
  friend Pack sin(const Pack& a) { return {Pack::by_lane(a.first_), Pack::by_lane(a.second_)}; }
  friend Pack cos(const Pack& a) { return {xsimd::cos(a.first_), xsimd::cos(a.second_)}; }
  friend Pack tan(const Pack& a) { return {xsimd::tan(a.first_), xsimd::tan(a.second_)}; }
  friend Pack tanh(const Pack& a) { return {xsimd::tanh(a.first_), xsimd::tanh(a.second_)}; }
  friend Pack pow(const Pack& a, const Pack& b) {
    return {xsimd::pow(a.first_, b.first_), xsimd::pow(a.second_, b.second_)};
  }

 private:
  static Register by_lane(const Register& values) {
    alignas(Register) std::array<double, Register::size> lanes;
    values.store_aligned(lanes.data());
    for (double& lane : lanes) lane = std::sin(lane);
    return Register::load_aligned(lanes.data());
  }

  Register first_;
  Register second_;
};

}  // namespace pcor::internal
