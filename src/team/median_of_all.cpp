#include "team/median_of_all.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "numerics/median.hpp"
#include "team/packed.hpp"

namespace pcor::internal {
namespace {

using Counts = std::array<std::uint64_t, 256>;

/// Numbers that are in the order of the values, which are not negative.
std::vector<std::uint64_t> bits_of(const std::vector<double>& values) {
  std::vector<std::uint64_t> bits(values.size());
  if (!values.empty()) std::memcpy(bits.data(), values.data(), values.size() * sizeof(double));
  return bits;
}

Counts counts_of_all(Team& team, const Counts& own) {
  Counts all{};
  for (const std::string& bytes : team.gather(packed(own))) {
    const auto more = unpacked<Counts>(bytes);
    for (std::size_t i = 0; i < all.size(); ++i) all[i] += more[i];
  }
  return all;
}

}  // namespace

double median_of_absolute_values(Team& team, std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double value) { return std::isnan(value); }),
               values.end());
  for (double& value : values) value = std::abs(value);
  if (team.size() == 1) return median(std::move(values));
  std::vector<std::uint64_t> left = bits_of(values);
  std::uint64_t found = 0;
  std::uint64_t below = 0;  // of those that are left, that are to be less than the one that is looked for
  for (unsigned shift = 64; shift > 0;) {
    const bool is_first = shift == 64;
    shift -= 8;
    const auto digit = [shift](std::uint64_t bits) { return (bits >> shift) & 0xffU; };
    Counts own{};
    for (const std::uint64_t bits : left) ++own[digit(bits)];
    const Counts all = counts_of_all(team, own);
    if (is_first) {
      std::uint64_t count = 0;
      for (const std::uint64_t each : all) count += each;
      if (count == 0) return nan;
      below = count / 2;
    }
    std::uint64_t chosen = 0;
    while (below >= all[chosen]) below -= all[chosen++];
    found |= chosen << shift;
    left.erase(std::remove_if(left.begin(), left.end(),
                              [&](std::uint64_t bits) { return digit(bits) != chosen; }),
               left.end());
  }
  double result = 0.0;
  std::memcpy(&result, &found, sizeof result);
  return result;
}

}  // namespace pcor::internal
