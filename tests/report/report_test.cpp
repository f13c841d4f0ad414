#include <pcor/report/report.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include "support/error_of.hpp"
#include "support/temporary_directory.hpp"

namespace pcor {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double start = 1054468800.0;

Report report_of(std::size_t samples, std::size_t columns) {
  Report report;
  report.title = "A report";
  for (std::size_t i = 0; i < samples; ++i) report.time.push_back(start + static_cast<double>(i));
  for (std::size_t c = 0; c < columns; ++c) {
    ReportColumn column{"c" + std::to_string(c), "Column " + std::to_string(c), "hPa", {}};
    for (std::size_t i = 0; i < samples; ++i)
      column.values.push_back(1000.0 * std::sin(static_cast<double>(i * (c + 1)) * 0.37));
    report.columns.push_back(column);
  }
  report.items.push_back(TimePanel{"Lines", "Over time.", {"c0"}});
  return report;
}

// Data that the page's script reads.
nlohmann::json data_of(const std::string& html) {
  const std::string opening = "id=\"data\">";
  const std::size_t begin = html.find(opening) + opening.size();
  return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

std::vector<std::uint8_t> from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char letter : text) {
    if (letter == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(letter));
    count += 6;
    if (count >= 8) bytes.push_back(static_cast<std::uint8_t>(bits >> (count -= 8)));
  }
  return bytes;
}

// Whole numbers by the differences of neighbours, with runs of equal numbers.
std::vector<std::int64_t> unpacked(const std::string& text) {
  const std::vector<std::uint8_t> bytes = from_base64(text);
  std::size_t at = 0;
  const auto next = [&] {
    std::int64_t number = 0;
    for (int shift = 0;; shift += 7) {
      number |= std::int64_t{bytes[at] & 127} << shift;
      if (bytes[at++] < 128) return number;
    }
  };
  std::vector<std::int64_t> numbers;
  std::int64_t value = 0;
  while (at < bytes.size()) {
    const std::int64_t told = next();
    value += told % 2 == 0 ? told / 2 : -(told + 1) / 2;
    numbers.push_back(value);
    if (told == 0) numbers.insert(numbers.end(), static_cast<std::size_t>(next()), value);
  }
  return numbers;
}

std::vector<double> values_of(const nlohmann::json& column) {
  std::vector<double> values;
  for (const std::int64_t number : unpacked(column["values"]))
    values.push_back(number == 65535 ? nan
                                     : column["least"].get<double>() +
                                           static_cast<double>(number) * column["step"].get<double>());
  return values;
}

std::optional<Error> refusal(const Report& report) {
  return test::error_of([&] { report_html(report); });
}

TEST(Report, IsSmall) { EXPECT_LT(report_html(report_of(18000, 12)).size(), 1'500'000U); }

TEST(Report, NeedsNoNetwork) {
  std::string html = report_html(report_of(100, 2));
  const std::string svg = "http://www.w3.org/2000/svg";
  html.erase(html.find(svg), svg.size());
  for (const char* fetch : {"http:", "https:", "src=", "@import", "fetch(", "XMLHttpRequest", "url(//"})
    EXPECT_THAT(html, Not(HasSubstr(fetch)));
}

TEST(Report, ValuesAreAccurateToHalfAStep) {
  Report report = report_of(1000, 1);
  report.columns[0].values[17] = nan;
  report.columns[0].values[18] = std::numeric_limits<double>::infinity();
  const auto column = data_of(report_html(report))["columns"][0];
  const std::vector<double> kept = values_of(column);
  ASSERT_EQ(kept.size(), 1000U);
  EXPECT_NEAR(column["step"].get<double>(), 2000.0 / 65534, 1e-4);
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (i == 17 || i == 18)
      EXPECT_TRUE(std::isnan(kept[i]));
    else
      EXPECT_LE(std::abs(kept[i] - report.columns[0].values[i]), 0.5000001 * column["step"].get<double>());
}

