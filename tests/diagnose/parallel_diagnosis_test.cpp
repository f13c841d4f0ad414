// A diagnosis by several ranks is that of one process, bit by bit.
#include <gmock/gmock.h>
#include <pcor/base/error.hpp>
#include <pcor/diagnose/diagnose.hpp>
#include <pcor/diagnose/diagnosis_report.hpp>
#include <pcor/diagnose/what_if.hpp>
#include <pcor/report/json.hpp>
#include <pcor/simulate/simulate.hpp>

#include <filesystem>
#include <functional>
#include <iostream>
#include <numeric>
#include <string>
#include <vector>

#include "diagnose/tried_formula.hpp"
#include "parallel/serialization.hpp"
#include "residuals/serialization.hpp"
#include "support/error_of.hpp"
#include "support/short_flight.hpp"
#include "support/temporary_directory.hpp"
#include "support/thread_communicator.hpp"

namespace cereal {

template <class Archive>
void serialize(Archive& archive, pcor::WhatIfCoefficient& coefficient) {
  archive(coefficient.name, coefficient.given, coefficient.start, coefficient.fixed);
}

template <class Archive>
void serialize(Archive& archive, pcor::WhatIfSums& sums) {
  archive(sums.products, sums.samples);
}

template <class Archive>
void serialize(Archive& archive, pcor::WhatIfWeights& weights) {
  archive(weights.effects, weights.parts, weights.score_covariance);
}

template <class Archive>
void serialize(Archive& archive, pcor::WhatIfFlight& flight) {
  archive(flight.samples, flight.columns);
}

}  // namespace cereal

