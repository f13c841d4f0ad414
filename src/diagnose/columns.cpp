#include "diagnose/columns.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <pcor/effects/catalogue.hpp>
#include <pcor/realtime/chain.hpp>
#include <pcor/words/error.hpp>
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int jet_width = 3;
using Jet = ceres::Jet<double, jet_width>;

Where where_of(const ModelEffect& effect) {
  return effect.is_formula() ? effect.where : effect_facts[effect_named(effect.id)].where;
}

/// The samples as the model itself would have read them: without the roles that only candidates need.
FlightSamples without_further_roles(const FlightSamples& samples, const ModelFile& model) {
  FlightSamples own = samples;
  const std::vector<Quantity> roles = model.roles();
  std::vector<Quantity>& given = own.model.roles;
  given.erase(std::remove_if(given.begin(), given.end(),
                             [&roles](Quantity quantity) {
                               return is_role(quantity) &&
                                      std::find(roles.begin(), roles.end(), quantity) == roles.end();
                             }),
              given.end());
  return own;
}

/// The model with a unit of whatever acts at each place: its derivative is what an effect there does to the
/// residual.
ModelFile with_probes(const ModelFile& model, const std::vector<Where>& places) {
  ModelFile probed = model;
  for (const Where place : places) {
    ModelEffect probe;
    probe.id = fmt::format("unit at {}", facts_of(place).name);
    probe.parameters = {0.0};
    probe.parameter_names = {"k"};
    probe.formula = "k";
    probe.where = place;
    probed.model.effects.push_back(std::move(probe));
  }
  return probed;
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

/// A candidate's value at a sample, and its derivatives by the tested parameters.
class CandidateValue {
 public:
  CandidateValue(const Candidate& candidate, const std::vector<std::string>& extra_names)
      : candidate_(&candidate) {
    if (!candidate.effect.is_formula()) {
      function_ = effect_functions<double, Jet>[effect_named(candidate.effect.id)];
      return;
    }
    formula_ = Formula::parse(candidate.effect.formula, candidate.effect.parameter_names);
    for (const std::string& name : formula_->variables()) {
      Quantity quantity = quantity_named(name);
      if (quantity == Quantity::count) {
        const auto found = std::find(extra_names.begin(), extra_names.end(), name);
        quantity = extra_quantity(static_cast<std::size_t>(found - extra_names.begin()));
      }
      variables_.push_back(quantity);
    }
  }

  /// Puts the derivatives, one for each tested parameter, at `out`.
  void derivatives(const State<double>& state, double* out) const {
    const std::vector<CandidateParameter>& tested = candidate_->tested;
    std::vector<Jet> parameters(candidate_->effect.parameters.begin(), candidate_->effect.parameters.end());
    for (std::size_t first = 0; first < tested.size(); first += jet_width) {
      const std::size_t width = std::min<std::size_t>(jet_width, tested.size() - first);
      for (std::size_t k = 0; k < width; ++k) parameters[tested[first + k].place].v[as_index(k)] = 1.0;
      const Jet value = value_of(state, parameters.data());
      for (std::size_t k = 0; k < width; ++k) {
        out[first + k] = value.v[as_index(k)];
        parameters[tested[first + k].place].v[as_index(k)] = 0.0;
      }
    }
  }

 private:
  Jet value_of(const State<double>& state, const Jet* parameters) const {
    if (!formula_) return function_(state, parameters);
    std::vector<double> values;
    values.reserve(variables_.size());
    for (const Quantity variable : variables_) values.push_back(state[variable]);
    return formula_->value(values.data(), parameters);
  }

  const Candidate* candidate_;
  detail::EffectFunction<double, Jet> function_ = nullptr;
  std::optional<Formula> formula_{};
  std::vector<Quantity> variables_{};
};

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

std::vector<std::size_t> used_samples(const std::vector<Mask>& mask, double first_part) {
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i] == Mask::none) used.push_back(i);
  }
  if (first_part < 1.0) {
    used.resize(static_cast<std::size_t>(first_part * static_cast<double>(used.size())));
  }
  return used;
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
  const std::vector<std::string> all = residual_parameter_names(model, Reference{});
  std::vector<std::string> names;
  for (const std::size_t parameter : free_parameters(model)) names.push_back(all[parameter]);
  return names;
}

