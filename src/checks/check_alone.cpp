#include <pcor/checks/check.hpp>

#include "parallel/flight_partition.hpp"

namespace pcor {

using namespace internal;

template <class Archive>
void serialize(Archive& archive, TestStatistic& number) {
  archive(number.value, number.standard_error, number.matters, number.unit, number.what, number.verdict);
}

template <class Archive>
void serialize(Archive& archive, CheckSummary& check) {
  archive(check.name, check.ran, check.reason, check.verdict, check.key);
}

std::vector<CheckSummary> in_short(const Checks& checks) {
  std::vector<CheckSummary> all;
  for (const CheckResult& result : checks.results)
    all.push_back({result.name, result.ran, result.reason, result.verdict, result.key});
  return all;
}

std::vector<std::vector<CheckSummary>> check_per_flight(const FlightSet& flights,
                                                        const std::optional<ModelDefinition>& model,
                                                        const CheckOptions& options) {
  CheckOptions own = options;
  own.progress = nullptr;
  return flights.share().of_each_flight<std::vector<CheckSummary>>(
      [&](std::size_t number) { return in_short(check(flights.only(number), model, own)); });
}

}  // namespace pcor
