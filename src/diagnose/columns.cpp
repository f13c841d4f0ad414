#include "diagnose/columns.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include <pcor/effects/catalogue.hpp>
#include <pcor/realtime/chain.hpp>
#include <pcor/words/error.hpp>
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"
#include "residuals/masks.hpp"
#include "residuals/moving_columns.hpp"

namespace pcor::internal {
namespace {

constexpr int jet_width = 3;
using Jet = ceres::Jet<double, jet_width>;

/// What a candidate remembers, found over its own time.
struct Remembered {
  Quantity quantity = Quantity::count;
  double time = 0.0;  // s
  std::vector<double> values{};
};

/// One evaluation of a candidate: its derivatives by some of the tested parameters.
struct Evaluation {
  std::size_t effect;        // number in the extended model
  std::size_t place;         // among the places of all candidates
  std::size_t first_column;  // of the parameters
  std::size_t width;
  std::vector<Jet> parameters;
  const Remembered* remembered = nullptr;  // instead of what the samples have
};

/// The number of a candidate in the extended model of its system; nothing where that has none.
std::optional<std::size_t> number_of(const Candidate& candidate, std::size_t reference) {
  return candidate.is_of_reference() ? candidate.numbers_in_others[reference] : candidate.number;
}

/// The evaluations of the candidates of one system.
std::vector<Evaluation> evaluations_of(const CandidateSet& set, std::size_t reference, bool of_reference,
                                       const std::vector<Where>& places,
                                       const std::vector<Remembered>& remembered) {
  std::vector<Evaluation> evaluations;
  std::size_t column = 0;
  for (const Candidate& candidate : set.candidates) {
    const std::size_t end = column + candidate.tested.size();
    const std::optional<std::size_t> number = number_of(candidate, reference);
    if (candidate.is_of_reference() == of_reference && !candidate.is_shared && number) {
      const auto place = std::find(places.begin(), places.end(), where_of(candidate.effect)) - places.begin();
      const std::vector<double>& neutral = candidate.effect.parameters;
      for (std::size_t first = 0; first < candidate.tested.size(); first += jet_width) {
        const std::size_t width = std::min<std::size_t>(jet_width, candidate.tested.size() - first);
        std::vector<Jet> parameters(neutral.begin(), neutral.end());
        for (std::size_t k = 0; k < width; ++k)
          parameters[candidate.tested[first + k].place].v[as_index(k)] = 1.0;
        evaluations.push_back(
            {*number, static_cast<std::size_t>(place), column + first, width, std::move(parameters)});
        const auto own = std::find_if(remembered.begin(), remembered.end(), [&](const Remembered& each) {
          return each.quantity == memory_of(candidate.effect).of && each.time == candidate.memory;
        });
        if (own != remembered.end()) evaluations.back().remembered = &*own;
      }
    }
    column = end;
  }
  return evaluations;
}

/// What the candidates of the own system remember over times of their own; what they find over none the
/// samples have.
std::vector<Remembered> remembered_by(const CandidateSet& set, const FlightSamples& samples) {
  std::vector<Remembered> all;
  for (const Candidate& candidate : set.candidates) {
    if (candidate.memory == 0.0 || candidate.is_of_reference()) continue;
    const Quantity quantity = memory_of(candidate.effect).of;
    std::vector<double> values =
        remembered(quantity, samples.model, samples.time, samples.step, candidate.memory);
    if (!values.empty()) all.push_back({quantity, candidate.memory, std::move(values)});
  }
  return all;
}

std::size_t column_count(const CandidateSet& set) {
  std::size_t count = 0;
  for (const Candidate& candidate : set.candidates) count += candidate.tested.size();
  return count;
}

/// Residuals at some samples, and their derivatives.
struct Linearised {
  std::vector<double> residual;
  std::vector<double> derivatives;          // a column of all samples for each parameter
  std::shared_ptr<const FlightSamples> at;  // where the derivatives were taken

