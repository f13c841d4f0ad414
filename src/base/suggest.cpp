#include <pcor/base/suggest.hpp>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <tuple>

#include "base/phrasing.hpp"

namespace pcor {
namespace {

constexpr std::size_t max_name = 256;  // limit of netCDF
constexpr std::size_t min_part = 4;    // minimum length of a part that suggests a name

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& letter : result) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return result;
}

std::size_t shared_prefix(const std::string& a, const std::string& b) {
  return static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first - a.begin());
}

// Optimal string alignment: insertions, deletions, substitutions and swaps of neighbours.
std::size_t changes_between(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, substituted});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

std::vector<std::string> suggest(std::string_view wrong, const std::vector<std::string>& known) {
  const std::string requested = lower(wrong);
  if (requested.empty() || requested.size() > max_name) return {};
  // Number of changes, minus the length of the common prefix, name.
  std::vector<std::tuple<std::size_t, std::ptrdiff_t, std::string>> candidates;
  for (const std::string& name : known) {
    const std::string candidate = lower(name);
    if (candidate.empty()) continue;
    const std::size_t changes = changes_between(requested, candidate);
    const std::size_t prefix = shared_prefix(requested, candidate);
    const bool one_begins_the_other = prefix >= 2 && prefix == std::min(requested.size(), candidate.size());
    const bool is_part = requested.size() >= min_part && candidate.find(requested) != std::string::npos;
    if (2 * changes <= std::max(requested.size(), candidate.size()) || one_begins_the_other || is_part)
      candidates.emplace_back(changes, -static_cast<std::ptrdiff_t>(prefix), name);
  }
  std::sort(candidates.begin(), candidates.end());
  candidates.resize(std::min<std::size_t>(candidates.size(), 3));
  std::vector<std::string> result;
  for (const auto& candidate : candidates) result.push_back(std::get<std::string>(candidate));
  return result;
}

std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& known) {
  const std::vector<std::string> names = suggest(wrong, known);
  return names.empty() ? "" : "did you mean " + internal::join_list(names, "or") + "?";
}

}  // namespace pcor
