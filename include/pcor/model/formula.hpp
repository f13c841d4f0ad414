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
/// Arithmetic follows IEEE 754: outside its domain a function is NaN, `log(0)` is -infinity, a division by
/// zero is infinite or NaN.
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

/// Recursive descent parser, one function for each level of precedence. Each function pushes one operand on
/// the stack of the generated code, or sets the error and returns false.
class Formula::Parser {
 public:
  Parser(Formula& formula, FormulaError& error)
      : formula_(formula), text_(formula.text_), error_(error), used_(formula.parameters_.size(), false) {}

  bool parse() {
    if (!check_parameters()) return false;
    if (peek(); at_ == text_.size()) return fail(0, "the formula is empty");
    if (!sum()) return false;
    if (peek() == ')') return fail(at_, "the ')' at " + column(at_) + " closes nothing");
    if (at_ != text_.size()) return unexpected("an operator");
    if (!operands_.back().has_parameters) set_apart_variables(1);
    for (std::size_t i = 0; i < used_.size(); ++i) {
      if (!used_[i]) formula_.unused_parameters_.push_back(formula_.parameters_[i]);
    }
    return true;
  }

 private:
  /// Range of the code that computes one stack value.
  struct Operand {
    std::size_t begin;
    bool has_parameters;
  };

  static bool is_digit(char c) { return c >= '0' && c <= '9'; }
  static bool begins_name(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
  static bool continues_name(char c) { return begins_name(c) || is_digit(c); }

  /// Next non-space character, NUL at the end.
  char peek() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
      ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }

  bool accept(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }

  std::string_view word() const {
    std::size_t end = at_;
    while (end < text_.size() && continues_name(text_[end])) ++end;
    return text_.substr(at_, end - at_);
  }

  bool check_parameters() {
    const auto& names = formula_.parameters_;
    for (auto name = names.begin(); name != names.end(); ++name) {
      const std::string parameter = "the parameter " + quote(*name);
      if (name->empty() || !begins_name(name->front()) ||
          !std::all_of(name->begin(), name->end(), continues_name)) {
        return reject(parameter + " is not a name: letters, digits and _, beginning with no digit");
      }
      if (function(*name) != nullptr) return reject(parameter + " has the name of a function");
      if (*name == "pi") return reject(parameter + " has the name of the constant");
      if (std::find(names.begin(), name, *name) != name) return reject(parameter + " is declared twice");
    }
    return true;
  }

  bool sum() {
    if (!product()) return false;
    while (true) {
      if (accept('+')) {
        if (!product() || !push({Operation::add}, 2)) return false;
      } else if (accept('-')) {
        if (!product() || !push({Operation::subtract}, 2)) return false;
      } else {
        return true;
      }
    }
  }

  bool product() {
    if (!factor()) return false;
    while (true) {
      if (accept('*')) {
        if (!factor() || !push({Operation::multiply}, 2)) return false;
      } else if (accept('/')) {
        if (!factor() || !push({Operation::divide}, 2)) return false;
      } else {
        return true;
      }
    }
  }

  /// Operand with its signs and exponent. All nesting passes through this function.
  bool factor() {
    if (++nesting_ > max_nesting) {
      return fail(at_, "the formula is nested too deep at " + column(at_) + ": more than " +
                           std::to_string(max_nesting) + " levels");
    }
    bool done = false;
    if (accept('-')) {
      done = factor() && push({Operation::negate}, 1);
    } else if (accept('+')) {
      done = factor();
    } else {
      done = primary() && (!accept('^') || (factor() && push_power()));
    }
    --nesting_;
    return done;
  }

  bool primary() {
    const char next = peek();
    if (is_digit(next) || next == '.') return number();
    if (begins_name(next)) return name();
    const std::size_t begin = at_;
    if (!accept('(')) return unexpected("a value");
    return sum() && (accept(')') || unexpected("')' for the '(' of " + column(begin)));
  }

