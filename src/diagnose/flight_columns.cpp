#include "diagnose/flight_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "campaign/gps_rows.hpp"
#include "diagnose/shape_uncertainty.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"
#include "residuals/masks.hpp"
#include "residuals/samples.hpp"

namespace pcor::internal {
namespace {

/// Testability of a candidate on one flight.
struct Testability {
  std::size_t samples = 0;  // used samples
  std::size_t missing = 0;  // used samples without a value of some column
  bool varies = false;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(samples, missing, varies);
  }
};

Testability testability_of(const FlightColumns& flight, const std::vector<std::size_t>& used,
                           const ColumnGroup& group) {
  const Eigen::ArrayXXf values = flight.candidates(used, Eigen::seqN(group.first, group.count));
  return {used.size(), static_cast<std::size_t>((!values.isFinite()).rowwise().any().count()),
          (values.abs() > 0.0F).any()};
}

/// Reason why a candidate cannot be tested on these columns; empty if it can.
/// @param found result of each flight for each candidate
std::string problem_of(const std::vector<FlightColumns>& flights,
                       const std::vector<std::vector<Testability>>& found, std::size_t candidate) {
  bool varies = false;
  for (std::size_t f = 0; f < flights.size(); ++f) {
    const Testability& of_flight = found[f][candidate];
    varies = varies || of_flight.varies;
    if (of_flight.missing > 0) {
      return fmt::format("an input has no value, or an impossible one, in {} of {} samples of {}",
                         of_flight.missing, of_flight.samples, flights[f].samples->name);
    }
  }
  if (!varies)
    return "no sensitivity in the samples used: its inputs do not vary there, or the reference is "
           "insensitive to it";
  return "";
}

}  // namespace

std::vector<double> sum_of_columns(const FlightColumns& flight, const Eigen::VectorXd& coefficients) {
  const Eigen::Index base = flight.base.cols();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(as_index(flight.given.size()));
  for (Eigen::Index k = 0; k < coefficients.size(); ++k) {
    if (coefficients[k] == 0.0) continue;
    sum += coefficients[k] * (k < base ? flight.base.col(k) : flight.candidates.col(k - base)).cast<double>();
  }
  return {sum.begin(), sum.end()};
}

std::vector<double> residual_after(const FlightColumns& flight, const Eigen::VectorXd& coefficients) {
  std::vector<double> residual = flight.given;
  const std::vector<double> sum = sum_of_columns(flight, coefficients);
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= sum[i];
  return residual;
}

References in_order_of_diagnosis(References references) {
  // The samples are read once for the first reference; the laser reads the most.
  const auto position = [](const Reference& reference) {
    if (!reference.is_of_one_sample()) return reference.window() > 0.0 ? 2 : 3;
    return reference.reads_laser() ? 0 : 1;
  };
  std::stable_sort(references.begin(), references.end(),
                   [&position](const auto& a, const auto& b) { return position(*a) < position(*b); });
  return references;
}

PartitionedColumns columns_of_entries(
    const FlightPartition& partition, const std::function<SamplesOfFlight(std::size_t)>& read,
    const std::function<FlightColumns(std::size_t, SamplesOfFlight)>& make) {
  std::vector<FlightColumns> local(partition.flights());
  PartitionedColumns columns{partition,
                             partition.map<FlightColumns>(partition.threads(), read,
                                                          [&](std::size_t entry, SamplesOfFlight samples) {
                                                            local[entry] = make(entry, std::move(samples));
                                                            return outline_of(local[entry]);
                                                          })};
  for (std::size_t entry = 0; entry < local.size(); ++entry) {
    if (partition.is_local(entry)) columns.flights[entry] = std::move(local[entry]);
  }
  return columns;
}

PartitionedColumns columns_of_flights(const FlightSet& files, std::size_t count, const ModelDefinition& model,
                                      const CandidateSet& set, const DiagnoseOptions& options, Notes& notes) {
  std::vector<std::size_t> file_of_each;
  for (std::size_t r = 0; r < set.references.size(); ++r) {
    for (std::size_t file = 0; file < count; ++file) file_of_each.push_back(file);
  }
  std::size_t done = 0;
  const auto read = [&](std::size_t entry) {
    const std::size_t file = file_of_each[entry];
    const std::size_t r = entry / count;
    if (r == 0 && options.progress) options.progress(++done, files.partition().local_count());
    SamplesOfFlight samples = files.samples(file, set.extended, *set.references[0], options.mask);
    if (r > 0) {
      auto further = std::make_shared<FlightSamples>(*samples);
      further->notes.clear();
      further->reference = set.references[r]->read(files[file], further->time, further->notes);
      mark_frozen(files[file], *further, &FlightSamples::reference, options.mask.min_airspeed);
      samples = std::move(further);
    }
    return samples;
  };
  const auto make = [&](std::size_t entry, const SamplesOfFlight& samples) {
    FlightColumns found =
        find_columns(samples, model, set, entry / count, options.mask, options.training_share);
    found.file = file_of_each[entry];
    return found;
  };
  PartitionedColumns columns = columns_of_entries(files.partition().of_entries(file_of_each), read, make);
  for (const FlightColumns& flight : columns.flights)
    notes.insert(notes.end(), flight.samples->notes.begin(), flight.samples->notes.end());
  return columns;
}

