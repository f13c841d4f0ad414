#include <fmt/format.h>
#include <openssl/evp.h>
#include <pcor/base/atomic_file.hpp>
#include <pcor/base/error.hpp>
#include <pcor/base/message.hpp>
#include <pcor/report/report.hpp>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "report/report_data.hpp"

namespace pcor::internal::report {

// Style and scripts of a report, from the files in this folder; the build embeds them (embed.cmake).
extern const std::string_view style;
extern const std::string_view script;

}  // namespace pcor::internal::report

namespace pcor {

using namespace internal;

namespace {

std::string escaped(std::string_view text) {
  constexpr std::string_view special = "&<>\"'";
  constexpr std::array entities{"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
  std::string safe;
  for (const char letter : sanitize_text(text)) {
    const std::size_t found = special.find(letter);
    if (found == std::string_view::npos)
      safe += letter;
    else
      safe += entities[found];
  }
  return safe;
}

// Escaped text, with ± instead of the +- of the terminal.
std::string typeset(std::string_view text) {
  std::string shown = escaped(text);
  for (std::size_t at = shown.find("+-"); at != std::string::npos; at = shown.find("+-", at))
    shown.replace(at, 2, "±");
  return shown;
}

// Empty for an empty text. @param attributes such as R"( class="caption")"
std::string element(std::string_view tag, std::string_view text, std::string_view attributes = "") {
  return text.empty() ? "" : fmt::format("<{0}{2}>{1}</{0}>\n", tag, typeset(text), attributes);
}

// Whether a cell is a number, optionally with its error or unit: "-1.2e-3", "0.3 ± 0.1", "12 %".
bool is_numeric(const std::string& cell) {
  char* end = nullptr;
  std::strtod(cell.c_str(), &end);
  return end != cell.c_str() && (*end == '\0' || *end == ' ');
}

constexpr std::size_t max_number = 24;     // characters of a number with its error and unit
constexpr std::size_t max_on_a_line = 60;  // a cell with more characters may take several lines
constexpr std::size_t max_columns_narrow =
    2;                                     // a table with more columns shows rows as lists in narrow windows
constexpr std::size_t max_rows_open = 30;  // a table with more rows is folded

std::string folded(std::string_view words, const std::string& content) {
  return fmt::format("<details class=\"fold\"><summary>{}</summary>\n{}</details>\n", words, content);
}

std::string table(const ReportTable& table) {
  const auto kind = [](const std::string& cell) {
    return cell.size() <= max_number && is_numeric(cell) ? R"( class="number")"
           : cell.size() > max_on_a_line                 ? R"( class="words")"
                                                         : "";
  };
  std::string head, body;
  for (std::size_t i = 0; i < table.headers.size(); ++i)
    head += table.headers[i].empty() ? "<td></td>"
                                     : fmt::format(R"(<th scope="col"{}>{}</th>)",
                                                   kind(table.rows.front()[i]), escaped(table.headers[i]));
  for (const auto& row : table.rows) {
    body += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i)
      body += fmt::format(R"(<td{} data-header="{}">{}</td>)", kind(row[i]), escaped(table.headers[i]),
                          typeset(row[i]));
    body += "</tr>\n";
  }
  const std::string html =
      fmt::format(R"(<div class="scroll" tabindex="0" role="group" aria-label="{}"><table{}>
<thead><tr>{}</tr></thead>
<tbody>
{}</tbody>
</table></div>
)",
                  escaped(table.title),
                  table.headers.size() > max_columns_narrow ? R"( class="list-if-narrow")" : "", head, body);
  const bool is_folded = table.is_folded || table.rows.size() > max_rows_open;
  return is_folded ? folded(fmt::format("{} rows", table.rows.size()), html) : html;
}

// Content of an item without the browser's script: its caption, its table, its text.
struct ItemBody {
  static constexpr std::string_view of_caption = R"( class="caption")";

  template <typename Panel>
  std::string operator()(const Panel& panel) const {
    return element("p", panel.caption, of_caption);
  }
  std::string operator()(const ReportTable& item) const {
    return table(item) + element("p", item.caption, of_caption);
  }
  std::string operator()(const WhatIfPanel& panel) const {
    return element("p", panel.caption, of_caption) + details(panel.details);
  }
  std::string operator()(const ReportText& item) const {
    std::string html;
    for (const std::string& paragraph : item.paragraphs) html += element("p", paragraph);
    return html + details(item.details);
  }