  bool number() {
    double value = 0.0;
    const char* const begin = text_.data() + at_;
    const auto [end, status] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (status == std::errc::invalid_argument) return unexpected("a value");
    if (status != std::errc()) return fail(at_, "the number at " + column(at_) + " is out of range");
    at_ += static_cast<std::size_t>(end - begin);
    return push({Operation::constant, 0, value});
  }

  bool name() {
    const std::size_t begin = at_;
    const std::string_view name = word();
    at_ += name.size();
    if (name == "pi") return push({Operation::constant, 0, 3.14159265358979323846});
    if (const Function* const known = function(name)) {
      if (accept('(')) return call(*known, begin);
      return fail(
          begin, "the function " + quote(name) + " at " + column(begin) + " has no arguments in parentheses");
    }
    auto& parameters = formula_.parameters_;
    const auto parameter = std::find(parameters.begin(), parameters.end(), name);
    if (parameter != parameters.end()) {
      const auto index = static_cast<std::size_t>(parameter - parameters.begin());
      used_[index] = true;
      return push({Operation::parameter, static_cast<std::uint32_t>(index)}, 0, true);
    }
    if (peek() == '(') return unknown_function(name, begin);
    auto& variables = formula_.variables_;
    const auto variable = std::find(variables.begin(), variables.end(), name);
    const auto index = static_cast<std::uint32_t>(variable - variables.begin());
    if (variable == variables.end()) variables.emplace_back(name);
    return push({Operation::variable, index});
  }

  /// Arguments after the parenthesis of the function whose name is at `begin`.
  bool call(const Function& called, std::size_t begin) {
    Operation operation = called.operation;
    const bool is_if = operation == Operation::if_less;
    std::size_t arguments = 0;
    if (!accept(')')) {
      do {
        if (!(is_if && arguments == 0 ? comparison(operation) : sum())) return false;
        ++arguments;
      } while (accept(','));
      if (!accept(')')) return unexpected("',' or ')'");
    }
    if (arguments != called.arguments) {
      return fail(begin, "the function " + quote(called.name) + " at " + column(begin) + " takes " +
                             std::to_string(called.arguments) +
                             (called.arguments == 1 ? " argument" : " arguments") + ", not " +
                             std::to_string(arguments));
    }
    if (operation == Operation::power) return push_power();
    return push({operation}, is_if ? 4 : arguments);
  }

  /// Two operands and the comparison `operation`.
  bool comparison(Operation& operation) {
    if (!sum()) return false;
    if (accept('<')) {
      operation = accept('=') ? Operation::if_less_equal : Operation::if_less;
    } else if (accept('>')) {
      operation = accept('=') ? Operation::if_greater_equal : Operation::if_greater;
    } else {
      return unexpected("a comparison (<, <=, > or >=)");
    }
    return sum();
  }

  /// Appends an instruction that replaces the last operands by its result.
  bool push(Instruction instruction, std::size_t operands = 0, bool has_parameters = false) {
    auto& code = formula_.code_;
    const auto first = operands_.end() - static_cast<std::ptrdiff_t>(operands);
    for (auto operand = first; operand != operands_.end(); ++operand)
      has_parameters |= operand->has_parameters;
    if (has_parameters) set_apart_variables(operands);
    const std::size_t begin = operands == 0 ? code.size() : first->begin;
    operands_.erase(first, operands_.end());
    operands_.push_back({begin, has_parameters});
    code.push_back(instruction);
    if (operands > 0) fold(begin, operands);
    if (code.size() > max_instructions) {
      return fail(at_, "the formula is too long at " + column(at_) + ": more than " +
                           std::to_string(max_instructions) + " numbers, names and operations");
    }
    if (operands_.size() > max_stack) {
      return fail(at_, "the formula is too deep at " + column(at_) + ": more than " +
                           std::to_string(max_stack) + " intermediate results");
    }
    return true;
  }

  /// Powers with a constant exponent have a separate instruction.
  bool push_power() {
    const Instruction exponent = formula_.code_.back();
    if (exponent.operation != Operation::constant) return push({Operation::power}, 2);
    formula_.code_.pop_back();
    operands_.pop_back();
    const bool is_integer =
        std::abs(exponent.number) <= max_integer_exponent && std::trunc(exponent.number) == exponent.number;
    return push({is_integer ? Operation::integer_power : Operation::constant_power, 0, exponent.number}, 1);
  }

