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

namespace pcor::internal {
namespace {

constexpr int jet_width = 3;
using Jet = ceres::Jet<double, jet_width>;

Where where_of(const ModelEffect& effect) {
  return effect.is_formula() ? effect.where : effect_facts[effect_named(effect.id)].where;
}

std::vector<std::size_t> free_parameters(const ModelFile& model) {
  std::vector<std::size_t> free;
  std::size_t number = 0;
  for (std::size_t e = 0; e < model.model.effects.size(); ++e) {
    for (std::size_t p = 0; p < model.model.effects[e].parameters.size(); ++p, ++number) {
      if (!model.fit(e, p).fixed) free.push_back(number);
    }
  }
  return free;
}

/// One evaluation of a candidate: its derivatives by some of the tested parameters.
struct Evaluation {
  std::size_t effect;        // number in the extended model
  std::size_t place;         // among the places of all candidates
  std::size_t first_column;  // of the parameters
  std::size_t width;
  std::vector<Jet> parameters;
};

std::vector<Evaluation> evaluations_of(const CandidateSet& set, const std::vector<Where>& places) {
  std::vector<Evaluation> evaluations;
  std::size_t column = 0;
  for (const Candidate& candidate : set.candidates) {
    const auto place = std::find(places.begin(), places.end(), where_of(candidate.effect)) - places.begin();
    const std::vector<double>& neutral = candidate.effect.parameters;
    for (std::size_t first = 0; first < candidate.tested.size(); first += jet_width) {
      const std::size_t width = std::min<std::size_t>(jet_width, candidate.tested.size() - first);
      std::vector<Jet> parameters(neutral.begin(), neutral.end());
      for (std::size_t k = 0; k < width; ++k)
        parameters[candidate.tested[first + k].place].v[as_index(k)] = 1.0;
      evaluations.push_back(
          {candidate.number, static_cast<std::size_t>(place), column, width, std::move(parameters)});
      column += width;
    }
  }
  return evaluations;
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

std::vector<Where> places_of(const CandidateSet& set) {
  std::vector<Where> places;
  for (const Candidate& candidate : set.candidates) {
    const Where where = where_of(candidate.effect);
    if (std::find(places.begin(), places.end(), where) == places.end()) places.push_back(where);
  }
  return places;
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

std::vector<std::string> base_names(const ModelFile& model) {
  const std::vector<std::string> all = residual_parameter_names(model, *lams_reference());
  std::vector<std::string> names;
  for (const std::size_t parameter : free_parameters(model)) names.push_back(all[parameter]);
  return names;
}

FlightColumns find_columns(std::shared_ptr<const FlightSamples> extended, const ModelFile& model,
                           const CandidateSet& set, const Reference& reference, const MaskOptions& mask,
                           double first_part) {
  const std::size_t records = extended->time.size();
  const std::vector<Where> places = places_of(set);
  ModelFile with_additions = model;
  with_additions.model.additions = places;
  const Residuals residuals(extended, with_additions, reference, mask);
  const std::vector<double>& start = residuals.parameters();

  FlightColumns columns;
  columns.samples = extended;
  columns.mask = residuals.mask();
  columns.exact = residuals.values(start.data());
  const std::vector<std::size_t> used = with_flaps_out(columns.mask, used_samples(columns.mask, first_part));
  std::vector<std::size_t> wanted = free_parameters(model);
  const std::size_t base_count = wanted.size();
  std::size_t own_count = 0;
  for (const ModelEffect& effect : model.model.effects) own_count += effect.parameters.size();
  for (std::size_t k = 0; k < places.size(); ++k) wanted.push_back(own_count + k);
  const Linearised found = linearised(residuals, extended, with_additions, reference, mask, used, wanted);
  columns.given.assign(records, nan);
  columns.flaps_out.assign(records, nan);
  for (std::size_t k = 0; k < used.size(); ++k)
    (columns.mask[used[k]] == Mask::none ? columns.given : columns.flaps_out)[used[k]] = found.residual[k];
  columns.residual = columns.given;
  columns.base.setZero(as_index(records), as_index(base_count));
  for (std::size_t c = 0; c < base_count; ++c) {
    for (std::size_t k = 0; k < used.size(); ++k)
      columns.base(as_index(used[k]), as_index(c)) = static_cast<float>(-found.derivative(c, k));
  }

  BindingError why;
  const std::optional<Chain> chain = Chain::build(set.extended.model, extended->model.roles, &why);
  if (!chain) throw Error(Error::Code::model, fmt::format("{}: {}", extended->name, why.message()));
  std::vector<std::pair<Quantity, const double*>> inputs;
  for (const Quantity input : chain->inputs())
    inputs.emplace_back(input, found.at->model.find(input)->data());
  const std::array<Quantity, 6> measured{Quantity::attack,
                                         Quantity::sideslip,
                                         Quantity::static_pressure_rate,
                                         Quantity::dynamic_pressure_rate,
                                         Quantity::normal_acceleration,
                                         Quantity::roll};
  for (const Quantity quantity : measured)
    columns.quantities.emplace_back(quantity, std::vector<double>(records, nan));
  const std::vector<Evaluation> evaluations = evaluations_of(set, places);
  const std::size_t column_count =
      evaluations.empty() ? 0 : evaluations.back().first_column + evaluations.back().width;
  columns.candidates.setZero(as_index(records), as_index(column_count));
  for (std::size_t k = 0; k < used.size(); ++k) {
    const std::size_t sample = used[k];
    State<double> state;
    NoQualityFlags flags;
    for (const auto& [quantity, series] : inputs) state[quantity] = series[sample];
    chain->measure(state, chain->parameters().data(), flags);
    for (const Evaluation& each : evaluations) {
      const Jet value = chain->effect_value(each.effect, state, each.parameters.data());
      const double at_place = found.derivative(base_count + each.place, k);
      for (std::size_t p = 0; p < each.width; ++p)
        columns.candidates(as_index(sample), as_index(each.first_column + p)) =
            static_cast<float>(-at_place * value.v[as_index(p)]);
    }
    for (std::size_t q = 0; q < measured.size(); ++q)
      columns.quantities[q].second[sample] = state[measured[q]];
  }
  for (Eigen::Index c = 0; c < columns.candidates.cols(); ++c) bridge(columns.candidates.col(c), used);

  columns.quantities.emplace_back(Quantity::corrected_mach,
                                  residuals.quantity(Quantity::corrected_mach, start.data()));
  columns.quantities.emplace_back(Quantity::ambient_temperature,
                                  residuals.quantity(Quantity::ambient_temperature, start.data()));
  columns.corrected_pressure = residuals.quantity(Quantity::corrected_static_pressure, start.data());
  return columns;
}

}  // namespace pcor::internal