  double derivative(std::size_t parameter, std::size_t k) const {
    return derivatives[parameter * residual.size() + k];
  }
};

Linearised linearised(const Residuals& residuals, const std::shared_ptr<const FlightSamples>& samples,
                      const ModelFile& model, const Reference& reference, const MaskOptions& mask,
                      const std::vector<std::size_t>& used, const std::vector<std::size_t>& wanted) {
  Linearised result{std::vector<double>(used.size()), std::vector<double>(wanted.size() * used.size()),
                    samples};
  const double* const start = residuals.parameters().data();
  auto predicted = residuals.predicted_sensor(start);
  if (auto common = residuals.at_common_pressures()) {
    // Where the derivatives of one effect on both systems are exactly opposite.
    residuals.evaluate(used.data(), used.size(), start, {}, result.residual.data(), nullptr);
    result.at = std::move(common);
    std::vector<double> nothing(used.size());
    Residuals(result.at, model, reference, mask)
        .evaluate(used.data(), used.size(), start, wanted, nothing.data(), result.derivatives.data());
    return result;
  }
  if (!predicted) {
    residuals.evaluate(used.data(), used.size(), start, wanted, result.residual.data(),
                       result.derivatives.data());
    return result;
  }
  // No column holds the noise of the reference's sensor: derivatives are taken where it shows what the model
  // says.
  residuals.evaluate_at_sensor(used.data(), used.size(), start, {}, result.residual.data(), nullptr);
  auto noiseless = std::make_shared<FlightSamples>(*samples);
  for (auto& [quantity, values] : noiseless->model.columns) {
    if (quantity == predicted->first) values = std::move(predicted->second);
  }
  result.at = std::move(noiseless);
  std::vector<double> nothing(used.size());
  Residuals(result.at, model, reference, mask)
      .evaluate_at_sensor(used.data(), used.size(), start, wanted, nothing.data(), result.derivatives.data());
  return result;
}

/// Gives the few places without a value that of the one before (of the one after at the begin); many stay.
void bridge(Eigen::Ref<Eigen::VectorXf> column, const std::vector<std::size_t>& used) {
  constexpr double most = 0.1;  // part of the samples
  std::size_t missing = 0;
  for (const std::size_t i : used) missing += std::isfinite(column[as_index(i)]) ? 0 : 1;
  if (missing == 0 || static_cast<double>(missing) > most * static_cast<double>(used.size())) return;
  const auto first = std::find_if(used.begin(), used.end(),
                                  [&](std::size_t i) { return std::isfinite(column[as_index(i)]); });
  float last = column[as_index(*first)];
  for (const std::size_t i : used) {
    if (std::isfinite(column[as_index(i)])) last = column[as_index(i)];
    column[as_index(i)] = last;
  }
}

/// The samples used, and those between them that are not because flaps are out.
std::vector<std::size_t> with_flaps_out(const std::vector<Mask>& masks,
                                        const std::vector<std::size_t>& used) {
  if (used.empty()) return used;
  const bool all = used.size() == used_samples(masks).size();
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < (all ? masks.size() : used.back() + 1); ++i) {
    if (masks[i] == Mask::none || masks[i] == Mask::flaps) result.push_back(i);
  }
  return result;
}

/// The samples and those that are at most `reach` before or after one of them, of `size`.
std::vector<std::size_t> with_neighbours(const std::vector<std::size_t>& samples, std::size_t reach,
                                         std::size_t size) {
  std::vector<std::size_t> result;
  for (const std::size_t sample : samples) {
    const std::size_t first = sample - std::min(sample, reach);
    for (std::size_t i = result.empty() ? first : std::max(first, result.back() + 1);
         i < std::min(sample + reach + 1, size); ++i)
      result.push_back(i);
  }
  return result;
}

/// Takes out the samples that are made of neighbours which are not to be used.
void mask_by_neighbours(std::vector<Mask>& masks, std::size_t reach) {
  std::vector<std::size_t> spoiled;
  for (std::size_t i = 0; i < masks.size(); ++i) {
    // Where the residual alone is missing, what it is made of is there.
    if (masks[i] != Mask::none && masks[i] != Mask::reference) spoiled.push_back(i);
  }
  for (const std::size_t i : with_neighbours(spoiled, reach, masks.size())) {
    if (masks[i] == Mask::none) masks[i] = Mask::reference;
  }
}

/// The places of the candidates of one system.
std::vector<Where> places_of(const CandidateSet& set, bool of_reference) {
  std::vector<Where> places;
  for (const Candidate& candidate : set.candidates) {
    if (candidate.is_of_reference() != of_reference) continue;
    const Where where = where_of(candidate.effect);
    if (std::find(places.begin(), places.end(), where) == places.end()) places.push_back(where);
  }
  return places;
}

/// The value of the candidates of one system at a sample, through its chain.
class CandidateValues {
 public:
  CandidateValues(const Model& model, const ModelSamples& samples, const std::string& name,
                  std::vector<Evaluation> evaluations)
      : chain_(built(model, samples.roles, name)), evaluations_(std::move(evaluations)) {
    for (const Quantity input : chain_.inputs()) inputs_.emplace_back(input, samples.find(input)->data());
  }

