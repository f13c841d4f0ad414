#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include <pcor/physics/scalar.hpp>

namespace pcor {

/// Code of a formula for a stack machine. `FormulaParser` writes it; programs use `Formula`.
class FormulaCode {
 public:
  static constexpr std::size_t max_instructions = 256;  ///< Total number of numbers, names and operations.
  static constexpr std::size_t max_stack = 32;          ///< Intermediate results on the stack.

  enum class Operation : std::uint8_t {
    constant,
    variable,
    parameter,
    of_variables,
    negate,
    add,
    subtract,
    multiply,
    divide,
    integer_power,
    constant_power,
    power,
    square_root,
    absolute,
    exponential,
    logarithm,
    decimal_logarithm,
    sine,
    cosine,
    tangent,
    hyperbolic_tangent,
    minimum,
    maximum,
    if_less,
    if_less_equal,
    if_greater,
    if_greater_equal,
  };

  /// Instruction in postfix order: pops its operands from the stack and pushes its result.
  struct Instruction {
    Operation operation;
    // Index of the variable or parameter, or number of instructions that depend only on variables.
    std::uint32_t index = 0;
    double number = 0.0;  // constant, or constant exponent of a power
  };

  /// Instructions in the order of execution.
  std::vector<Instruction> instructions{};

  /// Value of the formula, as `Formula::value`.
  template <class X, class P>
  auto value(const X* variables, const P* parameters) const noexcept {
    const Instruction* const begin = instructions.data();
    return run<Promoted<X, P>>(begin, begin + instructions.size(), variables, parameters);
  }

  /// Executes instructions that need at most max_stack values on the stack.
  template <class S, class X, class P>
  static S run(const Instruction* at, const Instruction* end, const X* variables,
               const P* parameters) noexcept {
    using std::abs, std::cos, std::exp, std::log, std::log10, std::sin, std::sqrt, std::tan, std::tanh;
    S stack[max_stack];
    S* below = stack;  // values below the top end before this element
    S top(0.0);
    for (; at != end; ++at) {
      switch (at->operation) {
        case Operation::constant:
          *below++ = top;
          top = S(at->number);
          break;
        case Operation::variable:
          *below++ = top;
          top = S(variables[at->index]);
          break;
        case Operation::parameter:
          *below++ = top;
          top = S(parameters[at->index]);
          break;
        case Operation::of_variables:
          if constexpr (!std::is_same_v<S, X>) {
            *below++ = top;
            top = S(run<X>(at + 1, at + 1 + at->index, variables, static_cast<const X*>(nullptr)));
            at += at->index;
          }
          break;
        case Operation::negate:
          top = -top;
          break;
        case Operation::add:
          top = *--below + top;
          break;
        case Operation::subtract:
          top = *--below - top;
          break;
        case Operation::multiply:
          top = *--below * top;
          break;
        case Operation::divide:
          top = *--below / top;
          break;
        case Operation::integer_power:
          top = integer_power(top, static_cast<int>(at->number));
          break;
        case Operation::constant_power:
          if constexpr (std::is_floating_point_v<S>) {
            top = std::pow(top, at->number);  // any base: also a negative one, for a whole exponent
          } else {
            top = power(top, at->number);
          }
          break;
        case Operation::power:
          --below;
          top = raise(below[0], top);
          break;
        case Operation::square_root:
          top = sqrt(top);
          break;
        case Operation::absolute:
          top = abs(top);
          break;
        case Operation::exponential:
          top = exp(top);
          break;
        case Operation::logarithm:
          top = log(top);
          break;
        case Operation::decimal_logarithm:
          top = log10(top);
          break;
        case Operation::sine:
          top = sin(top);
          break;
        case Operation::cosine:
          top = cos(top);
          break;
        case Operation::tangent:
          top = tan(top);
          break;
        case Operation::hyperbolic_tangent:
          top = tanh(top);
          break;
        case Operation::minimum:
          --below;
          top = choose(below[0] <= top, below[0] > top, below[0], top, below[0], top);
          break;
        case Operation::maximum:
          --below;
          top = choose(below[0] >= top, below[0] < top, below[0], top, below[0], top);
          break;
        case Operation::if_less:
          below -= 3;
          top = choose(below[0] < below[1], below[0] >= below[1], below[0], below[1], below[2], top);
          break;
        case Operation::if_less_equal:
          below -= 3;
          top = choose(below[0] <= below[1], below[0] > below[1], below[0], below[1], below[2], top);
          break;
        case Operation::if_greater:
          below -= 3;
          top = choose(below[0] > below[1], below[0] <= below[1], below[0], below[1], below[2], top);
          break;
        case Operation::if_greater_equal:
          below -= 3;
          top = choose(below[0] >= below[1], below[0] < below[1], below[0], below[1], below[2], top);
          break;
      }
    }
    return top;
  }

 private:
  /// x^n by multiplication, so that all scalar types agree for negative x.
  template <class S>
  static S integer_power(S x, int n) noexcept {
    if (n == 0) return S(1.0);
    if (n < 0) return S(1.0) / integer_power(x, -n);
    for (; n % 2 == 0; n /= 2) x = x * x;
    S result = x;
    while (n /= 2) {
      x = x * x;
      if (n % 2 == 1) result = result * x;
    }
    return result;
  }

  /// Selects a value by comparison of a and b. If the comparison neither holds nor fails, one of them is NaN,
  /// and the result is their sum, NaN.
  template <class S, class Condition>
  static S choose(const Condition& holds, const Condition& fails, const S& a, const S& b, const S& yes,
                  const S& no) noexcept {
    return select(holds, yes, select(fails, no, S(a + b)));
  }

  /// x^y for a computed exponent.
  template <class S>
  static S raise(const S& x, const S& y) noexcept {
    using std::pow;
    S result = pow(x, y);
    if constexpr (!std::is_floating_point_v<S>) {  // some packs define 0^-1 as 0
      constexpr double infinity = std::numeric_limits<double>::infinity();
      result = select(x == S(0.0), select(y < S(0.0), S(infinity), result), result);
    }
    return choose(x < y, x >= y, x, y, result, result);  // NaN^0 and 1^NaN would be 1
  }
};

}  // namespace pcor
