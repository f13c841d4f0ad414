#include <pcor/base/note.hpp>
#include <pcor/report/json.hpp>

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <nlohmann/json.hpp>

namespace pcor {

enum class Colour { red, green };
std::string to_string(Colour colour) { return colour == Colour::red ? "red" : "green"; }

struct Part {
  double bias = 0.1;
  std::optional<double> slope{};
};

template <class Field>
void describe(const Part& self, Field& field) {
  field("bias_hpa", self.bias, "mean residual");
  field("slope", self.slope, "slope, absent if unknown", "hPa/K");
}

struct Whole {
  std::string name = "a \"b\"\xff\n";
  std::size_t samples = 3;
  bool used = true;
  Colour colour = Colour::green;
  std::vector<Part> parts{};
  std::vector<std::vector<double>> matrix{{1.0, 1e-7}, {}};
  Named<double> errors{};
  std::map<std::string, Part> by_flight{};
  const Part* worst = nullptr;
  double noise = 1e-7;
  double begin = 1321560600.0;
  std::string reason{};
};

template <class Field>
void describe(const Whole& self, Field& field) {
  field("name", self.name, "name");
  field("samples", self.samples, "number of samples");
  field("used", self.used, "whether the flight is used");
  field("colour", self.colour, "colour");
  field("parts", self.parts, "parts");
  field("matrix_k", self.matrix, "matrix");
  field("errors", self.errors, "errors", "see the name");
  field("by_flight", self.by_flight, "part of each flight");
  field("worst", self.worst, "worst part");
  field.time("begin", self.begin, "first sample");
  field.object("noise", "noise", [&self](Field& noise) { noise("rms_m", self.noise, "rms"); });
  field.list("colours", std::vector<Colour>(2), "colours",
             [](Colour each, Field& of_one) { of_one("colour", each, "c"); });
  if (field.has(!self.reason.empty())) field("reason", self.reason, "reason");
}

namespace {

TEST(JsonWriter, TextEqualsThatOfALibrary) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Whole whole;
  whole.parts = {{0.5, 2.0}, {nan, {}}};
  whole.errors = {{"a0", 3.0}, {"a\xff", std::numeric_limits<double>::infinity()}};
  whole.by_flight["first"] = {};
  const auto colour = [](const char* name) { return nlohmann::ordered_json{{"colour", name}}; };
  nlohmann::ordered_json expected{{"name", whole.name}, {"samples", 3}, {"used", true}, {"colour", "green"}};
  expected["parts"] = {{{"bias_hpa", 0.5}, {"slope", 2.0}}, {{"bias_hpa", nan}}};
  expected["matrix_k"] = whole.matrix;
  expected["errors"] = {{"a0", 3.0}, {"a\xff", std::numeric_limits<double>::infinity()}};
  expected["by_flight"] = {{"first", {{"bias_hpa", 0.1}}}};
  expected["worst"] = nullptr;
  expected["begin"] = "2011-11-17T20:10:00Z";
  expected["noise"] = {{"rms_m", 1e-7}};
  expected["colours"] = {colour("red"), colour("red")};
  EXPECT_EQ(to_json(whole), expected.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

TEST(JsonKeys, ListsConditionalKeysAndEntriesOfEmptyLists) {
  std::map<std::string, JsonKey> keys;
  for (const JsonKey& key : json_keys<Whole>()) EXPECT_TRUE(keys.emplace(key.path, key).second) << key.path;
  EXPECT_EQ(keys.size(), 21U);
  EXPECT_EQ(keys.at("parts[].bias_hpa").unit, "hPa");
  EXPECT_EQ(keys.at("parts[].slope").unit, "hPa/K");
  EXPECT_EQ(keys.at("matrix_k[][]").unit, "K");
  EXPECT_EQ(keys.at("samples").unit, "1");
  EXPECT_EQ(keys.at("begin").unit, "UTC");
  EXPECT_EQ(keys.at("noise.rms_m").unit, "m");
  EXPECT_EQ(keys.at("errors.NAME").meaning, "errors");
  EXPECT_EQ(keys.at("by_flight.NAME").type, "object");
  EXPECT_EQ(keys.at("worst.bias_hpa").type, "number");
  EXPECT_EQ(keys.at("used").type, "true or false");
  EXPECT_EQ(keys.at("colours[].colour").type, "text");
  EXPECT_EQ(keys.at("reason").type, "text");
}

TEST(Json, NoteHasASeverity) {
  EXPECT_EQ(to_json(Notes{warning_note("PSFD is frozen")}),
            "[\n  {\n    \"severity\": \"warning\",\n    \"text\": \"PSFD is frozen\"\n  }\n]\n");
}

}  // namespace
}  // namespace pcor
