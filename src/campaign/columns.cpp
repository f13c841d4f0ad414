#include "campaign/columns.hpp"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <pcor/effects/catalogue.hpp>
#include <pcor/physics/constants.hpp>
#include <pcor/realtime/chain.hpp>
#include "campaign/linear_rows.hpp"
#include "campaign/model_parameters.hpp"
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"
#include "parallel/serialization.hpp"
#include "residuals/parameter_dependent_columns.hpp"
#include "residuals/serialization.hpp"
#include "roles/model_inputs.hpp"

namespace pcor::internal {
namespace {

constexpr int effect_jet_width = 3;
using EffectJet = ceres::Jet<double, effect_jet_width>;

/// Evaluation of a candidate: its derivatives with respect to some of the tested parameters.
struct Evaluation {
  std::size_t effect;            // number in the extended model of its system
  Eigen::Index location = 0;     // index among the locations of all candidates
  std::size_t first_column = 0;  // first column of the parameters
  std::size_t width = 0;
  std::vector<EffectJet> parameters{};
  Quantity memory = Quantity::count;  // history input of the candidate,
  std::vector<double> history{};      // replaces the column of the samples; empty if unknown
};

/// System in a residual, and the indices of its parameters among the parameters of the residual: parameters
/// of its effects, then one for each location at which candidates act.
struct System {
  ModelDefinition model{};
  std::vector<std::size_t> free{};
  std::size_t first_location = 0;
  std::size_t end = 0;  // after the last location