TEST(Report, KeepsAxisValuesToTwelveBits) {
  Report report = report_of(1000, 2);
  report.items = {BinnedPanel{"Bins", "", {"c0"}, {"c1"}}};
  const auto columns = data_of(report_html(report))["columns"];
  EXPECT_NEAR(columns[0]["step"].get<double>(), 2000.0 / 65534, 1e-4);
  EXPECT_NEAR(columns[1]["step"].get<double>(), 2000.0 / 4094, 1e-3);
  report.items.emplace_back(TimePanel{"Lines", "", {"c1"}});
  EXPECT_NEAR(data_of(report_html(report))["columns"][1]["step"].get<double>(), 2000.0 / 65534, 1e-4);
}

TEST(Report, KeepsAConstantColumnExactly) {
  Report report = report_of(3, 1);
  report.columns[0].values.assign(3, 0.1);
  EXPECT_EQ(values_of(data_of(report_html(report))["columns"][0]), std::vector<double>(3, 0.1));
}

TEST(Report, KeepsTheTimeOfEachFlightToAMillisecond) {
  Report report = report_of(4, 1);
  report.time = {start, start + 0.04, start + 9e6, start + 9e6 + 1.5};
  report.flight_starts = {0, 2};
  report.flight_names = {"rf01", "rf02"};
  const auto flights = data_of(report_html(report))["flights"];
  ASSERT_EQ(flights.size(), 2U);
  EXPECT_EQ(flights[1]["start"], start + 9e6);
  EXPECT_EQ(unpacked(flights[0]["milliseconds"]), (std::vector<std::int64_t>{0, 40}));
  EXPECT_EQ(unpacked(flights[1]["milliseconds"]), (std::vector<std::int64_t>{0, 1500}));
}

TEST(Report, EscapesEveryText) {
  const std::string bad = "</script><script>\"'&é\xff";
  Report report = report_of(3, 2);
  report.columns[0].name = report.columns[0].title = report.columns[0].unit = bad;
  report.title = report.subtitle = bad;
  report.summary = {bad};
  report.info = {{bad, bad}};
  report.intervals = {{bad, start, start + 1}};
  report.flight_names = {bad};
  report.items = {TimePanel{bad, bad, {bad}, bad},
                  BinnedPanel{bad, bad, {bad}, {"c1"}},
                  PlanePanel{bad, bad, bad, "c1", bad},
                  PairPanel{bad, bad, bad, "c1", {{1, 0, bad}}},
                  RegimeTable{bad, bad, {bad}},
                  BarPanel{bad, bad, {{bad, 1}}, bad, bad},
                  CurvePanel{bad, bad, {{bad, {1, 2}, {1, 2}}}, bad, bad, bad, bad},
                  ReportTable{bad, bad, {bad}, {{bad}}},
                  ReportText{bad, {bad}}};
  const std::string html = report_html(report);
  EXPECT_THAT(html, Not(HasSubstr("</script><script>\"")));
  EXPECT_THAT(html, HasSubstr("<h1>&lt;/script&gt;&lt;script&gt;&quot;&#39;&amp;é"));
  EXPECT_EQ(data_of(html)["columns"][0]["name"], "</script><script>\"'&é\\xff");
}

TEST(Report, LongTableIsFolded) {
  Report report = report_of(3, 1);
  for (const std::size_t rows : {30U, 31U}) {
    report.items = {ReportTable{"Rows", "", {"a"}, {rows, {"1"}}}};
    EXPECT_EQ(report_html(report).find("<details class=\"fold\">") != std::string::npos, rows > 30);
  }
}

TEST(Report, UncertaintiesUseThePlusMinusSign) {
  Report report = report_of(3, 1);
  report.summary = {"1.0 +- 0.1 hPa"};
  report.next = {{"To apply it", "pcor add --formula 'k +-1'"}};
  const std::string html = report_html(report);
  EXPECT_THAT(html, HasSubstr("<li>1.0 ± 0.1 hPa</li>"));
  EXPECT_THAT(html, HasSubstr("<code>pcor add --formula &#39;k +-1&#39;</code>"));
}

