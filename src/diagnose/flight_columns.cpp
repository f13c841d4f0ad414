#include "diagnose/flight_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <pcor/effects/catalogue.hpp>
#include <pcor/words/error.hpp>
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"
#include "residuals/frozen.hpp"
#include "team/workers.hpp"

namespace pcor::internal {
namespace {

/// Why a candidate cannot be tested on these columns; empty where it can.
/// @param found of each flight what it says of each candidate
std::string trouble_of(const std::vector<FlightColumns>& flights,
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
    return "nothing of it reaches the residual in the samples used: what it depends on does not occur there, "
           "or the reference does not see it";
  return "";
}

/// Whether an effect reads the flow angles, which the radome tells by more than one sensor.
bool reads_flow_angles(const EffectFacts& facts) {
  return std::any_of(facts.needs.begin(), facts.needs.end(), [](Quantity need) {
    return need == Quantity::attack || need == Quantity::attack_ratio || need == Quantity::sideslip ||
           need == Quantity::sideslip_ratio;
  });
}

// Of an effect of flow angles where the model has one: what is left of its variance may be the noise by which
// two sensors of one angle differ. Another scaling of it differs still less.
constexpr double left_by_same_angle = 0.005;
constexpr double left_by_same_sensors = 0.02;

/// Whether an effect of the catalogue is of the family and the place of one that a model has, by other
/// sensors.
bool is_like_one_of(const ModelFile& model, const Candidate& candidate) {
  const std::size_t known = effect_named(candidate.effect.id);
  if (known == catalogue_size || candidate.is_of_reference()) return false;
  const EffectFacts& facts = effect_facts[known];
  if (!reads_flow_angles(facts)) return false;
  return std::any_of(model.model.effects.begin(), model.model.effects.end(), [&](const ModelEffect& effect) {
    const std::size_t other = effect_named(effect.id);
    return other != catalogue_size && effect_facts[other].family == facts.family &&
           effect_facts[other].where == facts.where;
  });
}

}  // namespace

Testability testability_of(const FlightColumns& flight, const std::vector<double>& given, Eigen::Index first,
                           Eigen::Index count) {
  Testability found;
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (std::isnan(given[i])) continue;
    const auto values = flight.candidates.row(as_index(i)).segment(first, count);
    ++found.samples;
    found.missing += values.allFinite() ? 0 : 1;
    found.varies = found.varies || values.cwiseAbs().maxCoeff() > 0.0F;
  }
  return found;
}

References usable_references(const References& references, std::vector<std::string>& notes) {
  References result;
  References of_windows;
  for (const auto& reference : references) {
    if (reference->is_of_one_sample()) {
      result.push_back(reference);
    } else if (reference->window() > 0.0) {
      of_windows.push_back(reference);
    } else {
      notes.push_back(fmt::format(
          "the reference {} took no part in the diagnosis: it holds many minutes together, of which no part "
          "tells something for itself; compare shows it, and refit uses it",
          reference->name()));
    }
  }
  const bool tells_of_samples = !result.empty();
  result.insert(result.end(), of_windows.begin(), of_windows.end());
  if (!tells_of_samples)
    throw Error(
        "nothing to diagnose with: give a reference that tells of each sample, such as --reference lams");
  return result;
}

TeamColumns columns_of_entries(const FlightShare& share,
                               const std::function<SamplesOfFlight(std::size_t)>& read,
                               const std::function<FlightColumns(std::size_t, SamplesOfFlight)>& make) {
  std::vector<FlightColumns> own(share.flights());
  TeamColumns columns{share, share.map<FlightColumns>(Workers(share.team(), 0).threads, read,
                                                      [&](std::size_t entry, SamplesOfFlight samples) {
                                                        own[entry] = make(entry, std::move(samples));
                                                        return outline_of(own[entry]);
                                                      })};
  for (std::size_t entry = 0; entry < own.size(); ++entry) {
    if (share.owns(entry)) columns.flights[entry] = std::move(own[entry]);
  }
  return columns;
}

