#include <pcor/fit/refit.hpp>

#include <pcor/base/error.hpp>
#include "parallel/flight_partition.hpp"
#include "parallel/workers.hpp"

namespace pcor {

using namespace internal;

template <class Archive>
void serialize(Archive& archive, FittedParameter& parameter) {
  archive(parameter.name, parameter.unit, parameter.start, parameter.value, parameter.standard_error,
          parameter.noise_error, parameter.jackknife_error, parameter.fitted, parameter.at_bound,
          parameter.stage);
}

std::vector<std::vector<FittedParameter>> refit_per_flight(const FlightSet& flights,
                                                           const ModelDefinition& model,
                                                           const References& references,
                                                           const RefitOptions& options) {
  const FlightPartition& share = flights.share();
  RefitOptions own = options;
  own.threads = Workers(flights.comm(), options.threads).threads;
  own.holdout = FlightSet();
  own.progress = nullptr;
  std::size_t done = 0;
  return share.of_each_flight<std::vector<FittedParameter>>([&](std::size_t number) {
    std::vector<FittedParameter> found;
    try {
      found = refit(flights.only(number), model, references, own).parameters;
    } catch (const Error& error) {
      if (error.code() == Error::Code::file) throw;
    }
    if (options.progress) options.progress(++done, share.local_count());
    return found;
  });
}

}  // namespace pcor
