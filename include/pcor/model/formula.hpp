#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/model/formula_parser.hpp>

namespace pcor {

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
/// Arithmetic follows IEEE 754: outside its domain a function is NaN, `log(0)` is -infinity, a division by
/// zero is infinite or NaN.
/// NaN always propagates: min, max and if are NaN if a compared value is NaN, a power if its base or exponent
/// is NaN; only `x^0` with the number 0 is 1 for every x.
class Formula {
 public:
  /// Total number of numbers, names and operations.
  static constexpr std::size_t max_instructions = FormulaCode::max_instructions;
  /// Intermediate results on the stack.
  static constexpr std::size_t max_stack = FormulaCode::max_stack;
  /// Nesting depth of parentheses, calls, signs and powers.
  static constexpr std::size_t max_nesting = FormulaParser::max_nesting;

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
  const std::vector<std::string>& variables() const noexcept { return parsed_.variables; }

  /// Names of the parameters as declared, used or not.
  const std::vector<std::string>& parameters() const noexcept { return parameters_; }

  /// Declared parameters that do not appear in the text.
  const std::vector<std::string>& unused_parameters() const noexcept { return parsed_.unused_parameters; }

  /// Value of the formula, of the type of a variable times a parameter.
  ///
  /// `variables` and `parameters` hold one value for each name in variables() and in parameters(), in that
  /// order; either may be nullptr if it has no names. Does not allocate or throw. Both branches of an if are
  /// evaluated, so the cost per sample is constant.
  template <class X, class P>
  auto value(const X* variables, const P* parameters) const noexcept {
    return parsed_.code.value(variables, parameters);
  }

 private:
  Formula() = default;

  std::string text_;
  std::vector<std::string> parameters_;
  ParsedFormula parsed_;
};

inline std::optional<Formula> Formula::parse(std::string_view text,
                                             const std::vector<std::string>& parameters,
                                             FormulaError* error) {
  Formula formula;
  formula.text_ = text;
  formula.parameters_ = parameters;
  FormulaError ignored;
  FormulaParser parser(text, parameters, formula.parsed_, error != nullptr ? *error : ignored);
  if (!parser.parse()) return std::nullopt;
  return formula;
}

}  // namespace pcor