 private:
  static std::string details(const std::string& text) {
    return text.empty() ? "" : folded("Details", element("p", text));
  }
};

bool takes_half(const ReportItem& item) {
  return std::holds_alternative<BinnedPanel>(item) || std::holds_alternative<PlanePanel>(item) ||
         std::holds_alternative<PairPanel>(item) || std::holds_alternative<BarPanel>(item) ||
         std::holds_alternative<CurvePanel>(item) || std::holds_alternative<QuantilePanel>(item);
}

// Pictures that are not over time are placed in pairs; a single remaining one takes the whole width.
std::string items(const Report& report) {
  std::string html;
  bool second = false;
  for (std::size_t i = 0; i < report.items.size(); ++i) {
    const ReportItem& item = report.items[i];
    if (const auto* const table = std::get_if<ReportTable>(&item); table != nullptr && table->rows.empty())
      continue;
    const bool paired =
        takes_half(item) && (second || (i + 1 < report.items.size() && takes_half(report.items[i + 1])));
    second = paired && !second;
    html += fmt::format(R"(<section class="item {0}{1}" data-item="{2}" aria-labelledby="title-{2}">
<h2 id="title-{2}">{3}</h2>
{4}</section>
)",
                        report::kind_of(item), paired ? " half" : "", i,
                        escaped(std::visit([](const auto& one) { return one.title; }, item)),
                        std::visit(ItemBody{}, item));
  }
  return html;
}

std::string info(const std::vector<std::pair<std::string, std::string>>& info) {
  if (info.empty()) return "";
  std::string html = R"(<dl class="facts">)";
  for (const auto& [name, fact] : info)
    html += fmt::format("<div>{}{}</div>\n", element("dt", name), element("dd", fact));
  return html + "</dl>\n";
}

std::string summary(const std::vector<std::string>& sentences) {
  constexpr std::size_t max_letters = 320;  // about four lines: the first picture stays on the first screen
  const bool are_short = sentences.size() > 1 && sentences[0].size() + sentences[1].size() <= max_letters;
  const std::size_t shown = are_short ? 2 : 1;
  std::string first, more;
  for (std::size_t i = 0; i < sentences.size(); ++i)
    (i < shown ? first : more) += element("li", sentences[i]);
  if (!more.empty())
    more = folded(fmt::format("{} more", sentences.size() - shown), "<ul>\n" + more + "</ul>\n");
  return "<ul>\n" + first + "</ul>\n" + more;
}

std::string head(const Report& report) {
  std::string html = "<header>\n" + element("h1", report.title) +
                     element("p", report.subtitle, R"( class="subtitle")") + "</header>\n";
  if (!report.summary.empty())
    html += R"(<section class="summary" aria-label="Summary">)" + summary(report.summary) + "</section>\n";
  if (!report.next.empty()) {
    html += R"(<section class="next" aria-label="Next step">)";
    for (const NextStep& step : report.next) {
      const std::string command =
          step.command.empty() ? "" : fmt::format(": <code>{}</code>", escaped(step.command));
      html += fmt::format("<p>{}{}</p>", typeset(step.text), command);
    }
    html += "</section>\n";
  }
  if (!report.info.empty())
    html += R"(<section aria-label="Facts">)" + folded("Model, flights and notes", info(report.info)) +
            "</section>\n";
  return html;
}

std::string foot(const Report& report) {
  return report.origin.empty() ? "" : "<footer>\n" + info(report.origin) + "</footer>\n";
}

// Hash of the script for the content security policy, which prevents other scripts: its SHA-256 in base 64.
std::string hash_of(std::string_view script) {
  std::array<unsigned char, 32> digest{};
  if (EVP_Digest(script.data(), script.size(), digest.data(), nullptr, EVP_sha256(), nullptr) != 1)
    throw Error(Error::Code::system,
                "report: libcrypto computed no SHA-256: the memory is exhausted, or OpenSSL is incomplete");
  return "sha256-" + report::base64(digest.data(), digest.size());
}

}  // namespace

std::string report_html(const Report& report) {
  std::string html = fmt::format(R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; script-src '{}'; img-src data:">
<link rel="icon" href="data:,">
)",
                                 hash_of(report::script));
  html += element("title", report.title);
  html += "<style>\n";
  html += report::style;
  html += "</style>\n</head>\n<body>\n";
  html += head(report);
  html += "<noscript><p>The pictures need JavaScript, which is switched off here.</p></noscript>\n";
  html += "<main>\n" + items(report) + "</main>\n" + foot(report);
  html += R"(<script type="application/json" id="data">)";
  html += report::data_json(report);
  html += "</script>\n<script>";
  html += report::script;
  html += "</script>\n</body>\n</html>\n";
  return html;
}

void write_report(const Report& report, const std::filesystem::path& path) {
  AtomicFile(path).write(report_html(report));
}

}  // namespace pcor
