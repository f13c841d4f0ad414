#include <gtest/gtest.h>
#include <pcor/improve/improve.hpp>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "residuals/reference_on_samples.hpp"
#include "support/short_flight.hpp"

// Number of times that a whole improvement opens its flights, reads their samples and builds residuals.

using namespace pcor;

namespace {

struct Counts {
  std::map<std::filesystem::path, std::size_t> reads{};  ///< number of reads of the samples of each flight
  std::size_t residuals = 0;
};

/// The laser, which counts its calls.
class CountingReference final : public Reference {
 public:
  explicit CountingReference(std::shared_ptr<Counts> counts) : counts_(std::move(counts)) {}

  std::string description() const override { return laser_->description(); }
  std::string name() const override { return laser_->name(); }
  bool reads_laser() const override { return true; }

  ModelSamples read(const Flight& flight, const std::vector<double>& time, Notes& notes) const override {
    ++counts_->reads[flight.path()];
    return laser_->read(flight, time, notes);
  }

  std::unique_ptr<ReferenceOnSamples> on(const FlightSamples& samples,
                                         const ModelOnSamples& model) const override {
    ++counts_->residuals;
    return laser_->on(samples, model);
  }

 private:
  std::shared_ptr<const Reference> laser_ = lams_reference();
  std::shared_ptr<Counts> counts_;
};

TEST(FlightReads, ImproveReadsFlightsOncePerSetOfRoles) {
  const test::TemporaryDirectory directory;
  std::vector<std::filesystem::path> paths;
  for (const std::uint64_t seed : {101U, 102U, 103U}) {
    Scenario scenario = read_scenario(test::scenarios / "c130-hidden.toml");
    scenario.seed = seed;
    paths.push_back(directory / (std::to_string(seed) + ".nc"));
    simulate_flight(scenario, paths.back());
  }
  const FlightSet flights(paths);
  const auto counts = std::make_shared<Counts>();
  ImproveOptions options;
  options.refit.holdout = flights.part(2, 1);
  options.trace_variables = true;
  const Improvement improvement = improve(flights.part(0, 2), test::laser_model(),
                                          {std::make_shared<CountingReference>(counts)}, options);
  ASSERT_EQ(improvement.steps.size(), 2U) << "one effect is found";
  // Inputs of the model, inputs of it and all candidates, and both again with the effect that is added.
  for (const auto& [path, reads] : counts->reads) EXPECT_LE(reads, 4U) << path;
  EXPECT_EQ(counts->reads.size(), 3U);
  // The residuals of the laser are not linear: a fit builds them again for each evaluation of a flight, and
  // does not keep them in memory.
  EXPECT_LE(counts->residuals, 160U);
}

}  // namespace
