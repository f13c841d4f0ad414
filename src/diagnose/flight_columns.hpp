#pragma once

#include <functional>
#include <string>
#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include <pcor/diagnose/diagnose.hpp>
#include "campaign/columns.hpp"
#include "diagnose/candidates.hpp"
#include "diagnose/search.hpp"

namespace pcor::internal {

/// Fewer samples tell nothing.
inline constexpr std::size_t min_samples = 300;

/// What a flight says of whether a candidate can be tested.
struct Testability {
  std::size_t samples = 0;  ///< that are used
  std::size_t missing = 0;  ///< of these, those without a value of some column
  bool varies = false;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(samples, missing, varies);
  }
};

/// @param given has a value where a sample is used @param first of the columns of the candidate
Testability testability_of(const FlightColumns& flight, const std::vector<double>& given, Eigen::Index first,
                           Eigen::Index count);

/// The references that a diagnosis can use, those that tell of each sample first; a note on each of the
/// others. @throws Error if there is none.
References usable_references(const References& references, std::vector<std::string>& notes);

/// Flights of a team, each against each of its references, those against the first one first. A member has
/// the columns of its own, and of the others what all know (`outline_of`).
struct TeamColumns {
  FlightPartition share;
  std::vector<FlightColumns> flights{};
};

using SamplesOfFlight = std::shared_ptr<const FlightSamples>;

/// The columns of entries of a share, in threads.
/// @param read gives the samples of an own entry @param make gives its columns
TeamColumns columns_of_entries(const FlightPartition& share,
                               const std::function<SamplesOfFlight(std::size_t entry)>& read,
                               const std::function<FlightColumns(std::size_t entry, SamplesOfFlight)>& make);

/// The columns of the first `count` flights against each of the set's references.
/// @param notes get what a user should know of the flights
TeamColumns columns_of_flights(const FlightSet& files, std::size_t count, const ModelDefinition& model,
                               const CandidateSet& set, const DiagnoseOptions& options,
                               std::vector<std::string>& notes);

/// Takes out the flights that have no residual, or hardly any against a further reference.
void leave_out_empty(TeamColumns& columns);

/// Takes out the candidates that cannot be tested, and their columns.
void drop_untestable(CandidateSet& set, TeamColumns& columns);

/// Holds the coefficients of the references' laws that the model's own coefficients imitate: those of which,
/// at their usual size, less than 0.03 hPa (rms) is left. Against a second system alone, that is all
/// coefficients of the same kind: the difference of two nearly equal columns, at an impossible size, would
/// imitate anything.
/// @param further flights, of which the same columns are kept
void hold_imitated_coefficients(CandidateSet& set, TeamColumns& columns, TeamColumns* further = nullptr);

/// The columns of each candidate, one group after another.
/// @param set with the references @param candidates of the set
std::vector<ColumnGroup> groups_of(const CandidateSet& set, const std::vector<Candidate>& candidates);

}  // namespace pcor::internal
