#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <pcor/model/formula_code.hpp>

namespace pcor {

/// Parse error of a formula.
struct FormulaError {
  std::size_t column = 0;  ///< Position in the text, from 1; 0 for an error of a declared parameter.
  std::string message;     ///< Message of one line, with the column.
};

/// Names and code found in the text of a formula.
struct ParsedFormula {
  std::vector<std::string> variables{};          ///< Names of the variables in the order of appearance.
  std::vector<std::string> unused_parameters{};  ///< Declared parameters that do not appear in the text.
  FormulaCode code{};
};

/// Recursive descent parser, one function for each level of precedence. Each function pushes one operand on
/// the stack of the generated code, or sets the error and returns false.
class FormulaParser {
 public:
  static constexpr std::size_t max_nesting = 64;  ///< Nesting depth of parentheses, calls, signs and powers.

  /// The arguments must outlive the parser. @param parameters names of the coefficients
  FormulaParser(std::string_view text, const std::vector<std::string>& parameters, ParsedFormula& parsed,
                FormulaError& error)
      : text_(text), parameters_(parameters), parsed_(parsed), error_(error), used_(parameters.size()) {}

  /// Parses the whole text. False if it is not a formula: the error then holds the reason.
  bool parse() {
    if (!check_parameters()) return false;
    if (peek(); at_ == text_.size()) return fail(0, "the formula is empty");
    if (!sum()) return false;
    if (peek() == ')') return fail(at_, "the ')' at " + column(at_) + " closes nothing");
    if (at_ != text_.size()) return unexpected("an operator");
    if (!operands_.back().has_parameters) set_apart_variables(1);
    for (std::size_t i = 0; i < used_.size(); ++i) {
      if (!used_[i]) parsed_.unused_parameters.push_back(parameters_[i]);
    }
    return true;
  }

 private:
  using Operation = FormulaCode::Operation;
  using Instruction = FormulaCode::Instruction;

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

  static const Function* function(std::string_view name) noexcept {
    const auto found = std::find_if(std::begin(functions), std::end(functions),
                                    [&](const Function& known) { return known.name == name; });
    return found == std::end(functions) ? nullptr : found;
  }

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
    for (auto name = parameters_.begin(); name != parameters_.end(); ++name) {
      const std::string parameter = "the parameter " + quote(*name);
      if (name->empty() || !begins_name(name->front()) ||
          !std::all_of(name->begin(), name->end(), continues_name)) {
        return reject(parameter + " is not a name: letters, digits and _, beginning with no digit");
      }
      if (function(*name) != nullptr) return reject(parameter + " has the name of a function");
      if (*name == "pi") return reject(parameter + " has the name of the constant");
      if (std::find(parameters_.begin(), name, *name) != name)
        return reject(parameter + " is declared twice");
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
    const auto parameter = std::find(parameters_.begin(), parameters_.end(), name);
    if (parameter != parameters_.end()) {
      const auto index = static_cast<std::size_t>(parameter - parameters_.begin());
      used_[index] = true;
      return push({Operation::parameter, static_cast<std::uint32_t>(index)}, 0, true);
    }
    if (peek() == '(') return unknown_function(name, begin);
    auto& variables = parsed_.variables;
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
    auto& code = parsed_.code.instructions;
    const auto first = operands_.end() - static_cast<std::ptrdiff_t>(operands);
    for (auto operand = first; operand != operands_.end(); ++operand)
      has_parameters |= operand->has_parameters;
    if (has_parameters) set_apart_variables(operands);
    const std::size_t begin = operands == 0 ? code.size() : first->begin;
    operands_.erase(first, operands_.end());
    operands_.push_back({begin, has_parameters});
    code.push_back(instruction);
    if (operands > 0) fold(begin, operands);
    if (code.size() > FormulaCode::max_instructions) {
      return fail(at_, "the formula is too long at " + column(at_) + ": more than " +
                           std::to_string(FormulaCode::max_instructions) + " numbers, names and operations");
    }
    if (operands_.size() > FormulaCode::max_stack) {
      return fail(at_, "the formula is too deep at " + column(at_) + ": more than " +
                           std::to_string(FormulaCode::max_stack) + " intermediate results");
    }
    return true;
  }

  /// Powers with a constant exponent have a separate instruction.
  bool push_power() {
    const Instruction exponent = parsed_.code.instructions.back();
    if (exponent.operation != Operation::constant) return push({Operation::power}, 2);
    parsed_.code.instructions.pop_back();
    operands_.pop_back();
    const bool is_integer =
        std::abs(exponent.number) <= max_integer_exponent && std::trunc(exponent.number) == exponent.number;
    return push({is_integer ? Operation::integer_power : Operation::constant_power, 0, exponent.number}, 1);
  }

  /// Replaces an operation on constants, which begins at `begin`, by its value.
  void fold(std::size_t begin, std::size_t operands) {
    auto& code = parsed_.code.instructions;
    if (code.size() != begin + operands + 1) return;
    const Instruction* const at = code.data() + begin;
    const auto is_constant = [](const Instruction& i) { return i.operation == Operation::constant; };
    if (!std::all_of(at, at + operands, is_constant)) return;
    const double* const none = nullptr;
    const auto result = FormulaCode::run<double>(at, at + operands + 1, none, none);
    code.resize(begin);
    code.push_back({Operation::constant, 0, result});
  }

  /// Marks the code of those of the last operands that depend only on variables, so that it runs in the type
  /// of the variables: this is faster, and avoids a NaN in dual numbers of the parameters from the derivative
  /// of sqrt(0).
  void set_apart_variables(std::size_t operands) {
    auto& code = parsed_.code.instructions;
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

  std::string_view text_;
  const std::vector<std::string>& parameters_;
  ParsedFormula& parsed_;
  FormulaError& error_;
  std::vector<bool> used_;
  std::vector<Operand> operands_;
  std::size_t at_ = 0;
  std::size_t nesting_ = 0;
};

}  // namespace pcor
