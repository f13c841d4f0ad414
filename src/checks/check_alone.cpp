#include <pcor/checks/check.hpp>

#include "team/flight_share.hpp"

namespace pcor {

using namespace internal;

template <class Archive>
void serialize(Archive& archive, KeyNumber& number) {
  archive(number.value, number.standard_error, number.matters, number.unit, number.what, number.verdict);
}

template <class Archive>
void serialize(Archive& archive, CheckInShort& check) {
  archive(check.name, check.ran, check.reason, check.verdict, check.key);
}

std::vector<CheckInShort> in_short(const Checks& checks) {
  std::vector<CheckInShort> all;
  for (const CheckResult& result : checks.results)
    all.push_back({result.name, result.ran, result.reason, result.verdict, result.key});
  return all;
}

std::vector<std::vector<CheckInShort>> check_each_alone(const FlightSet& flights,
                                                        const std::optional<ModelFile>& model,
                                                        const CheckOptions& options) {
  CheckOptions own = options;
  own.progress = nullptr;
  return flights.share().of_each_flight<std::vector<CheckInShort>>(
      [&](std::size_t number) { return in_short(check(flights.only(number), model, own)); });
}

}  // namespace pcor
