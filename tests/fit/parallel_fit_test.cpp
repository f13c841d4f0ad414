#include <gmock/gmock.h>
#include <pcor/fit/refit.hpp>
#include <pcor/model_io/model_definition.hpp>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "support/error_of.hpp"
#include "support/synthetic_samples.hpp"
#include "support/thread_communicator.hpp"

// A fit whose flights are shared is the fit of one process, and sends little.

using namespace pcor;
using ::testing::Each;

namespace {

std::vector<std::shared_ptr<const FlightSamples>> flights(std::size_t count) {
  std::vector<std::shared_ptr<const FlightSamples>> made;
  for (std::size_t f = 0; f < count; ++f) {
    made::Plan plan;
    plan.seed = static_cast<unsigned>(f + 1);
    plan.samples = 1200 + 300 * (f % 4);
    plan.outliers = 0.01;
    plan.defect = made::equation_18;
    made.push_back(made::shared(plan));
  }
  return made;
}

/// Every number of a result, to the last bit.
std::string text_of(const RefitResult& result) {
  std::string text;
  const auto add = [&text](double value) { text += fmt::format("{:a} ", value); };
  for (const FittedParameter& each : result.parameters) {
    for (const double value : {each.value, each.standard_error, each.jackknife_error}) add(value);
  }
  for (const std::vector<double>& row : result.covariance) {
    for (const double value : row) add(value);
  }
  for (const double value : {result.rms, result.bulk_rms, result.noise_rms, result.drift_rms,
                             result.r_squared, result.condition_number, result.autocorrelation_time})
    add(value);
  for (const FlightFit& flight : result.flights) {
    text += flight.flight + " ";
    for (const double value : {flight.before.rms, flight.after.rms, flight.after.bias}) add(value);
  }
  for (const Omission& each : result.omissions) add(each.rms);
  for (const std::string& each : result.warnings) text += each;
  for (const Note& each : result.notes) text += each.text;
  return text + fmt::format("{} {}", result.samples, result.outliers);
}

RefitResult fit_of(const std::vector<std::shared_ptr<const FlightSamples>>& of, Communicator& comm,
                   std::size_t threads = 1) {
  RefitOptions options;
  options.threads = threads;
  options.training_share = 0.9;
  return refit({of, {{}, &comm}}, made::model({"static-constant", "static-alpha", "static-qp"}),
               made::pressure_reference(), options);
}

TEST(ParallelFit, ResultIsIndependentOfRanksAndThreads) {
  const auto all = flights(5);
  const std::string alone_result = text_of(fit_of(all, serial_communicator()));
  EXPECT_EQ(text_of(fit_of(all, serial_communicator(), 2)), alone_result);
  for (const std::size_t ranks : {2, 3, 7}) {
    std::vector<std::string> results(ranks);
    test::run_with_communicator(
        ranks, [&](Communicator& comm) { results[comm.rank()] = text_of(fit_of(all, comm)); });
    EXPECT_THAT(results, Each(alone_result)) << ranks;
  }
}

TEST(ParallelFit, ManyFlightsWithUninformativeOnesAgree) {
  std::vector<std::shared_ptr<const FlightSamples>> all = flights(19);
  for (const std::size_t blind : {0U, 2U, 4U, 18U}) {
    auto without = std::make_shared<FlightSamples>(*all[blind]);
    for (auto& [quantity, values] : without->reference.columns)
      std::fill(values.begin() + 5, values.end(), NAN);
    all[blind] = without;
  }
  const RefitResult alone_result = fit_of(all, serial_communicator());
  std::vector<std::string> results(4);
  test::run_with_communicator(4,
                              [&](Communicator& comm) { results[comm.rank()] = text_of(fit_of(all, comm)); });
  EXPECT_THAT(results, Each(text_of(alone_result)));
  // The order of the flights does not matter, except for the rounding of sums.
  std::reverse(all.begin(), all.end());
  const RefitResult reversed = fit_of(all, serial_communicator());
  for (std::size_t p = 0; p < reversed.parameters.size(); ++p) {
    const FittedParameter& one = alone_result.parameters[p];
    EXPECT_NEAR(reversed.parameters[p].value, one.value, 1e-6 * one.standard_error);
    EXPECT_NEAR(reversed.parameters[p].standard_error / one.standard_error, 1.0, 1e-6);
  }
}

/// The bytes of each exchange of all ranks together.
std::vector<std::size_t> bytes_of_exchanges(std::size_t count) {
  const auto all = flights(count);
  const auto sent = test::run_with_communicator(3, [&](Communicator& comm) { fit_of(all, comm); });
  std::vector<std::size_t> bytes(sent.front().size(), 0);
  for (const std::vector<std::size_t>& rank : sent) {
    EXPECT_EQ(rank.size(), sent.front().size());
    if (rank.size() != bytes.size()) break;
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] += rank[i];
  }
  return bytes;
}

TEST(ParallelFit, EachPassExchangesOneMatrixPerFlight) {
  constexpr std::size_t unknowns = 3;
  for (const std::size_t count : {17U, 34U}) {
    const std::size_t least = count * 8 * (unknowns + 1) * (unknowns + 1);
    const std::size_t most = least + (count + 3) * 64;  // other numbers of each flight and each rank
    const std::vector<std::size_t> bytes = bytes_of_exchanges(count);
    const auto passes = std::count_if(bytes.begin(), bytes.end(),
                                      [&](std::size_t each) { return each > least && each <= most; });
    EXPECT_GT(passes, 3) << count;
  }
}

TEST(ParallelFit, FailsEquallyOnAllRanks) {
  std::vector<std::optional<Error>> errors(2);
  test::run_with_communicator(2, [&](Communicator& comm) {
    const std::vector<std::filesystem::path> paths{"nowhere/a.nc", "nowhere/b.nc"};
    errors[comm.rank()] = test::error_of([&] {
      refit({paths, {{}, &comm}}, made::model({"static-constant"}), made::pressure_reference());
    });
  });
  EXPECT_THAT(errors, Each(test::IsError(Error::Code::file, "nowhere/a.nc")));
}

}  // namespace