  const std::vector<EffectLocation>& locations() const { return model.model.additions; }
};

/// Evaluations of the candidates of one system.
std::vector<Evaluation> evaluations_of(const CandidateModels& set, std::size_t reference, bool of_reference,
                                       const std::vector<EffectLocation>& locations,
                                       const ModelSamples& inputs, const FlightSamples& samples) {
  std::vector<Evaluation> evaluations;
  for (std::size_t c = 0; c < set.candidates.size(); ++c) {
    const Candidate& candidate = set.candidates[c];
    if (candidate.is_of_reference() != of_reference || candidate.is_shared) continue;
    const std::optional<std::size_t> number =
        of_reference ? candidate.numbers_in_others[reference] : candidate.number;
    if (!number) continue;
    Evaluation evaluation{*number};
    const auto location = std::find(locations.begin(), locations.end(), location_of(candidate.effect));
    evaluation.location = location - locations.begin();
    if (candidate.memory != 0.0) {  // the history starts from the samples' inputs
      evaluation.memory = memory_of(candidate.effect).of;
      evaluation.history =
          history_input(evaluation.memory, inputs, samples.time, samples.step, candidate.memory);
    }
    const std::vector<double>& neutral = candidate.effect.parameters;
    for (std::size_t first = 0; first < candidate.tested.size(); first += effect_jet_width) {
      evaluation.first_column = set.first_column(c) + first;
      evaluation.width = std::min<std::size_t>(effect_jet_width, candidate.tested.size() - first);
      evaluation.parameters = std::vector<EffectJet>(neutral.begin(), neutral.end());
      for (std::size_t k = 0; k < evaluation.width; ++k)
        evaluation.parameters[candidate.tested[first + k].index].v[as_index(k)] = 1.0;
      evaluations.push_back(evaluation);
    }
  }
  return evaluations;
}

/// Fills a few missing values with the previous value (at the beginning the next one); longer gaps remain.
void bridge(Eigen::Ref<Eigen::VectorXf> column, const std::vector<std::size_t>& used) {
  constexpr double maximum = 0.1;  // maximum fraction of the samples
  std::size_t missing = 0;
  for (const std::size_t i : used) missing += std::isfinite(column[as_index(i)]) ? 0 : 1;
  if (missing == 0 || static_cast<double>(missing) > maximum * static_cast<double>(used.size())) return;
  const auto first = std::find_if(used.begin(), used.end(),
                                  [&](std::size_t i) { return std::isfinite(column[as_index(i)]); });
  float last = column[as_index(*first)];
  for (const std::size_t i : used) {
    if (std::isfinite(column[as_index(i)])) last = column[as_index(i)];
    column[as_index(i)] = last;
  }
}

/// Used samples, and the samples between them that are excluded because of the flaps.
std::vector<std::size_t> with_flaps_out(const LinearRows& rows) {
  if (rows.used().empty()) return {};
  const std::size_t end = rows.held_out().empty() ? rows.mask().size() : rows.used().back() + 1;
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < end; ++i) {
    if (rows.mask()[i] == Mask::none || rows.mask()[i] == Mask::flaps) result.push_back(i);
  }
  return result;
}

/// The samples and their neighbours up to `half_width` before or after, limited to `size`.
std::vector<std::size_t> with_neighbours(const std::vector<std::size_t>& samples, std::size_t half_width,
                                         std::size_t size) {
  std::vector<std::size_t> result;
  for (const std::size_t sample : samples) {
    const std::size_t first = sample - std::min(sample, half_width);
    for (std::size_t i = result.empty() ? first : std::max(first, result.back() + 1);
         i < std::min(sample + half_width + 1, size); ++i)
      result.push_back(i);
  }
  return result;
}

/// Locations of the candidates of one system.
std::vector<EffectLocation> locations_of(const CandidateModels& set, bool of_reference) {
  std::vector<EffectLocation> locations;
  for (const Candidate& candidate : set.candidates) {
    if (candidate.is_of_reference() != of_reference) continue;
    const EffectLocation location = location_of(candidate.effect);
    if (std::find(locations.begin(), locations.end(), location) == locations.end())
      locations.push_back(location);
  }
  return locations;
}

System system_of(ModelDefinition model, const CandidateModels& set, bool of_reference, std::size_t first) {
  System system{std::move(model)};
  system.model.model.additions = locations_of(set, of_reference);
  for (const std::size_t parameter : free_parameters(system.model)) system.free.push_back(first + parameter);
  system.end = first + parameter_count(system.model.model);
  system.first_location = system.end - system.locations().size();
  return system;
}

/// Computes the columns of the candidates of one system at some samples: the amount that each coefficient
/// adds at its location, through the chain of the system.
/// @param by_location for each location the derivative of the residual with respect to an amount added there,
/// at these samples; if empty, the columns are the added amounts with the sign inverted. Where it is zero,
/// the columns are zero, even if an input has no value
/// @param quantities receive their values at these samples
void put_candidates(const Chain& chain, const ModelSamples& inputs,
                    const std::vector<Evaluation>& evaluations, const std::vector<std::size_t>& samples,
                    const Eigen::Ref<const Eigen::MatrixXd>& by_location,
                    std::vector<std::pair<Quantity, std::vector<double>>>& quantities,
                    Eigen::MatrixXf& columns) {
  std::vector<std::pair<Quantity, const double*>> read;
  for (const Quantity input : chain.inputs()) read.emplace_back(input, inputs.find(input)->data());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const std::size_t sample = samples[k];
    State<double> state;
    NoQualityFlags flags;
    for (const auto& [quantity, series] : read) state[quantity] = series[sample];
    chain.correct_inputs(state, chain.parameters().data(), flags);
    for (const Evaluation& each : evaluations) {
      const bool has_history = !each.history.empty();
      const double of_model = has_history ? state[each.memory] : 0.0;
      if (has_history) state[each.memory] = each.history[sample];
      const EffectJet value = chain.effect_value(each.effect, state, each.parameters.data());
      if (has_history) state[each.memory] = of_model;
      const double by_this_location = by_location.cols() == 0 ? 1.0 : by_location(as_index(k), each.location);
      for (std::size_t p = 0; p < each.width; ++p)
        columns(as_index(sample), as_index(each.first_column + p)) =
            by_this_location == 0.0 ? 0.0F : static_cast<float>(-by_this_location * value.v[as_index(p)]);
    }
    for (auto& [quantity, values] : quantities) values[sample] = state[quantity];
  }
}

/// Converts columns of added amounts, sample by sample, to columns of residuals that depend on neighbouring
/// samples. @param first_location among the parameters of the residuals
void sum_over_neighbours(const Residuals& residuals, const std::vector<Evaluation>& evaluations,
                         std::size_t first_location, const std::vector<std::size_t>& used,
                         const std::vector<std::size_t>& needed, Eigen::MatrixXf& columns) {
  std::vector<Direction> directions;
  std::vector<Eigen::Index> numbers;
  for (const Evaluation& each : evaluations) {
    for (std::size_t p = 0; p < each.width; ++p) {
      const Eigen::Index number = numbers.emplace_back(as_index(each.first_column + p));
      auto column = columns.col(number);
      bridge(column, needed);
      Direction& direction = directions.emplace_back();
      direction.parameter = first_location + static_cast<std::size_t>(each.location);
      direction.rate.assign(residuals.size(), 0.0);
      for (const std::size_t i : needed) direction.rate[i] = static_cast<double>(column[as_index(i)]);
      column.setZero();
    }
  }
  Eigen::MatrixXd derivatives = Eigen::MatrixXd::Zero(as_index(used.size()), as_index(numbers.size()));
  residuals.differentiate_along(used, residuals.parameters().data(), directions, derivatives.data());
  columns(used, numbers) = derivatives.cast<float>();
}

