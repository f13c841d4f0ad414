#include <pcor/model/formula.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <new>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

namespace {

std::atomic<std::size_t> allocations{0};

}  // namespace

// Not inlined, or the compiler sees a free for every new and warns.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size)) return memory;
  std::abort();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace pcor {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::IsNan;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Column and message.
std::string error_of(const std::string& text, const std::vector<std::string>& parameters = {}) {
  FormulaError error;
  EXPECT_FALSE(Formula::parse(text, parameters, &error)) << text;
  return std::to_string(error.column) + ": " + error.message;
}

/// The value, each variable taken by its name from `values`.
double evaluate(const std::string& text, const std::vector<std::pair<std::string, double>>& values = {}) {
  FormulaError error;
  const auto formula = Formula::parse(text, {}, &error);
  if (!formula) {
    ADD_FAILURE() << text << ": " << error.message;
    return nan;
  }
  std::vector<double> variables;
  for (const auto& name : formula->variables()) {
    const auto found =
        std::find_if(values.begin(), values.end(), [&](const auto& value) { return value.first == name; });
    if (found == values.end()) ADD_FAILURE() << text << ": no value for " << name;
    variables.push_back(found == values.end() ? nan : found->second);
  }
  const double* const no_parameters = nullptr;
  return formula->value(variables.data(), no_parameters);
}

double with_abc(const std::string& text) { return evaluate(text, {{"a", 3.0}, {"b", 4.0}, {"c", 0.5}}); }

struct Example {
  const char* text;
  double value;
};

// The values are Python's, for the same text with ** in the place of ^ and a = 3, b = 4, c = 0.5.
TEST(Formula, HasThePrecedenceOfMathematics) {
  const Example examples[] = {
      {"1+2*3", 7.0},    {"(1+2)*3", 9.0},      {"10-4-3", 3.0},    {"100/10/5", 2.0},     {"2*3/4*5", 7.5},
      {"-a^2", -9.0},    {"(-a)^2", 9.0},       {"2^3^2", 512.0},   {"(2^3)^2", 64.0},     {"2^-1", 0.5},
      {"-2^-2", -0.25},  {"2^-3^2", 1.0 / 512}, {"a^2*b", 36.0},    {"a*b^2", 48.0},       {"-a*b", -12.0},
      {"a - -b", 7.0},   {"--a", 3.0},          {"-(-a)", 3.0},     {"+a", 3.0},           {"a+-b^2", -13.0},
      {"a^b^c", 9.0},    {"(a^b)^c", 9.0},      {"a/b^2", 0.1875},  {"a/b*c", 0.375},      {"a-b+c", -0.5},
      {"a-(b+c)", -1.5}, {"a/(b*c)", 1.5},      {"((((a))))", 3.0}, {" a\n +\t b\r", 7.0}, {"a*-b", -12.0},
      {"2*-a^2", -18.0}, {"a-b-c*2^2", -3.0},   {"-a-b", -7.0},     {"a/-b", -0.75},       {"a--b", 7.0},
  };
  for (const auto& [text, value] : examples) EXPECT_EQ(with_abc(text), value) << text;
}

TEST(Formula, ReadsNumbersAndTheConstant) {
  const Example examples[] = {
      {"1", 1.0},       {".5", 0.5},        {"1.", 1.0},
      {"1e-3", 1e-3},   {"1e-3*1E3", 1.0},  {"1.5e+2", 150.0},
      {"00.1", 0.1},    {"0.1", 0.1},       {"123456789.125", 123456789.125},
      {"1e308", 1e308}, {"1e-308", 1e-308}, {"pi", 3.141592653589793},
  };
  for (const auto& [text, value] : examples) EXPECT_EQ(evaluate(text), value) << text;
}

// Python's math module, to the last digits that two libraries may print differently.
TEST(Formula, AcceptsEachFunction) {
  const Example examples[] = {
      {"sqrt(a^2+b^2)", 5.0},
      {"abs(-a)", 3.0},
      {"abs(a)", 3.0},
      {"exp(c)", 1.6487212707001282},
      {"log(b)", 1.3862943611198906},
      {"log10(1000*a)", 3.4771212547196626},
      {"sin(pi/6)", 0.5},
      {"cos(pi/3)", 0.5},
      {"tan(c)", 0.5463024898437905},
      {"tanh(c)", 0.46211715726000974},
      {"min(a, b)", 3.0},
      {"min(b, a)", 3.0},
      {"max(a, b)", 4.0},
      {"max(-c, -b)", -0.5},
      {"pow(a, c)", 1.7320508075688772},
      {"pow(a, 2)", 9.0},
      {"pow(2, 10)", 1024.0},
      {"min(max(a, c), b - c)", 3.0},
      {"exp(log(a)*b)", 81.0},
      {"a^(b-c)", 46.76537180435969},
      {"a^1.5", 5.196152422706632},
      {"b^0.5", 2.0},
      {"2^.5", 1.4142135623730951},
      {"sqrt (4)", 2.0},
  };
  for (const auto& [text, value] : examples) EXPECT_DOUBLE_EQ(with_abc(text), value) << text;
}

TEST(Formula, IntegerPowersAreProducts) {
  for (const double x : {-3.7, -1.0, 0.1, 1.3, 12.7}) {
    EXPECT_EQ(evaluate("x^2", {{"x", x}}), x * x);
    EXPECT_EQ(evaluate("x^3", {{"x", x}}), x * x * x);
    EXPECT_EQ(evaluate("x^0", {{"x", x}}), 1.0);
    EXPECT_EQ(evaluate("x^1", {{"x", x}}), x);
    EXPECT_EQ(evaluate("x^-1", {{"x", x}}), 1.0 / x);
    for (const int n : {-7, -4, -2, 4, 5, 6, 7, 10, 13}) {
      const double exact = std::pow(x, n);
      EXPECT_NEAR(evaluate("x^" + std::to_string(n), {{"x", x}}), exact, 4e-15 * std::abs(exact))
          << x << " " << n;
    }
  }
  EXPECT_EQ(evaluate("2^1000", {}), std::ldexp(1.0, 1000));
  EXPECT_EQ(evaluate("x^1024", {{"x", -1.0}}), 1.0);
  EXPECT_EQ(evaluate("x^1025", {{"x", -1.0}}), -1.0);
}

TEST(Formula, ChoosesByComparison) {
  const auto choice = [](const char* comparison, double x, double y) {
    return evaluate("if(x " + std::string(comparison) + " y, 10, 20)", {{"x", x}, {"y", y}});
  };
  EXPECT_EQ(choice("<", 1.0, 2.0), 10.0);
  EXPECT_EQ(choice("<", 2.0, 2.0), 20.0);
  EXPECT_EQ(choice("<", 3.0, 2.0), 20.0);
  EXPECT_EQ(choice("<=", 1.0, 2.0), 10.0);
  EXPECT_EQ(choice("<=", 2.0, 2.0), 10.0);
  EXPECT_EQ(choice("<=", 3.0, 2.0), 20.0);
  EXPECT_EQ(choice(">", 1.0, 2.0), 20.0);
  EXPECT_EQ(choice(">", 2.0, 2.0), 20.0);
  EXPECT_EQ(choice(">", 3.0, 2.0), 10.0);
  EXPECT_EQ(choice(">=", 1.0, 2.0), 20.0);
  EXPECT_EQ(choice(">=", 2.0, 2.0), 10.0);
  EXPECT_EQ(choice(">=", 3.0, 2.0), 10.0);
  EXPECT_EQ(choice("<", infinity, infinity), 20.0);
  EXPECT_EQ(with_abc("2 * if(a + 1 < b * 2, if(c > 1, 1, 7), 3) + 1"), 15.0);
  EXPECT_EQ(evaluate("if(x < 0, 0, sqrt(x))", {{"x", -1.0}}), 0.0) << "the branch not taken may be NaN";
}

TEST(Formula, DomainErrorIsNanAndZeroDivisionIsInfinite) {
  for (const char* text :
       {"sqrt(x)", "log(x)", "log10(x)", "x^1.5", "x^y", "pow(x, 0.5)", "0/(x+1)", "sqrt(-1)"}) {
    EXPECT_THAT(evaluate(text, {{"x", -1.0}, {"y", 0.5}}), IsNan()) << text;
  }
  EXPECT_EQ(evaluate("1/x", {{"x", 0.0}}), infinity);
  EXPECT_EQ(evaluate("-1/x", {{"x", 0.0}}), -infinity);
  EXPECT_EQ(evaluate("x^-2", {{"x", 0.0}}), infinity);
  EXPECT_EQ(evaluate("log(x)", {{"x", 0.0}}), -infinity);
  EXPECT_EQ(evaluate("exp(x)", {{"x", 1e4}}), infinity);
  EXPECT_EQ(evaluate("1/0"), infinity);
}

TEST(Formula, NanInputGivesNan) {
  for (const char* text : {"min(x, y)", "max(x, y)", "if(x < y, 1, 2)", "if(x <= y, 1, 2)", "if(x > y, 1, 2)",
                           "if(x >= y, 1, 2)", "x^(y-1)", "x^y", "abs(x + y)", "max(x, -0.31) + y"}) {
    EXPECT_THAT(evaluate(text, {{"x", nan}, {"y", 1.0}}), IsNan()) << text;
    EXPECT_THAT(evaluate(text, {{"x", 1.0}, {"y", nan}}), IsNan()) << text;
    EXPECT_THAT(evaluate(text, {{"x", nan}, {"y", nan}}), IsNan()) << text;
  }
  EXPECT_THAT(evaluate("if(1 < 2, x, 0)", {{"x", nan}}), IsNan());
}

TEST(Formula, SeparatesVariablesAndParameters) {
  const auto formula = Formula::parse("k * ENGTRQ / 100 + c1*(_b + ENGTRQ) + a", {"c0", "c1", "k", "unused"});
  ASSERT_TRUE(formula);
  EXPECT_EQ(formula->text(), "k * ENGTRQ / 100 + c1*(_b + ENGTRQ) + a");
  EXPECT_THAT(formula->variables(), ElementsAre("ENGTRQ", "_b", "a"));
  EXPECT_THAT(formula->parameters(), ElementsAre("c0", "c1", "k", "unused"));
  EXPECT_THAT(formula->unused_parameters(), ElementsAre("c0", "unused"));
  const double variables[] = {50.0, 7.0, 0.25};
  const double parameters[] = {nan, 2.0, 3.0, nan};
  EXPECT_EQ(formula->value(variables, parameters), 3.0 * 50.0 / 100.0 + 2.0 * 57.0 + 0.25);
}

TEST(Formula, MayHaveNoVariablesOrParameters) {
  const auto formula = Formula::parse("2*pi", {});
  ASSERT_TRUE(formula);
  EXPECT_THAT(formula->variables(), IsEmpty());
  const double* const none = nullptr;
  EXPECT_EQ(formula->value(none, none), 6.283185307179586);
}

TEST(Formula, CopyIsIndependentOfTextAndOriginal) {
  std::string text = "k*x + sqrt(x)*k";
  auto formula = Formula::parse(text, {"k"});
  ASSERT_TRUE(formula);
  const Formula copy = *formula;
  text.assign(text.size(), '?');
  formula.reset();
  const double x = 4.0, k = 3.0;
  EXPECT_EQ(copy.text(), "k*x + sqrt(x)*k");
  EXPECT_EQ(copy.value(&x, &k), 18.0);
}

TEST(FormulaError, NamesCauseAndPosition) {
  EXPECT_EQ(error_of(""), "1: the formula is empty");
  EXPECT_EQ(error_of(" \n\t "), "1: the formula is empty");
  EXPECT_EQ(
      error_of("2 * sine(x)"),
      "5: unknown function 'sine' at column 5; the functions are sqrt, abs, exp, log, log10, sin, cos, tan, "
      "tanh, min, max, pow, if");
  EXPECT_EQ(error_of("1 + "), "5: expected a value at column 5, found the end");
  EXPECT_EQ(error_of("1 + * 2"), "5: expected a value at column 5, found '*'");
  EXPECT_EQ(error_of("x**2"), "3: expected a value at column 3, found '*'; a power is written ^");
  EXPECT_EQ(error_of("()"), "2: expected a value at column 2, found ')'");
  EXPECT_EQ(error_of("(1 + (2)"), "9: expected ')' for the '(' of column 1 at column 9, found the end");
  EXPECT_EQ(error_of("1 + 2)"), "6: the ')' at column 6 closes nothing");
  EXPECT_EQ(error_of("2 x1 + 3"), "3: expected an operator at column 3, found 'x1'");
  EXPECT_EQ(error_of("2(x)"), "2: expected an operator at column 2, found '('");
  EXPECT_EQ(error_of("k (x)", {"k"}), "3: expected an operator at column 3, found '('");
  EXPECT_EQ(error_of("1.2.3"), "4: expected an operator at column 4, found '.'");
  EXPECT_EQ(error_of("1e"), "2: expected an operator at column 2, found 'e'");
  EXPECT_EQ(error_of("."), "1: expected a value at column 1, found '.'");
  EXPECT_EQ(error_of("1,5*x"), "2: expected an operator at column 2, found ','");
  EXPECT_EQ(error_of("x = 2"), "3: expected an operator at column 3, found '='");
  EXPECT_EQ(error_of("x + $"), "5: expected a value at column 5, found '$'");
  EXPECT_EQ(error_of("2 \u00d7 x"), "3: expected an operator at column 3, found '\u00d7'");
  EXPECT_EQ(error_of(std::string("x\0y", 3)), "2: expected an operator at column 2, found '?'");
  EXPECT_EQ(error_of("1e999 * x"), "1: the number at column 1 is out of range");
}

TEST(FormulaError, NamesCauseInACall) {
  EXPECT_EQ(error_of("1 + sqrt"), "5: the function 'sqrt' at column 5 has no arguments in parentheses");
  EXPECT_EQ(error_of("1 + sqrt()"), "5: the function 'sqrt' at column 5 takes 1 argument, not 0");
  EXPECT_EQ(error_of("sqrt(x, y)"), "1: the function 'sqrt' at column 1 takes 1 argument, not 2");
  EXPECT_EQ(error_of("x*min(x)"), "3: the function 'min' at column 3 takes 2 arguments, not 1");
  EXPECT_EQ(error_of("if(x < 1, 2)"), "1: the function 'if' at column 1 takes 3 arguments, not 2");
  EXPECT_EQ(error_of("if()"), "1: the function 'if' at column 1 takes 3 arguments, not 0");
  EXPECT_EQ(error_of("min(x,)"), "7: expected a value at column 7, found ')'");
  EXPECT_EQ(error_of("min(x y)"), "7: expected ',' or ')' at column 7, found 'y'");
  EXPECT_EQ(error_of("sqrt(x"), "7: expected ',' or ')' at column 7, found the end");
  EXPECT_EQ(error_of("if(x, 1, 2)"), "5: expected a comparison (<, <=, > or >=) at column 5, found ','");
  EXPECT_EQ(error_of("if(x == 1, 1, 2)"), "6: expected a comparison (<, <=, > or >=) at column 6, found '='");
  EXPECT_EQ(error_of("if(1 < x < 2, 1, 2)"),
            "10: the comparison at column 10 is not the first argument of an if");
  EXPECT_EQ(error_of("(x < 1) * 2"), "4: the comparison at column 4 is not the first argument of an if");
  EXPECT_EQ(error_of("x > 1"), "3: the comparison at column 3 is not the first argument of an if");
}

TEST(FormulaError, NamesCauseInAParameter) {
  EXPECT_EQ(error_of("x", {"a b"}),
            "0: the parameter 'a b' is not a name: letters, digits and _, beginning with no digit");
  EXPECT_EQ(error_of("x", {""}),
            "0: the parameter '' is not a name: letters, digits and _, beginning with no digit");
  EXPECT_EQ(error_of("x", {"1a"}),
            "0: the parameter '1a' is not a name: letters, digits and _, beginning with no digit");
  EXPECT_EQ(error_of("x", {"a", "exp"}), "0: the parameter 'exp' has the name of a function");
  EXPECT_EQ(error_of("x", {"pi"}), "0: the parameter 'pi' has the name of the constant");
  EXPECT_EQ(error_of("x", {"a", "b", "a"}), "0: the parameter 'a' is declared twice");
}

std::string repeated(const std::string& text, std::size_t times) {
  std::string result;
  for (std::size_t i = 0; i < times; ++i) result += text;
  return result;
}

TEST(FormulaError, LimitsLengthDepthAndNesting) {
  // n terms are 2 n - 1 instructions.
  const std::size_t terms = Formula::max_instructions / 2;
  EXPECT_EQ(evaluate("x" + repeated("+x", terms - 1), {{"x", 1.0}}), 128.0);
  EXPECT_EQ(error_of("x" + repeated("+x", terms)),
            "258: the formula is too long at column 258: more than 256 numbers, names and operations");

  // x-(x-(x-... holds a value for each parenthesis.
  const auto deep = [](std::size_t values) {
    return repeated("x-(", values - 1) + "x" + repeated(")", values - 1);
  };
  EXPECT_EQ(evaluate(deep(Formula::max_stack), {{"x", 1.0}}), 0.0);
  EXPECT_EQ(error_of(deep(Formula::max_stack + 1)),
            "98: the formula is too deep at column 98: more than 32 intermediate results");

  const auto nested = [](std::size_t levels) {
    return repeated("(", levels - 1) + "x" + repeated(")", levels - 1);
  };
  EXPECT_EQ(evaluate(nested(Formula::max_nesting), {{"x", 2.0}}), 2.0);
  EXPECT_EQ(error_of(nested(Formula::max_nesting + 1)),
            "65: the formula is nested too deep at column 65: more than 64 levels");
  for (const char* endless : {"(", "-", "x^", "sqrt(", "if(", "min(x,"}) {
    EXPECT_THAT(error_of(repeated(endless, 100000)), testing::HasSubstr("more than")) << endless;
  }
}

TEST(FormulaError, KeepsMessagesShortAndOnOneLine) {
  const std::string message = error_of("x \n" + std::string(1000, 'y') + "\n");
  EXPECT_EQ(message, "4: expected an operator at column 4, found '" + std::string(40, 'y') + "...'");
  EXPECT_EQ(error_of("x", {"a\nb"}).find('\n'), std::string::npos);
}

TEST(FormulaError, IsOptionalAndUnchangedOnSuccess) {
  EXPECT_FALSE(Formula::parse("1 +", {}));
  FormulaError error{7, "unchanged"};
  EXPECT_TRUE(Formula::parse("1", {}, &error));
  EXPECT_EQ(error.column, 7U);
}

TEST(Formula, EvaluatesWithoutAllocationOrException) {
  const auto formula = Formula::parse(
      "if(a < b, c0 + c1*sqrt(dynamic_ratio) + c3*dynamic_ratio^1.5, max(a, tanh(b))) * static_pressure + "
      "log10(a^2 + pow(b, a)) - sin(a)*cos(b)*tan(a) + exp(-abs(min(a, b))) + log(a)",
      {"c0", "c1", "c3"});
  ASSERT_TRUE(formula);
  const double variables[] = {0.4, 0.7, 0.2, 500.0};
  const double parameters[] = {0.004, 0.03, 0.01};
  static_assert(noexcept(formula->value(variables, parameters)));
  static_assert(std::is_same_v<decltype(formula->value(variables, parameters)), double>);
  const std::size_t before = allocations;
  const double value = formula->value(variables, parameters);
  EXPECT_EQ(allocations, before);
  // Python: the same expression with the same values.
  EXPECT_NEAR(value, 8.795108025537768, 1e-13);
}

/// An expression as a tree, which is evaluated without a stack and printed with the fewest parentheses.
struct Tree {
  enum Kind { number, name, minus, plus, difference, product, quotient, power, function, two, choice };
  Kind kind = number;
  double value = 0.0;
  std::size_t which = 0;
  std::vector<Tree> parts;
};

constexpr const char* tree_names[] = {"x", "y", "z", "k0", "k1"};
constexpr const char* tree_functions[] = {"sqrt", "abs", "exp", "log", "log10", "sin", "cos", "tan", "tanh"};
constexpr const char* tree_comparisons[] = {"<", "<=", ">", ">="};

double tree_value(const Tree& tree, const double (&values)[5]) {
  const auto part = [&](std::size_t i) { return tree_value(tree.parts[i], values); };
  switch (tree.kind) {
    case Tree::number:
      return tree.value;
    case Tree::name:
      return values[tree.which];
    case Tree::minus:
      return -part(0);
    case Tree::plus:
      return part(0) + part(1);
    case Tree::difference:
      return part(0) - part(1);
    case Tree::product:
      return part(0) * part(1);
    case Tree::quotient:
      return part(0) / part(1);
    case Tree::power: {
      const double base = part(0);
      if (tree.parts[1].kind == Tree::number && tree.parts[1].value == 3.0) return base * base * base;
      if (tree.parts[1].kind != Tree::number && std::isnan(base)) return nan;
      return std::pow(base, part(1));
    }
    case Tree::function: {
      double (*const functions[])(double) = {std::sqrt, std::abs, std::exp, std::log, std::log10,
                                             std::sin,  std::cos, std::tan, std::tanh};
      return functions[tree.which](part(0));
    }
    case Tree::two: {
      const double a = part(0), b = part(1);
      if (std::isnan(a) || std::isnan(b)) return nan;
      return tree.which == 0 ? std::fmin(a, b) : std::fmax(a, b);
    }
    case Tree::choice: {
      const double a = part(0), b = part(1);
      if (std::isnan(a) || std::isnan(b)) return nan;
      const bool holds[] = {a<b, a <= b, a> b, a >= b};
      return holds[tree.which] ? part(2) : part(3);
    }
  }
  return nan;
}

/// `binding` is the loosest precedence that needs no parentheses: 1 sum, 2 product, 3 sign, 4 power, 5 atom.
std::string tree_text(const Tree& tree, int binding, std::mt19937& random) {
  const auto part = [&](std::size_t i, int of) {
    return std::string(random() % 3, ' ') + tree_text(tree.parts[i], of, random) +
           std::string(random() % 2, ' ');
  };
  std::string text;
  int precedence = 5;
  switch (tree.kind) {
    case Tree::number: {
      char digits[40];
      std::snprintf(digits, sizeof digits, "%.17g", tree.value);
      text = digits;
      break;
    }
    case Tree::name:
      text = tree_names[tree.which];
      break;
    case Tree::minus:
      precedence = 3;
      text = "-" + part(0, 3);
      break;
    case Tree::plus:
      precedence = 1;
      text = part(0, 1) + "+" + part(1, 2);
      break;
    case Tree::difference:
      precedence = 1;
      text = part(0, 1) + "-" + part(1, 2);
      break;
    case Tree::product:
      precedence = 2;
      text = part(0, 2) + "*" + part(1, 3);
      break;
    case Tree::quotient:
      precedence = 2;
      text = part(0, 2) + "/" + part(1, 3);
      break;
    case Tree::power:
      if (random() % 4 == 0) {
        text = "pow(" + part(0, 1) + "," + part(1, 1) + ")";
      } else {
        precedence = 4;
        text = part(0, 5) + "^" + part(1, 3);
      }
      break;
    case Tree::function:
      text = std::string(tree_functions[tree.which]) + "(" + part(0, 1) + ")";
      break;
    case Tree::two:
      text = std::string(tree.which == 0 ? "min(" : "max(") + part(0, 1) + "," + part(1, 1) + ")";
      break;
    case Tree::choice:
      text = "if(" + part(0, 1) + tree_comparisons[tree.which] + part(1, 1) + "," + part(2, 1) + "," +
             part(3, 1) + ")";
      break;
  }
  return precedence < binding || random() % 10 == 0 ? "(" + text + ")" : text;
}

Tree random_tree(std::mt19937& random, int depth) {
  const auto number = [&] { return static_cast<double>(random() % 4000) / 1000.0; };
  const auto leaf = [&]() -> Tree {
    if (random() % 3 == 0) return {Tree::number, number(), 0, {}};
    return {Tree::name, 0.0, random() % 5, {}};
  };
  if (depth == 0 || random() % 8 == 0) return leaf();
  const auto part = [&] { return random_tree(random, depth - 1); };
  switch (random() % 12) {
    case 0:
      return {Tree::minus, 0.0, 0, {part()}};
    case 1:
    case 2:
      return {Tree::plus, 0.0, 0, {part(), part()}};
    case 3:
      return {Tree::difference, 0.0, 0, {part(), part()}};
    case 4:
    case 5:
      return {Tree::product, 0.0, 0, {part(), part()}};
    case 6:
      return {Tree::quotient, 0.0, 0, {part(), part()}};
    case 7: {
      // Whole constant exponents but these are multiplied out, which is not std::pow to the last bit.
      const double exponents[] = {0.0, 1.0, 2.0, 3.0, 1.5, 0.5, 2.75};
      return {Tree::power, 0.0, 0, {part(), {Tree::number, exponents[random() % 7], 0, {}}}};
    }
    case 8:
      return {Tree::power, 0.0, 0, {part(), {Tree::name, 0.0, random() % 5, {}}}};
    case 9:
      return {Tree::function, 0.0, random() % 9, {part()}};
    case 10:
      return {Tree::two, 0.0, random() % 2, {part(), part()}};
    default:
      return {Tree::choice, 0.0, random() % 4, {part(), part(), part(), part()}};
  }
}

// The two do the same operations on the same numbers, so they agree exactly.
TEST(Formula, EqualsTheExpressionTreeOfItsText) {
  std::mt19937 random(20111102);
  int evaluated = 0, finite = 0;
  for (int i = 0; i < 20000; ++i) {
    const Tree tree = random_tree(random, 1 + i % 5);
    const std::string text = tree_text(tree, 1, random);
    FormulaError error;
    const auto formula = Formula::parse(text, {"k0", "k1"}, &error);
    if (!formula) {
      ASSERT_THAT(error.message, testing::HasSubstr("too long")) << text;
      continue;
    }
    double values[5];
    for (double& value : values) value = static_cast<double>(random() % 8001) / 2000.0 - 2.0;
    std::vector<double> variables;
    for (const auto& name : formula->variables()) {
      const auto found = std::find(std::begin(tree_names), std::end(tree_names), name);
      ASSERT_NE(found, std::end(tree_names)) << text;
      variables.push_back(values[found - std::begin(tree_names)]);
    }
    const double expected = tree_value(tree, values);
    const double value = formula->value(variables.data(), values + 3);
    if (std::isnan(expected)) {
      ASSERT_THAT(value, IsNan()) << text;
    } else {
      ASSERT_EQ(value, expected) << text;
    }
    ++evaluated;
    finite += std::isfinite(value) ? 1 : 0;
  }
  EXPECT_GT(evaluated, 19000);
  EXPECT_GT(finite, 8000);
}

TEST(Formula, ArbitraryTextIsParsedOrRejected) {
  const std::string pieces[] = {"x",    "k",   "1",   "2.5", "1e",   "(",    ")",  "+",  "-",
                                "*",    "/",   "^",   ",",   "<",    "<=",   ">",  "=",  "sqrt(",
                                "min(", "if(", "pow", "pi",  "\xc3", "\xff", "\n", " ",  ".",
                                "_",    "e",   "if",  "f(",  "1e99", "%",    "\"", "^-", ")*("};
  std::mt19937 random(7);
  int parsed = 0;
  for (int i = 0; i < 100000; ++i) {
    std::string text;
    const std::size_t length = random() % 14;
    for (std::size_t j = 0; j < length; ++j) text += pieces[random() % std::size(pieces)];
    FormulaError error;
    const auto formula = Formula::parse(text, {"k"}, &error);
    if (formula) {
      ++parsed;
      const std::vector<double> variables(formula->variables().size(), 0.5);
      const double k = 2.0;
      formula->value(variables.data(), &k);
    } else {
      ASSERT_LE(error.column, text.size() + 1) << text;
      ASSERT_GE(error.column, 1U) << text;
      ASSERT_EQ(error.message.find('\n'), std::string::npos) << text;
    }
  }
  EXPECT_GT(parsed, 1000);
}

}  // namespace
}  // namespace pcor
