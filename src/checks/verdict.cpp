#include "checks/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcor::internal {

namespace {

constexpr double significant = 3.0;  // standard errors
constexpr double likely = 2.0;

/// Relative size of a number, in tolerances; for an inconsistent number the error is not subtracted.
double reach_of(const TestStatistic& key) {
  const double doubt = key.verdict == CheckVerdict::inconsistent ? 0.0 : likely * key.standard_error;
  return (std::abs(key.value) + doubt) / key.tolerance;
}

/// Reason for the verdict on a number.
std::string reason_of(const TestStatistic& key) {
  const double magnitude = std::abs(key.value);
  const auto within = [&](const char* words) {
    return fmt::format("{:.3f} {} with two standard errors, {} the tolerance of {:g} {}",
                       magnitude + likely * key.standard_error, key.unit, words, key.tolerance, key.unit);
  };
  const auto above = [&](const char* words) {
    return fmt::format("above the tolerance of {0:g} {1}{2} above three standard errors, {3:.3f} {1}",
                       key.tolerance, key.unit, words, significant * key.standard_error);
  };
  const std::string why = key.verdict == CheckVerdict::inconsistent ? above(" and")
                          : key.verdict == CheckVerdict::consistent ? within("within")
                          : magnitude > key.tolerance               ? above(", but not")
                                                                    : within("not within");
  return fmt::format("{:+.3f} +- {:.3f} {}, {}: {}", key.value, key.standard_error, key.unit, key.what, why);
}

}  // namespace

CheckVerdict classify(const Estimate& number, double size) {
  const double magnitude = std::abs(number.value);
  if (magnitude > size && magnitude > significant * number.error) return CheckVerdict::inconsistent;
  if (magnitude + likely * number.error <= size) return CheckVerdict::consistent;
  return CheckVerdict::inconclusive;
}

TestStatistic test_statistic(const Estimate& number, double size, std::string unit, std::string what) {
  return {number.value, number.error, size, std::move(unit), std::move(what), classify(number, size)};
}

void set_verdict(std::vector<TestStatistic> numbers, CheckResult& result) {
  result.was_run = true;
  const auto has = [&](CheckVerdict verdict) {
    return std::any_of(numbers.begin(), numbers.end(),
                       [verdict](const TestStatistic& number) { return number.verdict == verdict; });
  };
  result.verdict = has(CheckVerdict::inconsistent)   ? CheckVerdict::inconsistent
                   : has(CheckVerdict::inconclusive) ? CheckVerdict::inconclusive
                                                     : CheckVerdict::consistent;
  const TestStatistic* decisive = nullptr;
  for (const TestStatistic& number : numbers) {
    if (number.verdict != result.verdict) continue;
    if (decisive == nullptr || reach_of(number) > reach_of(*decisive)) decisive = &number;
  }
  result.key = *decisive;
  result.explanation = reason_of(result.key);
  result.statistics = std::move(numbers);
}

void mark_inconclusive(const std::string& reason, CheckResult& result) {
  result.verdict = CheckVerdict::inconclusive;
  result.explanation += ", but " + reason;
  result.inconclusive_reason = reason;
}

void add_number(const std::string& name, const std::string& unit, const Estimate& number,
                CheckResult& result) {
  result.numbers.emplace_back(name + unit, number.value);
  result.numbers.emplace_back(name + "_stderr" + unit, number.error);
}

std::string format_number(const Estimate& number, const std::string& unit, int decimals) {
  return fmt::format("{:+.{}f} +- {:.{}f}{}{}", number.value, decimals, number.error, decimals,
                     unit.empty() ? "" : " ", unit);
}

}  // namespace pcor::internal
