#include "parallel/distributed_median.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/missing.hpp"
#include "parallel/distributed_quantile.hpp"

namespace pcor::internal {

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
