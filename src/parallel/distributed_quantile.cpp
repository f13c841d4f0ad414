#include "parallel/distributed_quantile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>

#include "numerics/missing.hpp"
#include "parallel/packed.hpp"

namespace pcor::internal {
namespace {

using Counts = std::array<std::uint64_t, 256>;

constexpr std::uint64_t sign = std::uint64_t{1} << 63U;
constexpr unsigned bits_at_a_time = 8;

/// A number that is in the order of the values.
std::uint64_t number_of(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return (bits & sign) != 0 ? ~bits : bits | sign;
}

double value_of(std::uint64_t number) {
  const std::uint64_t bits = (number & sign) != 0 ? number & ~sign : ~number;
  double value = 0.0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// State of the search for one order statistic.
struct OrderStatistic {
  std::uint64_t found = 0;            // bits of the number
  std::uint64_t below = 0;            // number of remaining values that must be smaller
  std::vector<std::uint64_t> left{};  // values of this rank
};

std::vector<Counts> counts_of_all(Communicator& comm, const std::vector<Counts>& own) {
  std::vector<Counts> all(own.size(), Counts{});
  for (const std::string& bytes : comm.gather(packed(own))) {
    const auto more = unpacked<std::vector<Counts>>(bytes);
    for (std::size_t k = 0; k < all.size(); ++k) {
      for (std::size_t i = 0; i < all[k].size(); ++i) all[k][i] += more[k][i];
    }
  }
  return all;
}

}  // namespace

std::vector<double> values_at(Communicator& comm, std::vector<double> values, const WantedPlaces& requested) {
  for (double& value : values) value += 0.0;  // there is one zero
  if (comm.size() == 1) {
    std::vector<double> found;
    auto begin = values.begin();
    for (const std::uint64_t order : requested(values.size())) {
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(order);
      std::nth_element(begin, at, values.end());
      found.push_back(*at);
      begin = at;
    }
    return found;
  }
  std::vector<OrderStatistic> statistics(1);
  for (const double value : values) statistics[0].left.push_back(number_of(value));
  for (unsigned shift = 64; shift > 0;) {
    shift -= bits_at_a_time;
    const auto digit = [shift](std::uint64_t number) { return (number >> shift) & 0xffU; };
    std::vector<Counts> own(statistics.size(), Counts{});
    for (std::size_t k = 0; k < statistics.size(); ++k) {
      for (const std::uint64_t number : statistics[k].left) ++own[k][digit(number)];
    }
    std::vector<Counts> all = counts_of_all(comm, own);
    if (shift + bits_at_a_time == 64) {
      const std::vector<std::uint64_t> below =
          requested(std::accumulate(all[0].begin(), all[0].end(), std::uint64_t{0}));
      statistics.resize(below.size(), statistics[0]);
      all.resize(below.size(), all[0]);
      for (std::size_t k = 0; k < statistics.size(); ++k) statistics[k].below = below[k];
    }
    for (std::size_t k = 0; k < statistics.size(); ++k) {
      OrderStatistic& statistic = statistics[k];
      std::uint64_t chosen = 0;
      while (statistic.below >= all[k][chosen]) statistic.below -= all[k][chosen++];
      statistic.found |= chosen << shift;
      statistic.left.erase(std::remove_if(statistic.left.begin(), statistic.left.end(),
                                          [&](std::uint64_t number) { return digit(number) != chosen; }),
                           statistic.left.end());
    }
  }
  std::vector<double> found;
  for (const OrderStatistic& statistic : statistics) found.push_back(value_of(statistic.found));
  return found;
}

double median_of_absolute_values(Communicator& comm, std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double value) { return std::isnan(value); }),
               values.end());
  for (double& value : values) value = std::abs(value);
  const std::vector<double> middle = values_at(comm, std::move(values), [](std::uint64_t count) {
    return count > 0 ? std::vector<std::uint64_t>{count / 2} : std::vector<std::uint64_t>();
  });
  return middle.empty() ? nan : middle.front();
}

}  // namespace pcor::internal