/// Systems of a residual, the model's system first.
std::vector<System> systems_of(const ModelDefinition& model, const CandidateModels& set,
                               std::size_t reference) {
  std::vector<System> systems{system_of(model, set, false, 0)};
  if (!set.others[reference]) return systems;
  ModelDefinition other = *set.others[reference];
  other.model.effects.resize(set.effects_of_others[reference]);
  systems.push_back(system_of(std::move(other), set, true, systems.front().end));
  return systems;
}

/// Adds the columns of candidates on both systems if the residual depends on one system only, and fills short
/// gaps of the others.
void complete(const CandidateModels& set, bool two_systems, const std::vector<std::size_t>& used,
              Eigen::MatrixXf& columns) {
  Eigen::Index column = 0;
  Eigen::Index source = 0;  // column of a common-mode effect, on the model's system
  for (const Candidate& candidate : set.candidates) {
    if (!candidate.is_shared) source = column;
    for (Eigen::Index c = 0; c < as_index(candidate.tested.size()); ++c, ++column) {
      if (candidate.is_shared && !two_systems)
        columns.col(column) = columns.col(source + c);
      else if (!candidate.is_shared)
        bridge(columns.col(column), used);
    }
  }
}

/// Amounts that the candidates on the model's system add at its locations, per unit of each coefficient.
EffectAmounts effects_of(const CandidateModels& set, std::size_t reference, const System& system,
                         const FlightSamples& samples, const std::vector<std::size_t>& used) {
  EffectAmounts effects;
  for (std::size_t location = system.first_location; location < system.end; ++location)
    effects.amounts_of_model.push_back(location);
  effects.at.resize(set.first_column(set.candidates.size()), 0);
  for (const Evaluation& each :
       evaluations_of(set, reference, false, system.locations(), samples.model, samples)) {
    for (std::size_t p = 0; p < each.width; ++p)
      effects.at[each.first_column + p] = static_cast<std::size_t>(each.location);
  }
  effects.amounts = [&, reference,
                     columns = as_index(effects.at.size())](const ModelSamples& inputs) -> Eigen::MatrixXd {
    std::vector<std::size_t> all(samples.time.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::vector<std::pair<Quantity, std::vector<double>>> no_quantities;
    Eigen::MatrixXf added = Eigen::MatrixXf::Zero(as_index(all.size()), columns);
    put_candidates(chain_of(set.extended.model, inputs.roles), inputs,
                   evaluations_of(set, reference, false, system.locations(), inputs, samples), all,
                   Eigen::MatrixXd(), no_quantities, added);
    complete(set, false, used, added);
    return -added.unaryExpr([](float amount) { return std::isfinite(amount) ? amount : 0.0F; })
                .cast<double>();
  };
  return effects;
}

/// Columns of wind in hPa: the change of the airspeed, without gusts, in units of that by the static
/// pressure.
/// @param model_columns number of coefficients of the model
void put_wind_columns(const GpsRows& rows, const std::vector<std::size_t>& used, Eigen::Index model_columns,
                      FlightColumns& columns) {
  const Eigen::Index size = as_index(rows.time.size());
  for (const std::size_t i : used) {
    const Eigen::Index row = as_index(i);
    if (std::isnan(rows.rows(row, 0))) continue;
    // dV = -R T / (p V) dp, the equation of Bernoulli
    const double per_speed = -rows.airspeed[i] / (constants::standard_gravity * rows.thickness[i]);
    const Eigen::RowVectorXf along =
        (per_speed * (rows.east[i] * rows.rows.row(row) + rows.north[i] * rows.rows.row(size + row)))
            .cast<float>();
    columns.base.row(row).head(model_columns) = along.head(model_columns);
    for (Eigen::Index c = 0; c < columns.candidates.cols(); ++c) {
      float& value = columns.candidates(row, c);
      if (std::isfinite(value)) value = along[model_columns + c];
    }
  }
}

/// The whitened rows of a flight against wind or height, and the columns of wind in hPa.
void put_gps(GpsKind kind, const CandidateModels& set, const System& system, const LinearRows& rows,
             FlightColumns& columns) {
  const FlightSamples& samples = *columns.samples;
  const EffectAmounts effects = effects_of(set, columns.reference, system, samples, rows.used());
  const auto rows_at = [&](double warmer) {
    return gps_rows(kind, samples, system.model, rows.used(), rows.residuals().parameters().data(),
                    system.free, effects, warmer);
  };
  const GpsRows found = rows_at(0.0);
  const Eigen::Index free = as_index(system.free.size());
  std::vector<double> typical_sizes;
  for (std::size_t k = 0; k < system.free.size(); ++k) typical_sizes.push_back(set.base[k].typical);
  columns.is_by_gps = true;
  if (kind == GpsKind::wind) put_wind_columns(found, rows.used(), free, columns);
  if (found.defect.rows() == 0) return;
  columns.gps = gps_system(found, typical_sizes);
  if (columns.gps.rows.size() == 0) return;
  if (kind == GpsKind::height)
    columns.gps = gps_system(rows_at(thermometer_of(columns.gps, typical_sizes)), typical_sizes);
  // The coefficients of other systems do not change a comparison with GPS.
  const Eigen::MatrixXf rows_of_gps = std::move(columns.gps.rows);
  const Eigen::Index others = columns.base.cols() - free;
  columns.gps.rows = Eigen::MatrixXf::Zero(rows_of_gps.rows(), rows_of_gps.cols() + others);
  columns.gps.rows.leftCols(free) = rows_of_gps.leftCols(free);
  columns.gps.rows.rightCols(rows_of_gps.cols() - free) = rows_of_gps.rightCols(rows_of_gps.cols() - free);
}

/// Base and candidate columns of a flight, in bins.
Eigen::MatrixXd binned_columns(const FlightColumns& flight, const Binning& bins) {
  Eigen::MatrixXd columns(as_index(bins.size()), flight.base.cols() + flight.candidates.cols());
  Eigen::Index next = 0;
  for (const Eigen::MatrixXf* const all : {&flight.base, &flight.candidates}) {
    for (const auto column : all->colwise()) columns.col(next++) = bins.means(column);
  }
  return columns;
}

}  // namespace