  /// Replaces an operation on constants, which begins at `begin`, by its value.
  void fold(std::size_t begin, std::size_t operands) {
    auto& code = formula_.code_;
    if (code.size() != begin + operands + 1) return;
    const Instruction* const at = code.data() + begin;
    const auto is_constant = [](const Instruction& i) { return i.operation == Operation::constant; };
    if (!std::all_of(at, at + operands, is_constant)) return;
    const double* const none = nullptr;
    const auto result = run<double>(at, at + operands + 1, none, none);
    code.resize(begin);
    code.push_back({Operation::constant, 0, result});
  }

  /// Marks the code of those of the last operands that depend only on variables, so that it runs in the type
  /// of the variables: this is faster, and avoids a NaN in dual numbers of the parameters from the derivative
  /// of sqrt(0).
  void set_apart_variables(std::size_t operands) {
    auto& code = formula_.code_;
    std::size_t end = code.size();
    for (auto operand = operands_.rbegin(); operands > 0; ++operand, --operands) {
      const std::size_t length = end - operand->begin;
      end = operand->begin;
      if (operand->has_parameters || length == 1) continue;
      code.insert(code.begin() + static_cast<std::ptrdiff_t>(end),
                  {Operation::of_variables, static_cast<std::uint32_t>(length)});
    }
  }

  /// Sets the error; `at` is its position in the text.
  bool fail(std::size_t at, std::string message) {
    error_ = {at + 1, std::move(message)};
    return false;
  }

  /// Sets an error without a position in the text.
  bool reject(std::string message) {
    error_ = {0, std::move(message)};
    return false;
  }

  bool unexpected(const std::string& expected) {
    const char next = peek();
    if (next == '<' || next == '>') {
      return fail(at_, "the comparison at " + column(at_) + " is not the first argument of an if");
    }
    const bool python_power = next == '*' && at_ > 0 && text_[at_ - 1] == '*';
    return fail(at_, "expected " + expected + " at " + column(at_) + ", found " + found() +
                         (python_power ? "; a power is written ^" : ""));
  }

  bool unknown_function(std::string_view name, std::size_t begin) {
    std::string names;
    for (const Function& known : functions) names.append(names.empty() ? "" : ", ").append(known.name);
    return fail(begin,
                "unknown function " + quote(name) + " at " + column(begin) + "; the functions are " + names);
  }

  static std::string column(std::size_t at) { return "column " + std::to_string(at + 1); }

  /// Quoted, shortened to one line.
  static std::string quote(std::string_view text) {
    constexpr std::size_t longest = 40;
    std::string result = "'";
    for (const char c : text.substr(0, longest)) result += c >= '\0' && c < ' ' ? '?' : c;
    return result + (text.size() > longest ? "...'" : "'");
  }

  /// Token at the current position: a word, or one character, which may be several bytes of UTF-8.
  std::string found() const {
    if (at_ == text_.size()) return "the end";
    if (continues_name(text_[at_])) return quote(word());
    std::size_t end = at_ + 1;
    while (end < text_.size() && (static_cast<unsigned char>(text_[end]) & 0xC0U) == 0x80U) ++end;
    return quote(text_.substr(at_, end - at_));
  }

  Formula& formula_;
  std::string_view text_;
  FormulaError& error_;
  std::vector<bool> used_;
  std::vector<Operand> operands_;
  std::size_t at_ = 0;
  std::size_t nesting_ = 0;
};

inline std::optional<Formula> Formula::parse(std::string_view text,
                                             const std::vector<std::string>& parameters,
                                             FormulaError* error) {
  Formula formula;
  formula.text_ = text;
  formula.parameters_ = parameters;
  FormulaError ignored;
  if (!Parser(formula, error != nullptr ? *error : ignored).parse()) return std::nullopt;
  return formula;
}

}  // namespace pcor