void leave_out_empty(PartitionedColumns& columns) {
  const auto is_kept = columns.partition.all_gather_flights<int>([&](std::size_t number) {
    const FlightColumns& flight = columns.flights[number];
    const auto used = std::count(flight.mask.begin(), flight.mask.end(), Mask::none);
    const bool is_long = flight.reference == 0 || used >= static_cast<std::ptrdiff_t>(min_samples);
    const bool has_rows = !flight.is_by_gps || flight.gps.rows.size() > 0;
    return has_value(flight.given) && is_long && has_rows ? 1 : 0;
  });
  std::vector<std::size_t> kept;
  std::vector<FlightColumns> flights;
  for (std::size_t number = 0; number < is_kept.size(); ++number) {
    if (is_kept[number] == 0) continue;
    kept.push_back(number);
    flights.push_back(std::move(columns.flights[number]));
  }
  columns = {columns.partition.of_entries(kept), std::move(flights)};
}

std::vector<std::string> problems_of(
    const PartitionedColumns& columns, const std::vector<ColumnGroup>& groups,
    const std::function<std::vector<double>(const FlightColumns& flight)>& given_of) {
  const auto found = columns.partition.all_gather_flights<std::vector<Testability>>([&](std::size_t f) {
    const FlightColumns& flight = columns.flights[f];
    const std::vector<double> given = given_of(flight);
    std::vector<std::size_t> used;
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (!std::isnan(given[i])) used.push_back(i);
    }
    std::vector<Testability> of_each;
    for (const ColumnGroup& group : groups) of_each.push_back(testability_of(flight, used, group));
    return of_each;
  });
  std::vector<std::string> problems;
  for (std::size_t c = 0; c < groups.size(); ++c) problems.push_back(problem_of(columns.flights, found, c));
  return problems;
}

void drop_untestable(CandidateSet& set, PartitionedColumns& columns) {
  const std::vector<ColumnGroup> groups = groups_of(set, set.candidates);
  std::vector<std::string> problems =
      problems_of(columns, groups, [](const FlightColumns& flight) { return flight.given; });
  std::vector<Eigen::Index> kept;
  std::vector<Candidate> candidates;
  for (std::size_t c = 0; c < set.candidates.size(); ++c) {
    Candidate& candidate = set.candidates[c];
    if (problems[c].empty()) {
      for (const Eigen::Index column : indices_of(groups[c], 0)) kept.push_back(column);
      candidates.push_back(std::move(candidate));
    } else if (!candidate.is_variant) {
      set.not_testable.push_back({candidate.id, candidate.title, std::move(problems[c])});
    }
  }
  set.candidates = std::move(candidates);
  for (FlightColumns& flight : columns.flights) flight.keep_candidates(kept);
}

void hold_imitated_coefficients(CandidateSet& set, PartitionedColumns& columns, PartitionedColumns* further) {
  constexpr double notable = 0.03;  // hPa, rms
  const Eigen::Index count = as_index(set.base.size());
  // Products of all columns with each other; the last entry is the number of rows.
  const auto sums = columns.partition.all_reduce_flights<Eigen::MatrixXd>([&](std::size_t f) {
    const std::vector<std::size_t> used = used_samples(columns.flights[f].mask);
    const Eigen::MatrixXd base = columns.flights[f].base(used, Eigen::all).cast<double>();
    Eigen::MatrixXd of_flight(count, count + 1);
    of_flight.leftCols(count) = base.transpose() * base;
    of_flight.rightCols(1).setConstant(static_cast<double>(used.size()));
    return of_flight;
  });
  std::vector<Eigen::Index> kept;
  std::vector<BaseCoefficient> base;
  for (Eigen::Index k = 0; k < count; ++k) {
    BaseCoefficient& coefficient = set.base[static_cast<std::size_t>(k)];
    if (coefficient.of_reference && coefficient.typical > 0.0) {
      const Eigen::VectorXd across = sums(kept, k);
      const double remaining = sums(k, k) - across.dot(pseudo_solution(sums(kept, kept), across));
      if (!(coefficient.typical * std::sqrt(std::max(0.0, remaining) / sums(k, count)) > notable)) continue;
    }
    kept.push_back(k);
    base.push_back(std::move(coefficient));
  }
  set.base = std::move(base);
  for (PartitionedColumns* const each : {&columns, further}) {
    if (each == nullptr) continue;
    for (FlightColumns& flight : each->flights) flight.keep_base(kept);
  }
}

std::vector<ColumnGroup> groups_of(const CandidateSet& set, const std::vector<Candidate>& candidates) {
  // A difference of two systems is the same for an effect on either, so only one of them is identifiable.
  const bool differences_alone =
      std::all_of(set.references.begin(), set.references.end(),
                  [](const auto& reference) { return reference->model() != nullptr; });
  const bool is_by_gps = std::all_of(set.references.begin(), set.references.end(),
                                     [](const auto& reference) { return gps_kind(*reference).has_value(); });
  std::vector<ColumnGroup> groups;
  Eigen::Index first = 0;
  std::map<std::string, std::size_t> effects;
  std::map<std::string, std::size_t> systems;
  for (const Candidate& candidate : candidates) {
    ColumnGroup& group = groups.emplace_back();
    group.effect =
        effects.emplace(differences_alone ? candidate.effect.id : candidate.id, effects.size()).first->second;
    if (candidate.is_of_reference())
      group.system = systems.emplace(candidate.system, systems.size() + 1).first->second;
    // Variations of the atmosphere are more likely than an effect beyond the widest prior.
    if (is_by_gps) group.max_relative_size = widest_prior;
    group.first = first;
    group.count = as_index(candidate.tested.size());
    group.has_uncertain_shape = has_uncertain_shape(candidate.effect);
    for (const CandidateParameter& parameter : candidate.tested) {
      group.bounds.push_back(parameter.bounds);
      group.typical.push_back(parameter.typical);
    }
    first += group.count;
  }
  return groups;
}

}  // namespace pcor::internal