const std::vector<double>& FlightColumns::quantity(Quantity requested) const {
  static const std::vector<double> none;
  const auto found = std::find_if(quantities.begin(), quantities.end(),
                                  [requested](const auto& each) { return each.first == requested; });
  return found == quantities.end() ? none : found->second;
}

void FlightColumns::keep_base(const std::vector<Eigen::Index>& kept) {
  gps.keep(kept, 0, base.cols());
  base = Eigen::MatrixXf(base(Eigen::all, kept));
}

void FlightColumns::keep_candidates(const std::vector<Eigen::Index>& kept) {
  gps.keep(kept, base.cols(), candidates.cols());
  candidates = Eigen::MatrixXf(candidates(Eigen::all, kept));
}

namespace {

template <class Archive, class Columns>
void archive_members(Archive& archive, Columns& columns) {
  archive(columns.file, columns.reference, columns.window, columns.samples, columns.mask, columns.given,
          columns.residual, columns.exact, columns.flaps_out, columns.base, columns.candidates,
          columns.is_by_gps, columns.gps, columns.quantities, columns.corrected_pressure);
}

}  // namespace

void save(cereal::BinaryOutputArchive& archive, const FlightColumns& columns) {
  archive_members(archive, columns);
}

void load(cereal::BinaryInputArchive& archive, FlightColumns& columns) { archive_members(archive, columns); }

