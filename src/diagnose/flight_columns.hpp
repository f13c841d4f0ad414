#pragma once

#include <string>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/flight/flight.hpp>
#include "diagnose/candidates.hpp"
#include "diagnose/columns.hpp"
#include "diagnose/search.hpp"

namespace pcor::internal {

/// Fewer samples tell nothing.
inline constexpr std::size_t fewest_samples = 300;

/// The references that a diagnosis can use, those that tell of each sample first; a note on each of the
/// others. @throws Error if none tells of each sample.
References usable_references(const References& references, std::vector<std::string>& notes);

/// The columns of all flights against each of the set's references, those against the first one first.
/// @param notes get what a user should know of the flights
std::vector<FlightColumns> columns_of_flights(const std::vector<Flight>& files, const ModelFile& model,
                                              const CandidateSet& set, const DiagnoseOptions& options,
                                              std::vector<std::string>& notes);

/// Takes out the flights that have no residual, or hardly any against a further reference.
void leave_out_empty(std::vector<FlightColumns>& columns);

/// Takes out the candidates that cannot be tested, and their columns.
void drop_untestable(CandidateSet& set, std::vector<FlightColumns>& flights);

/// The columns of each candidate, one group after another.
std::vector<ColumnGroup> groups_of(const ModelFile& model, const std::vector<Candidate>& candidates);

}  // namespace pcor::internal
