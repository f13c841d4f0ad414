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

namespace pcor::internal {
namespace {

/// Why a candidate cannot be tested on these columns; empty where it can.
std::string trouble_of(const std::vector<FlightColumns>& flights, Eigen::Index first, Eigen::Index count) {
  bool varies = false;
  for (const FlightColumns& flight : flights) {
    std::size_t missing = 0;
    std::size_t used = 0;
    for (std::size_t i = 0; i < flight.given.size(); ++i) {
      if (std::isnan(flight.given[i])) continue;
      ++used;
      const auto values = flight.candidates.row(as_index(i)).segment(first, count);
      missing += values.allFinite() ? 0 : 1;
      varies = varies || values.cwiseAbs().maxCoeff() > 0.0F;
    }
    if (missing > 0) {
      return fmt::format("an input has no value, or an impossible one, in {} of {} samples of {}", missing,
                         used, flight.samples->name);
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

std::vector<FlightColumns> columns_of_flights(const std::vector<Flight>& files, const ModelFile& model,
                                              const CandidateSet& set, const DiagnoseOptions& options,
                                              std::vector<std::string>& notes) {
  std::vector<FlightColumns> columns;
  for (std::size_t r = 0; r < set.references.size(); ++r) {
    for (std::size_t f = 0; f < files.size(); ++f) {
      auto samples = std::make_shared<FlightSamples>(
          r == 0 ? read_samples(files[f], set.extended, *set.references[0], options.mask)
                 : *columns[f].samples);
      if (r > 0) {
        samples->notes.clear();
        samples->reference = set.references[r]->read(files[f], samples->time, samples->notes);
        mark_frozen(*samples, &FlightSamples::reference, options.mask.least_airspeed);
      }
      notes.insert(notes.end(), samples->notes.begin(), samples->notes.end());
      columns.push_back(
          find_columns(std::move(samples), model, set, r, options.mask, options.training_share));
      if (r == 0 && options.progress) options.progress(columns.size(), files.size());
    }
  }
  return columns;
}

void leave_out_empty(std::vector<FlightColumns>& columns) {
  columns.erase(
      std::remove_if(columns.begin(), columns.end(),
                     [](const FlightColumns& flight) {
                       const auto used = std::count(flight.mask.begin(), flight.mask.end(), Mask::none);
                       return !has_value(flight.given) ||
                              (flight.reference != 0 && used < static_cast<std::ptrdiff_t>(fewest_samples));
                     }),
      columns.end());
}

void drop_untestable(CandidateSet& set, std::vector<FlightColumns>& flights) {
  std::vector<Eigen::Index> kept;
  std::vector<Candidate> candidates;
  Eigen::Index first = 0;
  for (Candidate& candidate : set.candidates) {
    const Eigen::Index count = as_index(candidate.tested.size());
    std::string trouble = trouble_of(flights, first, count);
    if (trouble.empty()) {
      for (Eigen::Index k = 0; k < count; ++k) kept.push_back(first + k);
      candidates.push_back(std::move(candidate));
    } else if (!candidate.is_variant) {
      set.not_testable.push_back({candidate.id, candidate.title, std::move(trouble)});
    }
    first += count;
  }
  set.candidates = std::move(candidates);
  for (FlightColumns& flight : flights)
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