// A program that is called by another name is a command, too.
TEST(Report, NextStepsAreSentencesWithOrWithoutACommand) {
  Report report = report_of(3, 1);
  report.next = {{"First edit a.toml. Then refit", "/opt/correct refit 'a: b.nc'"},
                 {"It needs 0.0 +- 0.2 hPa: up to 0.5 hPa. To test it, give another flight"}};
  const std::string html = report_html(report);
  for (const char* const step :
       {"<p>First edit a.toml. Then refit: <code>/opt/correct refit &#39;a: b.nc&#39;</code></p>",
        "<p>It needs 0.0 ± 0.2 hPa: up to 0.5 hPa. To test it, give another flight</p>"})
    EXPECT_THAT(html, HasSubstr(step));
}

TEST(Report, RefusesAnUnknownColumn) {
  Report report = report_of(3, 1);
  report.items = {TimePanel{"Lines", "", {"c0", "absent"}}};
  EXPECT_THAT(refusal(report), test::IsError(Error::Code::usage, "'absent'"));
  report.items = {TimePanel{"Lines", "", {"c0"}, "", "absent"}};
  EXPECT_THAT(refusal(report), test::IsError(Error::Code::usage, "'absent'"));
  report.items = {BinnedPanel{"Bins", "", {"c0"}, {"c0", "absent"}}};
  EXPECT_THAT(refusal(report), test::IsError(Error::Code::usage, "'absent'"));
}

TEST(Report, ColumnOfWrongLengthIsRefused) {
  Report report = report_of(3, 1);
  report.columns[0].values.pop_back();
  EXPECT_THAT(refusal(report), test::IsError(Error::Code::usage, "'c0'", "2", "3"));
}

TEST(Report, RefusesDuplicateColumns) {
  Report report = report_of(3, 2);
  report.columns[1].name = "c0";
  EXPECT_THAT(refusal(report), test::IsError(Error::Code::usage, "'c0'"));
}

// One effect on a model of one coefficient, with sums of the right size.
WhatIfPanel what_if_of(std::size_t samples) {
  WhatIfPanel panel;
  panel.title = "What if";
  panel.residual = "c0";
  panel.coefficients = {{"static-constant.a0", "1"}, {"tau", "s"}};
  for (WhatIfCoefficient& coefficient : panel.coefficients) {
    for (std::size_t i = 0; i < samples; ++i) coefficient.column.push_back(0.5 * static_cast<double>(i));
  }
  panel.model_coefficient_count = 1;
  panel.effects = {{"static-lag", "a lag", "found", 0, 1, 1}};
  const WhatIfSums sums{{2.0, 1.0, 3.0, 0.5, 0.25, 4.0}, 10.0};
  panel.weights = {{{}, {sums}, {2.0, 1.0, 3.0}}};
  panel.unweighted = {sums};
  panel.outliers = sums;
  return panel;
}

TEST(Report, WhatIfSumsAreStoredExactly) {
  Report report = report_of(100, 1);
  report.items = {what_if_of(100)};
  const auto item = data_of(report_html(report))["items"][0];
  const std::vector<std::uint8_t> bytes = from_base64(item["weights"][0]["parts"][0]["products"]);
  std::vector<double> products(6);
  ASSERT_EQ(bytes.size(), products.size() * sizeof(double));
  std::memcpy(products.data(), bytes.data(), bytes.size());
  EXPECT_EQ(products, (std::vector<double>{2.0, 1.0, 3.0, 0.5, 0.25, 4.0}));
  EXPECT_EQ(item["isStartFitted"], false);
  EXPECT_EQ(item["noiseLabel"], "noise");
}