namespace pcor {
namespace {

using internal::serialized;
using test::laser_model;
using test::run_with_communicator;
using test::scenario_text;
using test::tried_formula;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using Paths = std::vector<std::filesystem::path>;

/// Five flights of a quarter of an hour, of different lengths of files, that lack an effect.
Paths flights(const std::string& effect, unsigned seed) {
  static const test::TemporaryDirectory directory;
  Paths paths;
  for (unsigned flight = 0; flight < 5; ++flight) {
    paths.push_back(directory / (std::to_string(seed) + "-" + std::to_string(flight) + ".nc"));
    if (std::filesystem::exists(paths.back())) continue;
    const std::string text = scenario_text("c130-short");
    Scenario scenario = parse_scenario(effect.empty() ? text : text + "\n[[effect]]\n" + effect, "short");
    scenario.seed = seed + flight;
    scenario.start += 86400.0 * flight;
    simulate_flight(scenario, paths.back());
  }
  return paths;
}

/// Results that the JSON of a diagnosis leaves out.
std::string beside_json(const Diagnosis& diagnosis) {
  std::vector<double> numbers;
  std::vector<std::string> held;
  for (const Finding& finding : diagnosis.findings) {
    numbers.insert(numbers.end(), {finding.chi2_reduction, finding.chi2_reduction_error, finding.worst_time,
                                   static_cast<double>(finding.is_shared)});
    held.push_back(serialized(finding.evidence));
    held.insert(held.end(), finding.fixed.begin(), finding.fixed.end());
    for (const Alias& alias : finding.aliases) {
      const std::vector<double>& parameters = alias.correction.parameters;
      numbers.insert(numbers.end(), {alias.probability, static_cast<double>(alias.is_shared)});
      numbers.insert(numbers.end(), parameters.begin(), parameters.end());
      held.insert(held.end(), alias.fixed.begin(), alias.fixed.end());
    }
  }
  for (const CoefficientEstimate& estimate : diagnosis.refitted_coefficients)
    numbers.insert(numbers.end(), {estimate.value, estimate.standard_error});
  return serialized(numbers) + serialized(held) + serialized(diagnosis.flights);
}

/// The JSON has all digits of its numbers, except of times, which it gives to the second.
void expect_same(const Diagnosis& one, const Diagnosis& other) {
  EXPECT_EQ(to_json(one), to_json(other));
  EXPECT_EQ(beside_json(one), beside_json(other));
}

/// Runs several ranks and returns their exchanges.
void run_team(std::size_t size, const std::function<void(Communicator&)>& work) {
  testing::internal::CaptureStderr();  // HDF5 prints errors of failed netCDF queries in further threads
  const auto sent = run_with_communicator(size, work, true);
  testing::internal::GetCapturedStderr();
  std::size_t bytes = 0;
  for (const auto& rank : sent) bytes = std::accumulate(rank.begin(), rank.end(), bytes);
  std::cout << size << " ranks: " << sent.front().size() << " exchanges, " << bytes << " bytes\n";
}

/// The diagnosis of one process, to which that of several ranks is equal.
Diagnosis expect_that_of_one(const Paths& paths, const References& references, DiagnoseOptions options = {}) {
  const Diagnosis alone = diagnose(paths, laser_model(), references, options);
  for (const std::size_t size : {3U, 6U}) {  // ranks with several flights, and one without a flight
    SCOPED_TRACE(size);
    run_team(size, [&](Communicator& comm) {
      expect_same(diagnose({paths, {{}, &comm}}, laser_model(), references, options), alone);
    });
  }
  return alone;
}

const std::string strong_beta_odd = "id = \"static-beta-odd\"\nb1 = -0.02\n";

TEST(ParallelDiagnosis, FindsSameEffectAndSeparationAdvice) {
  DiagnoseOptions options;
  options.formulas = {tried_formula("k * sideslip")};
  const Diagnosis diagnosis = expect_that_of_one(flights(strong_beta_odd, 10), {lams_reference()}, options);
  ASSERT_THAT(diagnosis.findings, Not(IsEmpty()));
  EXPECT_THAT(diagnosis.findings[0].aliases, Not(IsEmpty()));
  EXPECT_THAT(diagnosis.findings[0].advice.sentence, Not(IsEmpty()));
}

TEST(ParallelDiagnosis, FindsTheSameEffectWithFlapsExtended) {
  const std::string flaps = "id = \"flaps-gear\"\ndefect = 3.0\n";
  DiagnoseOptions options;
  options.whole_file = false;
  const Diagnosis diagnosis = expect_that_of_one(flights(flaps, 40), {lams_reference()}, options);
  ASSERT_THAT(diagnosis.findings, Not(IsEmpty()));
  EXPECT_EQ(diagnosis.findings[0].effect.id, "flaps-gear");
  EXPECT_GE(diagnosis.findings[0].largest_rms, diagnosis.findings[0].rms);
}

TEST(ParallelWhatIf, ResultEqualsThatOfOneProcess) {
  const Paths paths = flights(strong_beta_odd, 10);
  const Diagnosis diagnosis = diagnose(paths, laser_model(), {lams_reference()});
  const auto candidates = what_if_candidates(diagnosis, {});
  WhatIfOptions options;
  options.diagnose.training_share = 0.8;
  options.refitted_coefficients = diagnosis.refitted_coefficients;
  const auto of_team = [&](Communicator& comm, WhatIfOptions with) {
    const FlightSet all(paths, {{}, &comm});
    with.holdout = all.part(paths.size() - 1, 1);
    return what_if(all.part(0, paths.size() - 1), laser_model(), {lams_reference()}, candidates, with);
  };
  const WhatIf alone = of_team(pcor::serial_communicator(), options);
  EXPECT_GT(alone.panel.held_out.samples, 0.0);
  for (const std::size_t size : {2U, 6U}) {
    run_team(size, [&](Communicator& comm) {
      const WhatIf found = of_team(comm, options);
      EXPECT_EQ(serialized(found.panel.coefficients), serialized(alone.panel.coefficients));
      EXPECT_EQ(serialized(found.panel.weights), serialized(alone.panel.weights));
      EXPECT_EQ(serialized(found.panel.unweighted), serialized(alone.panel.unweighted));
      EXPECT_EQ(serialized(found.panel.outliers), serialized(alone.panel.outliers));
      EXPECT_EQ(serialized(found.panel.held_out), serialized(alone.panel.held_out));
      EXPECT_EQ(serialized(found.flights), serialized(alone.flights));
    });
  }
  options.diagnose.series_of = {1};
  run_team(2, [&](Communicator& comm) {
    const WhatIf shown = of_team(comm, options);
    ASSERT_EQ(shown.flights.size(), 2U);
    EXPECT_EQ(shown.flights[0].samples->name, alone.flights[1].samples->name);
    EXPECT_EQ(serialized(shown.flights[0]), serialized(alone.flights[1]));
    EXPECT_EQ(serialized(shown.flights[1]), serialized(alone.flights.back()));
    EXPECT_EQ(serialized(shown.panel.held_out), serialized(alone.panel.held_out));
  });
}

TEST(ParallelDiagnosis, FindsTheSameVariablesOfTheFiles) {
  DiagnoseOptions options;
  options.training_share = 0.9;
  const Diagnosis diagnosis = expect_that_of_one(
      flights("id = \"unknown\"\nwhere = \"static\"\non = \"PSFD\"\nof = \"ENGTRQ\"\nstrength = 3.0\n"
              "centre = 50\nscale = 100\n",
              20),
      {lams_reference(), read_reference("total:PSFRD+QCFR", laser_model())}, options);
  EXPECT_THAT(diagnosis.unexplained.variables, Not(IsEmpty()));
  EXPECT_GT(diagnosis.held_out.size(), 1U);
  for (const pcor::HeldOutPart& part : diagnosis.held_out) EXPECT_EQ(part.parts, diagnosis.held_out.size());
}

TEST(ParallelDiagnosis, HoldsTheRequestedRecords) {
  DiagnoseOptions options;
  options.whole_file = false;
  for (const std::vector<std::size_t>& requested : {std::vector<std::size_t>{}, {1, 4}}) {
    options.series_of = requested;
    const Diagnosis diagnosis = expect_that_of_one(flights("", 30), {lams_reference()}, options);
    std::vector<std::size_t> held;
    for (const FlightDiagnosis& flight : diagnosis.flights) {
      EXPECT_EQ(flight.samples == nullptr, flight.before.empty());
      EXPECT_THAT(flight.name, HasSubstr("30-"));
      if (flight.samples) held.push_back(flight.number);
    }
    EXPECT_THAT(what_if_candidates(diagnosis, {}), Not(IsEmpty()));
    if (!requested.empty()) {
      EXPECT_THAT(diagnosis_report(diagnosis, laser_model()).summary,
                  testing::Contains(HasSubstr("2 of the 5 flights")));
    }
    EXPECT_EQ(held, requested);
  }
}

TEST(ParallelDiagnosis, FailsOnAllRanksAsInOneProcess) {
  Paths paths = flights("", 30);
  const test::TemporaryDirectory directory;
  paths[2] = directory / "broken.nc";
  std::ofstream(paths[2]) << "no flight";
  const std::optional<Error> alone =
      test::error_of([&] { diagnose(paths, laser_model(), {lams_reference()}); });
  ASSERT_THAT(alone, test::IsError(Error::Code::file, "broken.nc"));
  for (const std::size_t size : {2U, 3U, 6U}) {
    run_team(size, [&](Communicator& comm) {
      const auto error = test::error_of([&] {
        diagnose({paths, {{}, &comm}}, laser_model(), {lams_reference()});
      });
      EXPECT_THAT(error, test::IsError(alone->code(), alone->what())) << "of " << comm.rank();
    });
  }
}

}  // namespace
}  // namespace pcor
