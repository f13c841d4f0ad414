// data/models/FORMAT.md describes the program: its tables equal the tables of the code.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cstddef>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/model/effect.hpp>
#include <pcor/model/formula.hpp>
#include <pcor/model/quality.hpp>
#include <pcor/model/quantity.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/physics/recovery_factor.hpp>
#include <pcor/realtime/chain.hpp>
#include "model_io/minimum_model.hpp"
#include "model_io/output_table.hpp"

namespace pcor {
namespace {

using test::minimum_model;
using testing::ElementsAreArray;
using testing::HasSubstr;
using testing::Not;
using testing::UnorderedElementsAreArray;

using Lines = std::vector<std::string>;

Lines reference() {
  std::ifstream file(PCOR_SOURCE_DIR "/data/models/FORMAT.md");
  Lines lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

// The rows of every table in the reference whose heading has the cell `first` at its beginning.
std::vector<Lines> tables(const std::string& first) {
  std::vector<Lines> found;
  bool inside = false;
  for (const std::string& line : reference()) {
    if (line.rfind("| " + first + " |", 0) == 0) {
      inside = true;
      found.emplace_back();
    } else if (line.empty()) {
      inside = false;
    } else if (inside && line.rfind("|---", 0) != 0) {
      found.back().push_back(line);
    }
  }
  return found;
}

// The name in backquotes with which a row begins.
std::string first_cell(const std::string& row) {
  const std::size_t begin = row.find('`') + 1;
  return row.substr(begin, row.find('`', begin) - begin);
}

Lines first_cells(const Lines& rows) {
  Lines names;
  for (const std::string& row : rows) names.push_back(first_cell(row));
  return names;
}

// The rows of the table below a heading.
Lines rows_below(const std::string& heading) {
  const Lines lines = reference();
  Lines rows;
  std::size_t i = 0;
  while (i < lines.size() && lines[i] != heading) ++i;
  while (i < lines.size() && lines[i].rfind('|', 0) != 0) ++i;
  for (i += 2; i < lines.size() && lines[i].rfind('|', 0) == 0; ++i) rows.push_back(lines[i]);
  return rows;
}

std::string row_of(const QuantityInfo& info) {
  return fmt::format("| `{}` | {} | {} |", info.name, info.unit, info.description);
}

// Whether a formula may name the quantity where every role has a variable.
bool can_be_named(Quantity quantity) {
  std::vector<Quantity> roles;
  for (std::size_t i = 0; i < role_count; ++i) roles.push_back(static_cast<Quantity>(i));
  ModelEffect effect;
  effect.id = "own";
  effect.formula = "k * " + std::string(info_of(quantity).name);
  effect.parameter_names = {"k"};
  effect.parameters = {0.0};
  Model model;
  model.effects = {effect};
  return Chain::build(model, roles, nullptr).has_value();
}

// The names that the reader lists where it meets one that it does not know.
Lines names_listed_in(const std::string& message, const std::string& before) {
  Lines names;
  const std::size_t begin = message.rfind(before);
  if (begin == std::string::npos) return names;
  std::istringstream list(message.substr(begin + before.size()));
  for (std::string name; std::getline(list, name, ',');)
    names.push_back(name.substr(name.find_first_not_of(' ')));
  return names;
}

std::string message_of(const std::string& text) {
  try {
    parse_model(text, "m.toml");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ModelFormat, ListsTheRoles) {
  Lines rows;
  for (std::size_t i = 0; i < role_count; ++i) rows.push_back(row_of(quantity_info[i]));
  ASSERT_EQ(tables("role").size(), 1u);
  EXPECT_THAT(tables("role")[0], ElementsAreArray(rows));
}

TEST(ModelFormat, ListsTheQuantitiesThatAFormulaCanName) {
  Lines named, others;
  for (std::size_t i = 0; i < quantity_count; ++i) {
    const auto quantity = static_cast<Quantity>(i);
    if (is_role(quantity)) {
      EXPECT_TRUE(can_be_named(quantity)) << info_of(quantity).name;
    } else {
      (can_be_named(quantity) ? named : others).push_back(row_of(quantity_info[i]));
    }
  }
  ASSERT_EQ(tables("quantity").size(), 2u);
  EXPECT_THAT(tables("quantity")[0], ElementsAreArray(named));
  EXPECT_THAT(tables("quantity")[1], ElementsAreArray(others));
}

TEST(ModelFormat, ListsTheLocations) {
  Lines rows;
  for (const EffectLocationInfo& info : effect_location_info)
    rows.push_back(fmt::format("| `{}` | {} | {} |", info.name, info.unit, info.adds_to));
  ASSERT_EQ(tables("location").size(), 1u);
  EXPECT_THAT(tables("location")[0], ElementsAreArray(rows));
}

TEST(ModelFormat, ListsThePublishedRecoveryFactors) {
  Lines rows;
  for (const PublishedRecoveryFactor& law : published_recovery_factors) {
    const std::array<double, 4>& c = law.law.coefficients;
    std::string factor = fmt::format("{}", c[0]);
    if (!law.law.is_constant()) factor += fmt::format(" + {} L + {} L^2 + {} L^3", c[1], c[2], c[3]);
    rows.push_back(
        fmt::format("| `{}` | {} | {} | {} | {} |", law.name, law.sensor, factor, law.since, law.source));
  }
  ASSERT_EQ(tables("name").size(), 1u);
  EXPECT_THAT(tables("name")[0], ElementsAreArray(rows));
}

TEST(ModelFormat, ListsTheQualityBits) {
  Lines rows;
  for (const QualityInfo& info : quality_info) {
    rows.push_back(
        fmt::format("| {} | `{}` | {} |", static_cast<unsigned>(info.bit), info.name, info.meaning));
  }
  ASSERT_EQ(tables("bit").size(), 1u);
  EXPECT_THAT(tables("bit")[0], ElementsAreArray(rows));
}

TEST(ModelFormat, ListsTheResults) {
  ASSERT_EQ(tables("result").size(), 1u);
  EXPECT_THAT(first_cells(tables("result")[0]), ElementsAreArray(internal::output_names()));
}

TEST(ModelFormat, ListsTheKeysOfEveryTable) {
  const std::string unknown = "zzzzzzzz = 1\n";
  EXPECT_THAT(first_cells(rows_below("## Top-level keys")),
              UnorderedElementsAreArray(
                  names_listed_in(message_of("format = \"pcor-model/1\"\n" + unknown), "use one of ")));
  for (const std::string table : {"[lams]", "[temperature]", "[humidity]", "[radome]", "[policy]",
                                  "[[effect]]", "[law]", "[covariance]"}) {
    const Lines keys = names_listed_in(message_of(minimum_model + table + "\n" + unknown), "use one of ");
    EXPECT_THAT(keys, Not(testing::IsEmpty())) << table;
    EXPECT_THAT(first_cells(rows_below("## " + table)), UnorderedElementsAreArray(keys)) << table;
  }
}

TEST(ModelFormat, ListsTheLanguageOfFormulas) {
  ASSERT_EQ(tables("write").size(), 1u);
  Lines functions;
  for (const std::string& formula : first_cells(tables("write")[0])) {
    FormulaError error;
    EXPECT_TRUE(Formula::parse(formula, {}, &error)) << error.message;
    const std::size_t bracket = formula.find('(');
    if (bracket != 0 && bracket != std::string::npos) functions.push_back(formula.substr(0, bracket));
  }
  FormulaError error;
  Formula::parse("zzz(1)", {}, &error);
  EXPECT_THAT(functions, UnorderedElementsAreArray(names_listed_in(error.message, "the functions are ")));
}

TEST(ModelFormat, StatesTheLimitsOfFormulas) {
  std::string text;
  for (const std::string& line : reference()) text += line + ' ';
  EXPECT_THAT(text,
              HasSubstr(fmt::format("most {} numbers, names and operations", Formula::max_instructions)));
  EXPECT_THAT(text, HasSubstr(fmt::format("most {} variables", extra_capacity)));
}

// An example is a whole file, or a part that is valid with the two pressures.
TEST(ModelFormat, ExamplesAreRead) {
  std::size_t examples = 0;
  std::optional<std::string> example;
  for (const std::string& line : reference()) {
    if (line == "```toml") {
      example.emplace();
    } else if (line == "```" && example) {
      std::string text = *example;
      if (text.rfind("[variables]", 0) == 0) text = "format = \"pcor-model/1\"\n" + text;
      if (text.rfind("format", 0) != 0) text = minimum_model + text;
      EXPECT_EQ(message_of(text), "no error") << *example;
      ++examples;
      example.reset();
    } else if (example) {
      *example += line + '\n';
    }
  }
  EXPECT_GE(examples, 9u);
}

}  // namespace
}  // namespace pcor