TEST(Report, WhatIfHasAllSamplesWithValues) {
  constexpr std::size_t samples = 16003;  // three of them lack a column
  Report report = report_of(samples, 1);
  WhatIfPanel panel = what_if_of(samples);
  panel.coefficients[0].column[0] = panel.coefficients[1].column[500] = panel.coefficients[1].column[501] =
      nan;
  report.items = {panel};
  const auto item = data_of(report_html(report))["items"][0];
  const std::vector<std::int64_t> points = unpacked(item["points"]);
  ASSERT_EQ(points.size(), 16000U);
  EXPECT_EQ(points.front(), 1);
  EXPECT_EQ(points[499], 502);
  EXPECT_EQ(points.back(), 16002);
  const std::vector<double> column = values_of(item["columns"][1]);
  ASSERT_EQ(column.size(), points.size());
  // 16 bits for 8,000: half of a step of 0.12.
  EXPECT_NEAR(column[499], 251.0, 0.062);
}

TEST(Report, WhatIfHasRegularSamplesOfEachFlightIfThereAreMore) {
  Report report = report_of(64001 + 5 + 63000, 1);
  report.flight_starts = {0, 64001, 64006};
  report.flight_names = {"rf01", "rf02", "rf03"};
  report.items = {what_if_of(report.time.size())};
  const auto item = data_of(report_html(report))["items"][0];
  std::vector<std::int64_t> expected;
  for (std::int64_t i = 0; i < 64001; i += 2) expected.push_back(i);
  for (std::int64_t i = 64001; i < 64006; i += 2) expected.push_back(i);
  for (std::int64_t i = 64006; i < 127006; i += 2) expected.push_back(i);
  expected.push_back(127005);  // the last one
  EXPECT_EQ(unpacked(item["points"]), expected);
}

TEST(Report, RefusesTimeThatDoesNotIncrease) {
  Report report = report_of(4, 1);
  report.time[2] = report.time[1] - 1.0;
  EXPECT_THAT(refusal(report), test::IsError(Error::Code::usage, "flight 1"));
  report.time[2] = nan;
  EXPECT_THAT(refusal(report), test::IsError(Error::Code::usage, "flight 1"));
  report.time[2] = report.time[1] - 1.0;
  report.flight_starts = {0, 2};
  EXPECT_EQ(refusal(report), std::nullopt);
}

TEST(Report, FlightWithoutSamplesIsOmitted) {
  Report report = report_of(4, 1);
  report.flight_starts = {0, 0, 4};
  report.flight_names = {"rf01", "rf02", "rf03"};
  const auto flights = data_of(report_html(report))["flights"];
  ASSERT_EQ(flights.size(), 1U);
  EXPECT_EQ(flights[0]["name"], "rf02");
}

TEST(Report, TableWithoutRowsIsOmitted) {
  Report report = report_of(3, 1);
  report.items.emplace_back(ReportTable{"The worst minutes", "", {"flight"}});
  EXPECT_THAT(report_html(report), Not(HasSubstr("The worst minutes")));
}

TEST(Report, ReportWithoutSamplesIsWritten) {
  Report report;
  report.title = "Bars only";
  report.items = {BarPanel{"Bars", "", {{"a", 1.0, 0.1}}, "rms", "hPa"}};
  EXPECT_THAT(report_html(report), HasSubstr("<h1>Bars only</h1>"));
}

TEST(Report, FileIsWrittenAtomically) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "report.html";
  Report report = report_of(3, 1);
  write_report(report, path);
  std::ifstream stream(path);
  const std::string before{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_EQ(before, report_html(report));
  report.items = {TimePanel{"Lines", "", {"absent"}}};
  EXPECT_THROW(write_report(report, path), Error);
  std::ifstream again(path);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(again), {}), before);
  EXPECT_EQ(directory.entries(), 1U);
  EXPECT_THROW(write_report(report_of(3, 1), directory / "absent" / "report.html"), Error);
}

}  // namespace
}  // namespace pcor