  /// Puts the columns of a sample. @param derivative of the residual by what is added at a place
  template <class Derivative>
  void put(std::size_t sample, const Derivative& derivative, State<double>& state,
           Eigen::MatrixXf& columns) const {
    NoQualityFlags flags;
    for (const auto& [quantity, series] : inputs_) state[quantity] = series[sample];
    chain_.measure(state, chain_.parameters().data(), flags);
    for (const Evaluation& each : evaluations_) {
      const Quantity remembered = each.remembered != nullptr ? each.remembered->quantity : Quantity::count;
      const double usual = remembered != Quantity::count ? state[remembered] : 0.0;
      if (remembered != Quantity::count) state[remembered] = each.remembered->values[sample];
      const Jet value = chain_.effect_value(each.effect, state, each.parameters.data());
      if (remembered != Quantity::count) state[remembered] = usual;
      const double at_place = derivative(each.place);
      for (std::size_t p = 0; p < each.width; ++p)
        columns(as_index(sample), as_index(each.first_column + p)) =
            static_cast<float>(-at_place * value.v[as_index(p)]);
    }
  }

 private:
  static Chain built(const Model& model, const std::vector<Quantity>& roles, const std::string& name) {
    BindingError why;
    std::optional<Chain> chain = Chain::build(model, roles, &why);
    if (!chain) throw Error(Error::Code::model, fmt::format("{}: {}", name, why.message()));
    return std::move(*chain);
  }

  Chain chain_;
  std::vector<Evaluation> evaluations_;
  std::vector<std::pair<Quantity, const double*>> inputs_;
};

/// Makes of columns with what each coefficient adds at its place, sample by sample, those of residuals that
/// are made of their neighbours. @param first_place among the parameters of the residuals
void sum_over_neighbours(const Residuals& residuals, const std::vector<Evaluation>& evaluations,
                         std::size_t first_place, const std::vector<std::size_t>& used,
                         const std::vector<std::size_t>& needed, Eigen::MatrixXf& columns) {
  std::vector<Direction> directions;
  std::vector<Eigen::Index> numbers;
  for (const Evaluation& each : evaluations) {
    for (std::size_t p = 0; p < each.width; ++p) {
      const Eigen::Index number = numbers.emplace_back(as_index(each.first_column + p));
      auto column = columns.col(number);
      bridge(column, needed);
      Direction& direction = directions.emplace_back();
      direction.parameter = first_place + each.place;
      direction.rate.assign(residuals.size(), 0.0);
      for (const std::size_t i : needed) direction.rate[i] = static_cast<double>(column[as_index(i)]);
      column.setZero();
    }
  }
  std::vector<double> derivatives(directions.size() * used.size());
  residuals.differentiate_along(used.data(), used.size(), residuals.parameters().data(), directions,
                                derivatives.data());
  for (std::size_t c = 0; c < numbers.size(); ++c) {
    for (std::size_t k = 0; k < used.size(); ++k)
      columns(as_index(used[k]), numbers[c]) = static_cast<float>(derivatives[c * used.size() + k]);
  }
}

}  // namespace