TeamColumns columns_of_flights(const FlightSet& files, std::size_t count, const ModelFile& model,
                               const CandidateSet& set, const DiagnoseOptions& options,
                               std::vector<std::string>& notes) {
  std::vector<std::size_t> file_of_each;
  for (std::size_t r = 0; r < set.references.size(); ++r) {
    for (std::size_t file = 0; file < count; ++file) file_of_each.push_back(file);
  }
  std::size_t done = 0;
  const auto read = [&](std::size_t entry) {
    const std::size_t file = file_of_each[entry];
    const std::size_t r = entry / count;
    if (r == 0 && options.progress) options.progress(++done, files.share().own());
    SamplesOfFlight samples = files.samples(file, set.extended, *set.references[0], options.mask);
    if (r > 0) {
      auto further = std::make_shared<FlightSamples>(*samples);
      further->notes.clear();
      further->reference = set.references[r]->read(files[file], further->time, further->notes);
      mark_frozen(*further, &FlightSamples::reference, options.mask.least_airspeed);
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
  TeamColumns columns = columns_of_entries(files.share().of_entries(file_of_each), read, make);
  for (const FlightColumns& flight : columns.flights)
    notes.insert(notes.end(), flight.samples->notes.begin(), flight.samples->notes.end());
  return columns;
}

void leave_out_empty(TeamColumns& columns) {
  const auto is_left = columns.share.of_each_flight<bool>([&](std::size_t number) {
    const FlightColumns& flight = columns.flights[number];
    const auto used = std::count(flight.mask.begin(), flight.mask.end(), Mask::none);
    return has_value(flight.given) &&
           (flight.reference == 0 || used >= static_cast<std::ptrdiff_t>(fewest_samples));
  });
  std::vector<std::size_t> left;
  std::vector<FlightColumns> flights;
  for (std::size_t number = 0; number < is_left.size(); ++number) {
    if (!is_left[number]) continue;
    left.push_back(number);
    flights.push_back(std::move(columns.flights[number]));
  }
  columns = {columns.share.of_entries(left), std::move(flights)};
}

void drop_untestable(CandidateSet& set, TeamColumns& columns) {
  const auto found = columns.share.of_each_flight<std::vector<Testability>>([&](std::size_t number) {
    const FlightColumns& flight = columns.flights[number];
    std::vector<Testability> of_each;
    for (std::size_t c = 0; c < set.candidates.size(); ++c)
      of_each.push_back(testability_of(flight, flight.given, as_index(set.first_column(c)),
                                       as_index(set.candidates[c].tested.size())));
    return of_each;
  });
  std::vector<Eigen::Index> kept;
  std::vector<Candidate> candidates;
  Eigen::Index first = 0;
  for (std::size_t c = 0; c < set.candidates.size(); ++c) {
    Candidate& candidate = set.candidates[c];
    const Eigen::Index count = as_index(candidate.tested.size());
    std::string trouble = trouble_of(columns.flights, found, c);
    if (trouble.empty()) {
      for (Eigen::Index k = 0; k < count; ++k) kept.push_back(first + k);
      candidates.push_back(std::move(candidate));
    } else if (!candidate.is_variant) {
      set.not_testable.push_back({candidate.id, candidate.title, std::move(trouble)});
    }
    first += count;
  }
  set.candidates = std::move(candidates);
  for (FlightColumns& flight : columns.flights)
    flight.candidates = Eigen::MatrixXf(flight.candidates(Eigen::all, kept));
}

std::vector<ColumnGroup> groups_of(const ModelFile& model, const std::vector<Candidate>& candidates) {
  std::vector<ColumnGroup> groups;
  Eigen::Index first = 0;
  std::size_t effect = 0;
  std::string before;
  for (const Candidate& candidate : candidates) {
    if (candidate.id != before) ++effect;
    before = candidate.id;
    ColumnGroup& group = groups.emplace_back();
    group.effect = effect;
    if (is_like_one_of(model, candidate))
      group.least_left = candidate.is_variant ? left_by_same_sensors : left_by_same_angle;
    group.first = first;
    group.count = as_index(candidate.tested.size());
    for (const CandidateParameter& parameter : candidate.tested) {
      group.bounds.push_back(parameter.bounds);
      group.usual.push_back(parameter.typical);
    }
    first += group.count;
  }
  return groups;
}

}  // namespace pcor::internal
