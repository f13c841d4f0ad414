#include <gtest/gtest.h>
#include <pcor/fit/refit.hpp>

#include <memory>
#include <vector>

#include "fit/fit_flights.hpp"
#include "support/synthetic_samples.hpp"

// The noise of more flights than those from which its memory is found.

using namespace pcor;
using namespace pcor::internal;

namespace {

constexpr std::size_t flight_count = 34;  // the memory is found from each third
constexpr std::size_t loud_flight = 16;   // equal to no shared level

/// The robust deviation of the innovations of each flight.
std::vector<double> deviations(std::size_t memory) {
  RefitOptions options;
  const ModelDefinition model = made::model({"static-constant", "static-alpha", "static-qp"});
  const References references = made::pressure_reference();
  std::vector<std::shared_ptr<const FlightSamples>> samples;
  for (std::size_t f = 0; f < flight_count; ++f) {
    made::Plan plan;
    plan.seed = static_cast<unsigned>(f);
    plan.noise = f == loud_flight ? 3.0 : 0.3;
    plan.defect = made::equation_18;
    samples.push_back(made::shared(plan));
  }
  const FlightSet set(samples, {{}, &serial_communicator(), memory});
  FitTask task = fit_task(model, references, options, set);
  task.start = Eigen::Vector3d(0.004127875, 0.021279816, 0.030849643);
  FitFlights flights(task, FitSetup{task.start, {0, 1, 2}});
  flights.measure_noise(task.start);
  return set.partition().all_gather_flights<double>([&](std::size_t f) {
    const Eigen::VectorXd innovations =
        whitened(flights.residual(f, task.start), flights.bins(f), flights.noise(f), 0);
    return robust_standard_deviation({innovations.begin(), innovations.end()});
  });
}

TEST(SharedNoise, EachFlightHasItsOwnNoiseLevel) {
  const std::vector<double> kept = deviations(std::size_t{512} << 20U);
  for (std::size_t f = 0; f < flight_count; ++f) {
    // A level of ten times the common one is moved towards it by 15 % of its logarithm, 10^0.15 = 1.41; 900
    // innovations determine a robust deviation to 4 %, and the slow part may come from the other flights
    // alone.
    EXPECT_NEAR(kept[f], f == loud_flight ? 1.41 : 1.0, 0.2) << f;
  }
  // Flights that are rebuilt in every pass keep their levels.
  EXPECT_EQ(deviations(0), kept);
}

TEST(SharedNoise, HasALevelForEachBinAfterOtherOutliersAreExcluded) {
  const RefitOptions options;
  const ModelDefinition model = made::model({"static-constant", "static-alpha", "static-qp"});
  const References references = made::pressure_reference();
  made::Plan plan;
  plan.defect = made::equation_18;
  const FlightSet set({made::shared(plan)}, {{}, &serial_communicator()});
  FitTask task = fit_task(model, references, options, set);
  task.start = Eigen::Vector3d(0.004127875, 0.021279816, 0.030849643);
  FitFlights flights(task, FitSetup{task.start, {0, 1, 2}});
  flights.measure_noise(task.start);
  const std::size_t before = flights.bins(0).size();
  flights.prepare(Eigen::Vector3d(0.004, 1.0, 0.03));
  EXPECT_NE(flights.bins(0).size(), before);
  EXPECT_EQ(static_cast<std::size_t>(flights.noise(0).level[0].size()), flights.bins(0).size());
}

}  // namespace
