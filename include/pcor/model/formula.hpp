#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include <pcor/physics/scalar.hpp>

namespace pcor {

/// Parse error of a formula.
struct FormulaError {
  std::size_t column = 0;  ///< Position in the text, from 1; 0 for an error of a declared parameter.
  std::string message;     ///< Message of one line, with the column.
};

/// User-defined formula, such as `(c0 + c1*sqrt(dynamic_ratio)) * static_pressure`.
///
/// Parsed once, when a model is set up, and evaluated for every sample: as double, as a vector pack or as a
/// dual number. Units are not checked.
///
/// - Numbers: `1`, `.5`, `1e-3`, with a decimal point in every locale; `pi`.
/// - Names: `[A-Za-z_][A-Za-z0-9_]*`; a name that is not a declared parameter is a variable.
/// - Operators, the tightest first: `^`, unary `-` and `+`, `*` `/`, `+` `-`. A power is right associative
///   (`2^3^2` is 512) and binds before a sign on its left (`-a^2` is `-(a^2)`).
/// - Functions: `sqrt`, `abs`, `exp`, `log` (natural), `log10`, `sin`, `cos`, `tan` (of radians), `tanh`,
///   `min(a, b)`, `max(a, b)`, `pow(a, b)` (the same as `a^b`).
/// - `if(a < b, x, y)` is x where the comparison (`<`, `<=`, `>`, `>=`) holds and y where it does not.
///
/// Arithmetic follows IEEE 754: outside its domain a function is NaN, a division by zero is infinite or NaN.
/// NaN always propagates: min, max and if are NaN if a compared value is NaN, a power if its base or exponent
/// is NaN; only `x^0` with the number 0 is 1 for every x.
class Formula {
 public:
  static constexpr std::size_t max_instructions = 256;  ///< Total number of numbers, names and operations.
  static constexpr std::size_t max_stack = 32;          ///< Intermediate results on the stack.
  static constexpr std::size_t max_nesting = 64;  ///< Nesting depth of parentheses, calls, signs and powers.

  /// Parses `text`, in which the names in `parameters` are coefficients and all others variables.
  ///
  /// Returns nullopt if the text is not a formula, exceeds the limits above, or if a parameter's name is
  /// invalid, declared twice, or the name of a function or pi; `error`, unless nullptr, then holds the
  /// reason.
  static std::optional<Formula> parse(std::string_view text, const std::vector<std::string>& parameters,
                                      FormulaError* error = nullptr);

  /// Text of the formula.
  const std::string& text() const noexcept { return text_; }

  /// Names of the variables, without duplicates, in the order of their first appearance.
  const std::vector<std::string>& variables() const noexcept { return variables_; }

  /// Names of the parameters as declared, used or not.
  const std::vector<std::string>& parameters() const noexcept { return parameters_; }

  /// Declared parameters that do not appear in the text.
  const std::vector<std::string>& unused_parameters() const noexcept { return unused_parameters_; }

  /// Value of the formula, of the type of a variable times a parameter.
  ///
  /// `variables` and `parameters` hold one value for each name in variables() and in parameters(), in that
  /// order; either may be nullptr if it has no names. Does not allocate or throw. Both branches of an if are
  /// evaluated, so the cost per sample is constant.
  template <class X, class P>
  auto value(const X* variables, const P* parameters) const noexcept {
    using S = Promoted<X, P>;
    const Instruction* const begin = code_.data();
    return run<S>(begin, begin + code_.size(), variables, parameters);
  }

 private:
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

  struct Function {
    std::string_view name;
    Operation operation;
    std::size_t arguments;
  };

  static constexpr Function functions[] = {
      {"sqrt", Operation::square_root, 1},
      {"abs", Operation::absolute, 1},
      {"exp", Operation::exponential, 1},
      {"log", Operation::logarithm, 1},
      {"log10", Operation::decimal_logarithm, 1},
      {"sin", Operation::sine, 1},
      {"cos", Operation::cosine, 1},
      {"tan", Operation::tangent, 1},
      {"tanh", Operation::hyperbolic_tangent, 1},
      {"min", Operation::minimum, 2},
      {"max", Operation::maximum, 2},
      {"pow", Operation::power, 2},
      {"if", Operation::if_less, 3},
  };
  static constexpr double max_integer_exponent = 1024.0;

  class Parser;

  Formula() = default;

  static const Function* function(std::string_view name) noexcept {
    const auto found = std::find_if(std::begin(functions), std::end(functions),
                                    [&](const Function& known) { return known.name == name; });
    return found == std::end(functions) ? nullptr : found;
  }

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

  std::string text_;
  std::vector<std::string> variables_;
  std::vector<std::string> parameters_;
  std::vector<std::string> unused_parameters_;
  std::vector<Instruction> code_;
};

}  // namespace pcor

#include <pcor/model/formula_parser.hpp>  // defines Formula::parse