const std::vector<double>& FlightColumns::quantity(Quantity wanted) const {
  static const std::vector<double> none;
  const auto found = std::find_if(quantities.begin(), quantities.end(),
                                  [wanted](const auto& each) { return each.first == wanted; });
  return found == quantities.end() ? none : found->second;
}

Eigen::MatrixXd binned_columns(const FlightColumns& flight, const Binning& bins) {
  const Eigen::Index base = flight.base.cols();
  Eigen::MatrixXd columns(as_index(bins.size()), base + flight.candidates.cols());
  for (Eigen::Index c = 0; c < base; ++c) columns.col(c) = bins.means(flight.base.col(c));
  for (Eigen::Index c = 0; c < flight.candidates.cols(); ++c)
    columns.col(base + c) = bins.means(flight.candidates.col(c));
  return columns;
}

FlightColumns outline_of(const FlightColumns& flight) {
  FlightColumns outline;
  outline.file = flight.file;
  outline.reference = flight.reference;
  outline.window = flight.window;
  auto samples = std::make_shared<FlightSamples>();
  samples->name = flight.samples->name;
  samples->flaps_variable = flight.samples->flaps_variable;
  samples->notes = flight.samples->notes;
  outline.samples = std::move(samples);
  outline.base.resize(0, flight.base.cols());
  outline.candidates.resize(0, flight.candidates.cols());
  for (const auto& each : flight.quantities)
    outline.quantities.emplace_back(each.first, std::vector<double>());
  return outline;
}

