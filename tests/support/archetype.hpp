#pragma once

#include <cmath>

/// Scalars with exactly the operations that `pcor/physics/scalar.hpp` requires. A formula that compiles with
/// these scalars contains no hidden `double`, no qualified `std::sqrt`, and no `if` on a comparison.
namespace archetype {

/// Result of one comparison. Like the mask of a SIMD vector it is not a `bool`.
class Truth {
 public:
  explicit Truth(bool value) : value_(value) {}
  friend Truth operator&&(Truth a, Truth b) { return Truth(a.value_ && b.value_); }
  friend Truth operator||(Truth a, Truth b) { return Truth(a.value_ || b.value_); }
  friend Truth operator!(Truth a) { return Truth(!a.value_); }
  friend bool all(Truth a) { return a.value_; }

 private:
  bool value_;
};

/// Use of the scalar: physics, or formulas of users, which call more functions.
enum class Use { physics, formulas };

/// Number without implicit conversions.
template <Use use = Use::physics>
class Number {
 public:
  Number() = default;
  explicit Number(double value) : value_(value) {}

  /// Value, for tests only.
  double value() const { return value_; }

  friend Number operator+(const Number& a, const Number& b) { return Number(a.value_ + b.value_); }
  friend Number operator-(const Number& a, const Number& b) { return Number(a.value_ - b.value_); }
  friend Number operator*(const Number& a, const Number& b) { return Number(a.value_ * b.value_); }
  friend Number operator/(const Number& a, const Number& b) { return Number(a.value_ / b.value_); }
  friend Number operator-(const Number& a) { return Number(-a.value_); }

  friend Truth operator<(const Number& a, const Number& b) { return Truth(a.value_ < b.value_); }
  friend Truth operator<=(const Number& a, const Number& b) { return Truth(a.value_ <= b.value_); }
  friend Truth operator>(const Number& a, const Number& b) { return Truth(a.value_ > b.value_); }
  friend Truth operator>=(const Number& a, const Number& b) { return Truth(a.value_ >= b.value_); }
  friend Truth operator==(const Number& a, const Number& b) { return Truth(a.value_ == b.value_); }

  friend Number select(Truth condition, const Number& yes, const Number& no) {
    return all(condition) ? yes : no;
  }

  friend Number sqrt(const Number& a) { return Number(std::sqrt(a.value_)); }
  friend Number exp(const Number& a) { return Number(std::exp(a.value_)); }
  friend Number log(const Number& a) { return Number(std::log(a.value_)); }
  friend Number sin(const Number& a) { return Number(std::sin(a.value_)); }
  friend Number cos(const Number& a) { return Number(std::cos(a.value_)); }
  friend Number tan(const Number& a) { return Number(std::tan(a.value_)); }

 private:
  double value_ = 0.0;
};

using Physics = Number<Use::physics>;
using Formulas = Number<Use::formulas>;

inline Formulas abs(const Formulas& a) { return Formulas(std::abs(a.value())); }
inline Formulas log10(const Formulas& a) { return Formulas(std::log10(a.value())); }
inline Formulas tanh(const Formulas& a) { return Formulas(std::tanh(a.value())); }
inline Formulas pow(const Formulas& a, const Formulas& b) { return Formulas(std::pow(a.value(), b.value())); }

}  // namespace archetype
