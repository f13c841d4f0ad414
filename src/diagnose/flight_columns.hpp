#pragma once

#include <functional>
#include <string>
#include <vector>

#include <pcor/base/note.hpp>
#include <pcor/campaign/flight_set.hpp>
#include <pcor/diagnose/diagnose.hpp>
#include "campaign/columns.hpp"
#include "campaign/effect_search.hpp"
#include "diagnose/candidates.hpp"

namespace pcor::internal {

/// Minimum number of samples.
inline constexpr std::size_t min_samples = 300;

/// Sum of the columns of base and candidates times their coefficients, for each record of a local flight,
/// hPa. NaN where a column with a coefficient other than zero has no value.
/// @param coefficients of all columns, the base first
std::vector<double> sum_of_columns(const FlightColumns& flight, const Eigen::VectorXd& coefficients);

/// `FlightColumns::given` minus `sum_of_columns`, hPa; NaN if not used.
std::vector<double> residual_after(const FlightColumns& flight, const Eigen::VectorXd& coefficients);

/// References in the order of a diagnosis: the laser, others of single samples, height, wind.
References in_order_of_diagnosis(References references);

/// Flights against each of their references, the first reference first. A rank has the columns of its local
/// flights, and the shared outlines of the others (`outline_of`).
struct PartitionedColumns {
  FlightPartition partition;
  std::vector<FlightColumns> flights{};
};

using SamplesOfFlight = std::shared_ptr<const FlightSamples>;

/// Columns of entries of a partition, computed in threads.
/// @param read gives the samples of a local entry @param make gives its columns
PartitionedColumns columns_of_entries(
    const FlightPartition& partition, const std::function<SamplesOfFlight(std::size_t entry)>& read,
    const std::function<FlightColumns(std::size_t entry, SamplesOfFlight)>& make);

/// Columns of the first `count` flights against each reference of the set.
/// @param notes receives notes about the flights for the user
PartitionedColumns columns_of_flights(const FlightSet& files, std::size_t count, const ModelDefinition& model,
                                      const CandidateSet& set, const DiagnoseOptions& options, Notes& notes);

/// Removes flights without a residual, or with too few samples against a further reference.
void leave_out_empty(PartitionedColumns& columns);

/// Reason for each group why its candidate cannot be tested on these columns; empty if it can.
/// @param given_of gives a series of a local flight that has a value if a sample is used
std::vector<std::string> problems_of(
    const PartitionedColumns& columns, const std::vector<ColumnGroup>& groups,
    const std::function<std::vector<double>(const FlightColumns& flight)>& given_of);

/// Removes candidates that cannot be tested, and their columns.
void drop_untestable(CandidateSet& set, PartitionedColumns& columns);

/// Fixes coefficients of the references' laws that the model's coefficients imitate: at their usual size,
/// less than 0.03 hPa (rms) remains. If a second system is the only reference, all coefficients of the same
/// kind are fixed, because the difference of two nearly equal columns at an impossible size would imitate any
/// effect.
/// @param further flights that keep the same columns
void hold_imitated_coefficients(CandidateSet& set, PartitionedColumns& columns,
                                PartitionedColumns* further = nullptr);

/// Groups of the columns of all candidates in order.
/// @param set with the references @param candidates of the set
std::vector<ColumnGroup> groups_of(const CandidateSet& set, const std::vector<Candidate>& candidates);

}  // namespace pcor::internal