FlightColumns find_columns(const std::shared_ptr<const FlightSamples>& extended, const ModelFile& model,
                           const CandidateSet& set, std::size_t reference, const MaskOptions& mask,
                           double first_part) {
  const std::size_t records = extended->time.size();
  const std::vector<Where> places = places_of(set, false);
  ModelFile with_additions = model;
  with_additions.model.additions = places;
  // The other system, with what may be added there.
  std::shared_ptr<const Reference> held_against = set.references[reference];
  std::vector<Where> other_places;
  std::vector<std::size_t> other_free;
  std::size_t other_count = 0;
  if (set.others[reference]) {
    other_places = places_of(set, true);
    ModelFile other = *set.others[reference];
    other.model.effects.resize(set.effects_of_others[reference]);
    other.model.additions = other_places;
    other_free = free_parameters(other);
    for (const ModelEffect& effect : other.model.effects) other_count += effect.parameters.size();
    held_against = held_against->with_model(other);
  }
  const Residuals residuals(extended, with_additions, *held_against, mask);
  const std::vector<double>& start = residuals.parameters();

  FlightColumns columns;
  columns.reference = reference;
  columns.window = held_against->window();
  columns.samples = extended;
  columns.mask = residuals.mask();
  columns.exact = residuals.values(start.data());
  const bool of_neighbours = residuals.reach() > 0;
  if (of_neighbours) mask_by_neighbours(columns.mask, residuals.reach());
  std::vector<std::size_t> used = used_samples(columns.mask, first_part);
  if (!of_neighbours) used = with_flaps_out(columns.mask, used);
  std::vector<std::size_t> wanted = free_parameters(model);
  const std::size_t base_count = wanted.size();
  std::size_t own_count = 0;
  for (const ModelEffect& effect : model.model.effects) own_count += effect.parameters.size();
  const std::size_t first_place = own_count;
  for (std::size_t k = 0; k < places.size() && !of_neighbours; ++k) wanted.push_back(first_place + k);
  own_count += places.size();
  const std::size_t other_begin = wanted.size();
  for (const std::size_t parameter : other_free) wanted.push_back(own_count + parameter);
  for (std::size_t k = 0; k < other_places.size(); ++k) wanted.push_back(own_count + other_count + k);
  const Linearised found = linearised(residuals, extended, with_additions, *held_against, mask, used, wanted);
  columns.given.assign(records, nan);
  columns.flaps_out.assign(records, nan);
  for (std::size_t k = 0; k < used.size(); ++k)
    (columns.mask[used[k]] == Mask::none ? columns.given : columns.flaps_out)[used[k]] = found.residual[k];
  columns.residual = columns.given;
  columns.base.setZero(as_index(records), as_index(set.base.size()));
  const auto put_base = [&](std::size_t first, std::size_t from, std::size_t count) {
    for (std::size_t c = 0; c < count; ++c) {
      for (std::size_t k = 0; k < used.size(); ++k)
        columns.base(as_index(used[k]), as_index(first + c)) =
            static_cast<float>(-found.derivative(from + c, k));
    }
  };
  put_base(0, 0, base_count);
  put_base(set.base_of_others[reference], other_begin, other_free.size());

  const std::array<Quantity, 6> measured{Quantity::attack,
                                         Quantity::sideslip,
                                         Quantity::static_pressure_rate,
                                         Quantity::dynamic_pressure_rate,
                                         Quantity::normal_acceleration,
                                         Quantity::roll};
  for (const Quantity quantity : measured)
    columns.quantities.emplace_back(quantity, std::vector<double>(records, nan));
  columns.candidates.setZero(as_index(records), as_index(column_count(set)));
  const std::vector<Remembered> remembered = remembered_by(set, *extended);
  const std::vector<Evaluation> evaluations = evaluations_of(set, reference, false, places, remembered);
  const CandidateValues own(set.extended.model, found.at->model, extended->name, evaluations);
  std::optional<CandidateValues> others;
  if (set.others[reference])
    others.emplace(set.others[reference]->model, found.at->reference, extended->name,
                   evaluations_of(set, reference, true, other_places, {}));
  const std::vector<std::size_t> needed = with_neighbours(used, residuals.reach(), records);
  for (std::size_t k = 0; k < needed.size(); ++k) {
    const std::size_t sample = needed[k];
    State<double> state;
    own.put(
        sample,
        [&](std::size_t place) { return of_neighbours ? 1.0 : found.derivative(base_count + place, k); },
        state, columns.candidates);
    for (std::size_t q = 0; q < measured.size(); ++q)
      columns.quantities[q].second[sample] = state[measured[q]];
    if (!others) continue;
    State<double> other_state;
    others->put(
        sample,
        [&](std::size_t place) { return found.derivative(other_begin + other_free.size() + place, k); },
        other_state, columns.candidates);
  }
  if (of_neighbours)
    sum_over_neighbours(residuals, evaluations, first_place, used, needed, columns.candidates);
  Eigen::Index column = 0;
  Eigen::Index source = 0;  // of what both systems share, on the own one
  for (const Candidate& candidate : set.candidates) {
    if (!candidate.is_shared) source = column;
    for (Eigen::Index c = 0; c < as_index(candidate.tested.size()); ++c, ++column) {
      if (candidate.is_shared && !set.others[reference])
        columns.candidates.col(column) = columns.candidates.col(source + c);
      else if (!candidate.is_shared)
        bridge(columns.candidates.col(column), used);
    }
  }

  columns.quantities.emplace_back(Quantity::corrected_mach,
                                  residuals.quantity(Quantity::corrected_mach, start.data()));
  columns.quantities.emplace_back(Quantity::ambient_temperature,
                                  residuals.quantity(Quantity::ambient_temperature, start.data()));
  columns.corrected_pressure = residuals.quantity(Quantity::corrected_static_pressure, start.data());
  return columns;
}

}  // namespace pcor::internal