FlightColumns outline_of(const FlightColumns& flight) {
  FlightColumns outline;
  outline.file = flight.file;
  outline.reference = flight.reference;
  outline.window = flight.window;
  outline.is_by_gps = flight.is_by_gps;
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

FlightColumns find_columns(const std::shared_ptr<const FlightSamples>& extended, const ModelDefinition& model,
                           const CandidateModels& set, std::size_t reference, const MaskOptions& mask,
                           double first_part) {
  const std::vector<System> systems = systems_of(model, set, reference);
  const System& model_system = systems.front();
  std::shared_ptr<const Reference> compared_with = set.references[reference];
  if (systems.size() > 1) compared_with = compared_with->with_model(systems.back().model);
  const std::optional<GpsKind> kind = gps_kind(*compared_with);
  const bool is_wind = kind == GpsKind::wind;  // its residuals contain gusts, as their derivatives do
  const LinearRows rows(Residuals(extended, model_system.model, *compared_with, mask), model_system.model,
                        *compared_with, {is_wind ? Inputs::none : Inputs::noise_free, {}, first_part});
  const Residuals& residuals = rows.residuals();
  const double* const start = residuals.parameters().data();
  const bool of_neighbours = residuals.half_width() > 0;
  const std::vector<std::size_t> used = of_neighbours ? rows.used() : with_flaps_out(rows);
  const std::vector<std::size_t> needed =
      is_wind ? used : with_neighbours(used, residuals.half_width(), residuals.size());

  FlightColumns columns;
  columns.reference = reference;
  columns.window = compared_with->window();
  columns.samples = extended;
  columns.mask = rows.mask();
  columns.exact = residuals.values(start);
  std::vector<std::size_t> requested;
  for (const System& system : systems) {
    if (is_wind) continue;
    requested.insert(requested.end(), system.free.begin(), system.free.end());
    for (std::size_t location = system.first_location; location < system.end && !of_neighbours; ++location)
      requested.push_back(location);
  }
  const Eigen::MatrixXd found = rows.evaluate(used, start, requested);
  columns.given.assign(residuals.size(), nan);
  columns.flaps_out = columns.given;
  for (std::size_t k = 0; k < used.size(); ++k) {
    const bool is_in = columns.mask[used[k]] == Mask::none;
    (is_in ? columns.given : columns.flaps_out)[used[k]] = found(as_index(k), found.cols() - 1);
  }
  columns.residual = columns.given;
  columns.base.setZero(as_index(residuals.size()), as_index(set.base.size()));
  columns.candidates.setZero(as_index(residuals.size()), as_index(set.first_column(set.candidates.size())));
  for (const Quantity quantity :
       {Quantity::attack, Quantity::sideslip, Quantity::static_pressure_rate, Quantity::dynamic_pressure_rate,
        Quantity::normal_acceleration, Quantity::roll})
    columns.quantities.emplace_back(quantity, std::vector<double>(residuals.size(), nan));
  std::vector<std::pair<Quantity, std::vector<double>>> no_quantities;
  Eigen::Index next = 0;  // next evaluated column
  for (const System& system : systems) {
    const bool is_of_model = &system == &model_system;
    const Eigen::Index first = is_of_model ? 0 : as_index(set.base_of_others[reference]);
    const Eigen::Index free = is_wind ? 0 : as_index(system.free.size());
    columns.base.middleCols(first, free)(used, Eigen::all) = -found.middleCols(next, free).cast<float>();
    next += free;
    const Eigen::Index locations = of_neighbours ? 0 : as_index(system.locations().size());
    const auto by_location = found.middleCols(next, locations);
    next += locations;
    const ModelSamples& inputs = is_of_model ? rows.inputs().model : rows.inputs().reference;
    const Model& with_all = is_of_model ? set.extended.model : set.others[reference]->model;
    const std::vector<Evaluation> evaluations =
        evaluations_of(set, reference, !is_of_model, system.locations(), extended->model, *extended);
    put_candidates(chain_of(with_all, inputs.roles), inputs, evaluations, needed, by_location,
                   is_of_model ? columns.quantities : no_quantities, columns.candidates);
    if (of_neighbours && !is_wind)
      sum_over_neighbours(residuals, evaluations, system.first_location, used, needed, columns.candidates);
  }
  complete(set, systems.size() > 1, used, columns.candidates);
  if (kind) put_gps(*kind, set, model_system, rows, columns);
  for (const Quantity quantity : {Quantity::corrected_mach, Quantity::ambient_temperature})
    columns.quantities.emplace_back(quantity, residuals.quantity(quantity, start));
  columns.corrected_pressure = residuals.quantity(Quantity::corrected_static_pressure, start);
  return columns;
}

BinnedFlights in_bins(const FlightPartition& partition, const std::vector<FlightColumns>& flights,
                      const std::function<std::vector<double>(std::size_t flight)>& residual_of) {
  BinnedFlights binned;
  binned.bins.resize(flights.size());
  binned.residuals.resize(flights.size());
  binned.outlines = partition.all_gather_flights<NoiseFlight>([&](std::size_t f) {
    const std::vector<double> residual = residual_of(f);
    const Binning& bins = binned.bins[f] = bins_of(*flights[f].samples, flights[f].window, residual);
    binned.residuals[f] = bins.means(residual);
    return NoiseFlight{bins.size() > 0 ? bins.time().front() : 0.0, bins.size()};
  });
  for (std::size_t f = 0; f < flights.size(); ++f) {
    binned.reference.push_back(flights[f].reference);
    binned.columns.push_back(binned_columns(flights[f], binned.bins[f]));
  }
  return binned;
}

}  // namespace pcor::internal