FlightColumns find_columns(std::shared_ptr<const FlightSamples> extended, const ModelFile& model,
                           const CandidateSet& set, const Reference& reference, const MaskOptions& mask,
                           double first_part) {
  const bool lams = reference.kind == Reference::Kind::lams;
  auto own = std::make_shared<FlightSamples>(without_further_roles(*extended, model));
  const std::size_t records = own->time.size();

  FlightColumns columns;
  columns.samples = extended;
  const Residuals residuals(own, model, reference, mask);
  columns.mask = residuals.mask();
  const std::vector<double>& start = residuals.parameters();
  const std::vector<std::size_t> used = used_samples(columns.mask, first_part);
  // The noise of the laser is added to the speed along its beam, so that is the measure of its residual.
  std::vector<double> at_used(used.size());
  if (lams) {
    residuals.evaluate_speed(used.data(), used.size(), start.data(), {}, at_used.data(), nullptr);
  } else {
    residuals.evaluate(used.data(), used.size(), start.data(), {}, at_used.data(), nullptr);
  }
  columns.given.assign(records, nan);
  for (std::size_t k = 0; k < used.size(); ++k) columns.given[used[k]] = at_used[k];
  columns.residual = columns.given;

  // From here on the laser shows what the model says, so its noise is in no column.
  std::vector<double> predicted;
  if (lams) {
    predicted = residuals.predicted_beam_speed(start.data());
    for (auto& [quantity, values] : own->model.columns) {
      if (quantity == Quantity::lams_airspeed) values = predicted;
    }
  }
  const std::vector<Where> places = places_of(set);
  const ModelFile probed = with_probes(model, places);
  const Residuals at_model(own, probed, reference, mask);
  const std::vector<double>& parameters = at_model.parameters();
  std::vector<std::size_t> wanted = free_parameters(model);
  const std::size_t base_count = wanted.size();
  std::size_t own_count = 0;
  for (const ModelEffect& effect : model.model.effects) own_count += effect.parameters.size();
  for (std::size_t k = 0; k < places.size(); ++k) wanted.push_back(own_count + k);
  std::vector<double> derivatives(wanted.size() * used.size());
  if (lams) {
    at_model.evaluate_speed(used.data(), used.size(), parameters.data(), wanted, at_used.data(),
                            derivatives.data());
  } else {
    at_model.evaluate(used.data(), used.size(), parameters.data(), wanted, at_used.data(),
                      derivatives.data());
  }
  const auto derivative = [&](std::size_t column, std::size_t k) {
    return derivatives[column * used.size() + k];
  };
  columns.base.setZero(as_index(records), as_index(base_count));
  for (std::size_t c = 0; c < base_count; ++c) {
    for (std::size_t k = 0; k < used.size(); ++k)
      columns.base(as_index(used[k]), as_index(c)) = static_cast<float>(-derivative(c, k));
  }

  std::string why;
  const std::optional<Chain> chain = Chain::build(set.extended.model, extended->model.roles, &why);
  if (!chain) throw Error(fmt::format("{}: {}", extended->name, why));
  std::vector<CandidateValue> values;
  std::size_t column_count = 0;
  for (const Candidate& candidate : set.candidates) {
    values.emplace_back(candidate, chain->extra_names());
    column_count += candidate.tested.size();
  }
  std::vector<std::size_t> place_number;
  for (const Candidate& candidate : set.candidates) {
    const auto found = std::find(places.begin(), places.end(), where_of(candidate.effect));
    place_number.push_back(static_cast<std::size_t>(found - places.begin()));
  }
  std::vector<std::pair<Quantity, const double*>> inputs;
  for (const Quantity input : chain->inputs()) {
    const bool laser = lams && input == Quantity::lams_airspeed;
    inputs.emplace_back(input, laser ? predicted.data() : extended->model.find(input)->data());
  }
  const std::array<Quantity, 6> measured{Quantity::attack,
                                         Quantity::sideslip,
                                         Quantity::static_pressure_rate,
                                         Quantity::dynamic_pressure_rate,
                                         Quantity::normal_acceleration,
                                         Quantity::roll};
  for (const Quantity quantity : measured)
    columns.quantities.emplace_back(quantity, std::vector<double>(records, nan));
  columns.candidates.setZero(as_index(records), as_index(column_count));
  std::vector<double> gradient(column_count);
  for (std::size_t k = 0; k < used.size(); ++k) {
    const std::size_t sample = used[k];
    State<double> state;
    NoQualityFlags flags;
    for (const auto& [quantity, series] : inputs) state[quantity] = series[sample];
    chain->measure(state, chain->parameters().data(), flags);
    std::size_t column = 0;
    for (std::size_t c = 0; c < values.size(); ++c) {
      const std::size_t count = set.candidates[c].tested.size();
      values[c].derivatives(state, gradient.data());
      const double at_place = derivative(base_count + place_number[c], k);
      for (std::size_t p = 0; p < count; ++p, ++column)
        columns.candidates(as_index(sample), as_index(column)) = static_cast<float>(-at_place * gradient[p]);
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
