#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/model/formula.hpp>

namespace pcor {

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
