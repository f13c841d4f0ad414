#include <pcor/residuals/residuals.hpp>

#include <ceres/jet.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include <pcor/batch/batch.hpp>
#include <pcor/physics/standard_atmosphere.hpp>
#include <pcor/words/error.hpp>
#include <pcor/words/suggest.hpp>
#include "roles/model_inputs.hpp"
#include "roles/recorded_series.hpp"

namespace pcor {

using namespace internal;

const std::array<MaskFacts, mask_count> mask_facts{{
    {"used", "used"},
    {"excluded", "in times that the user excluded"},
    {"missing", "without a value that the model needs"},
    {"ground", "on the ground"},
    {"low_speed", "slower than the least airspeed (--min-airspeed)"},
    {"flaps", "with flaps out (--max-flaps)"},
    {"regime", "in a regime that is excluded (--exclude)"},
    {"reference_missing", "without a value of the reference"},
    {"laser_unlocked", "with a laser airspeed far from that of the pressures"},
    {"impossible", "without a delta-p: impossible with these values and coefficients"},
}};

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
using Columns = std::vector<std::pair<Quantity, std::vector<double>>>;

constexpr int jet_width = 4;
using Jet = ceres::Jet<double, jet_width>;

/// Centred differences in time; NaN at the ends and beside gaps.
std::vector<double> rate_of(const std::vector<double>& values, const std::vector<double>& time, double step) {
  std::vector<double> rate(values.size(), nan);
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    const double across = time[i + 1] - time[i - 1];
    if (across <= 2.5 * step) rate[i] = (values[i + 1] - values[i - 1]) / across;
  }
  return rate;
}

Chain chain_of(const Model& model, const std::vector<Quantity>& roles) {
  BindingError why;
  std::optional<Chain> chain = Chain::build(model, roles, &why);
  if (!chain) throw Error(Error::Code::model, fmt::format("model '{}': {}", model.name, why.message()));
  return std::move(*chain);
}

ModelSamples read_model_samples(const Flight& flight, const ModelFile& file, bool with_lams,
                                const std::vector<double>& time, std::vector<std::string>& notes) {
  std::vector<Quantity> roles = file.roles();
  if (!with_lams) roles.erase(std::remove(roles.begin(), roles.end(), Quantity::lams_airspeed), roles.end());
  const Chain chain = chain_of(file.model, roles);
  ModelSamples samples;
  for (const ModelInput& input : model_inputs(flight, file, chain, roles, notes)) {
    samples.columns.emplace_back(input.quantity, read_values(flight, input.variable, input.conversion));
    if (is_role(input.quantity)) samples.roles.push_back(input.quantity);
  }
  const auto add = [&samples](Quantity quantity, std::vector<double> values) {
    samples.columns.emplace_back(quantity, std::move(values));
    samples.roles.push_back(quantity);
  };
  if (chain.derives(Quantity::time)) {
    std::vector<double> since_first = time;
    for (double& each : since_first) each -= time.front();
    add(Quantity::time, std::move(since_first));
  }
  for (const auto& [quantity, rate] : rates) {
    if (chain.derives(rate)) add(rate, rate_of(*samples.find(quantity), time, flight.time().step));
  }
  return samples;
}

/// True airspeed from the pressures as measured, m/s: within 2 %, for regimes and masks.
std::vector<double> measured_airspeed(const ModelSamples& samples) {
  const std::vector<double>& p = *samples.find(Quantity::static_pressure);
  const std::vector<double>& q = *samples.find(Quantity::dynamic_pressure);
  const std::vector<double>* recovery = samples.find(Quantity::recovery_temperature);
  const std::vector<double>* ambient = samples.find(Quantity::ambient_temperature);
  std::vector<double> airspeed(p.size(), nan);
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!(p[i] > 0.0) || std::isnan(q[i])) continue;
    const double mach = q[i] > 0.0 ? mach_number(p[i], q[i], dry_air<double>()) : 0.0;
    double temperature = nan;
    if (ambient != nullptr) temperature = (*ambient)[i];
    if (std::isnan(temperature) && recovery != nullptr)
      temperature = (*recovery)[i] / (1.0 + 0.2 * mach * mach);
    if (std::isnan(temperature)) temperature = standard_temperature(pressure_altitude(p[i]));
    airspeed[i] = true_airspeed(mach, temperature, dry_air<double>());
  }
  return airspeed;
}

FlightMotion read_motion(const Flight& flight, const ModelFile& model, const FlightSamples& samples) {
  const auto read = [&](Quantity role) { return read_role(flight, model, role).values; };
  FlightMotion motion;
  motion.time = samples.time;
  motion.airspeed = measured_airspeed(samples.model);
  motion.altitude = read(Quantity::altitude);
  if (motion.altitude.empty()) motion.altitude = read_usual(flight, usual_series("other_altitude")).values;
  motion.vertical_speed = read(Quantity::vertical_speed);
  motion.roll = read(Quantity::roll);
  motion.pitch = read(Quantity::pitch);
  motion.heading = read(Quantity::heading);
  motion.attack = read(Quantity::attack);
  motion.sideslip = read(Quantity::sideslip);
  motion.ground_speed = read(Quantity::ground_speed);
  motion.ground_track = read(Quantity::ground_track);
  motion.liquid_water = read(Quantity::liquid_water);
  return motion;
}

/// The roles of samples that the model names: a diagnosis reads more of a flight.
std::vector<Quantity> roles_of(const ModelFile& file, const ModelSamples& samples) {
  std::vector<Quantity> roles;
  std::copy_if(samples.roles.begin(), samples.roles.end(), std::back_inserter(roles),
               [&](Quantity quantity) { return !is_role(quantity) || file.variables.count(quantity) != 0; });
  return roles;
}

/// The samples of one model as its chain reads them.
class Bound {
 public:
  Bound(const ModelFile& file, const ModelSamples& samples) : batch_(file.model, roles_of(file, samples)) {
    for (const Quantity input : batch_.chain().inputs())
      columns_.push_back({input, samples.find(input)->data()});
  }

  const Batch& batch() const { return batch_; }
  const Chain& chain() const { return batch_.chain(); }
  const std::vector<Batch::Input>& columns() const { return columns_; }

  /// The columns of the samples at some places, gathered one after another into `store`.
  std::vector<Batch::Input> gathered(const std::size_t* samples, std::size_t count,
                                     std::vector<double>& store) const {
    store.resize(columns_.size() * count);
    std::vector<Batch::Input> inputs;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      double* const to = store.data() + c * count;
      for (std::size_t i = 0; i < count; ++i) to[i] = columns_[c].values[samples[i]];
      inputs.push_back({columns_[c].quantity, to});
    }
    return inputs;
  }

  /// One sample through the chain up to delta-p of the model.
  template <class S>
  S corrected_static_pressure(std::size_t sample, const S* parameters, State<S>& state) const {
    NoQualityFlags flags;
    for (const Batch::Input& column : columns_) state[column.quantity] = S(column.values[sample]);
    chain().measure(state, parameters, flags);
    state[Quantity::static_defect] = chain().static_defect(state, parameters, flags);
    return state[Quantity::port_static_pressure] + state[Quantity::static_defect];
  }

  bool is_missing_needed(std::size_t sample) const {
    return std::any_of(columns_.begin(), columns_.end(), [&](const Batch::Input& column) {
      return chain().needs(column.quantity) && std::isnan(column.values[sample]);
    });
  }

 private:
  Batch batch_;
  std::vector<Batch::Input> columns_;
};

/// A step of a linear parameter that changes delta-p by tenths of hPa.
double step_of(const Model& model, std::size_t parameter) {
  std::size_t first = 0;
  for (const ModelEffect& effect : model.effects) {
    if (parameter < first + effect.parameters.size()) {
      const double typical = effect_facts[effect_named(effect.id)].parameters[parameter - first].typical;
      return 0.1 * std::abs(typical);
    }
    first += effect.parameters.size();
  }
  return 0.0;
}

void add_linear(const Model& model, std::vector<bool>& linear) {
  const bool has_minimum = std::isfinite(model.policy.minimum);
  for (const ModelEffect& effect : model.effects) {
    const std::size_t place = effect_named(effect.id);
    const bool is = !has_minimum && !effect.is_formula() && place != catalogue_size &&
                    effect_facts[place].where == Where::static_defect;
    for (std::size_t p = 0; p < effect.parameters.size(); ++p)
      linear.push_back(is && !effect_facts[place].parameters[p].shape);
  }
  linear.resize(linear.size() + model.additions.size(), false);
}

}  // namespace

const std::vector<double>* ModelSamples::find(Quantity quantity) const {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [quantity](const auto& column) { return column.first == quantity; });
  return found == columns.end() ? nullptr : &found->second;
}

FlightSamples read_samples(const Flight& flight, const ModelFile& model, const Reference& reference,
                           const MaskOptions& options) {
  FlightSamples samples;
  samples.name = flight.path().filename().string();
  samples.aircraft = flight.aircraft();
  samples.step = flight.time().step;
  samples.time.resize(flight.records());
  for (const RecordBlock block : blocks_of(flight.records()))
    flight.read_sample_times(block, 1, samples.time.data() + block.first);
  samples.notes = notes_on_law(flight, model);
  const bool with_lams = reference.kind == Reference::Kind::lams;
  samples.model = read_model_samples(flight, model, with_lams, samples.time, samples.notes);
  if (reference.kind == Reference::Kind::static_system) {
    samples.reference = read_model_samples(flight, *reference.system, false, samples.time, samples.notes);
  }
  if (reference.kind == Reference::Kind::pressure) {
    if (!flight.has(reference.variable)) {
      const std::string meant = did_you_mean(reference.variable, flight.variables());
      throw Error(fmt::format("{}: {}, the reference, is not in this file{}; give another with --reference",
                              flight.path().string(), reference.variable, meant.empty() ? "" : "; " + meant));
    }
    const UnitConversion conversion = flight.conversion(reference.variable, "hPa");
    flight.require_values(reference.variable);
    samples.pressure = read_values(flight, reference.variable, conversion);
  }
  samples.motion = read_motion(flight, model, samples);
  samples.flaps = read_role(flight, model, Quantity::flaps).values;
  if (samples.flaps.empty()) {
    samples.notes.emplace_back(
        "the flight records no flaps, so an approach with flaps and gear out takes part; --min-airspeed or "
        "--intervals leaves it out");
  }
  const std::optional<RegimeCriteria> criteria = RegimeCriteria::of(samples.aircraft);
  if (!criteria) {
    samples.notes.push_back(
        fmt::format("the aircraft {} is not known here, so its regimes are found by the criteria of the "
                    "C-130, whose speed "
                    "runs are slower than those of a jet; --intervals adds regimes and takes them away",
                    samples.aircraft.empty() ? "of this flight" : "'" + samples.aircraft + "'"));
  }
  samples.intervals = find_regimes(samples.motion, criteria.value_or(RegimeCriteria::c130()));
  if (options.intervals && options.intervals->is_for(flight.path())) {
    samples.intervals =
        apply(*options.intervals, std::move(samples.intervals), samples.time.front(), samples.time.back());
  }
  return samples;
}

std::string mask_text(const std::array<std::size_t, mask_count>& counts) {
  std::vector<std::size_t> order(mask_count - 1);
  std::iota(order.begin(), order.end(), 1);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return counts[a] > counts[b]; });
  std::vector<std::string> parts;
  for (const std::size_t mask : order) {
    if (counts[mask] > 0) parts.push_back(fmt::format("{} {}", counts[mask], mask_facts[mask].meaning));
  }
  return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, "; "));
}

struct Residuals::Implementation {
  std::shared_ptr<const FlightSamples> samples;
  Reference::Kind kind = Reference::Kind::lams;
  Model model;
  Model reference_model;
  std::optional<Bound> bound;
  std::optional<Bound> reference;
  std::size_t own_parameters = 0;
  std::vector<double> parameters;
  std::vector<bool> linear;
  std::vector<Mask> mask;
  std::vector<double> sensitivity;  // for LAMS

  template <class S>
  S residual_at(std::size_t sample, const S* all) const {
    State<S> state;
    const S corrected = bound->corrected_static_pressure(sample, all, state);
    switch (kind) {
      case Reference::Kind::lams: {
        NoQualityFlags flags;
        return bound->chain().lams_static_defect(state, all, flags) - state[Quantity::static_defect];
      }
      case Reference::Kind::static_system: {
        State<S> other;
        return reference->corrected_static_pressure(sample, all + own_parameters, other) - corrected;
      }
      case Reference::Kind::pressure:
        return S(samples->pressure[sample]) - corrected;
    }
    return corrected;
  }

  /// See `Residuals::evaluate_speed`.
  template <class S>
  S speed_residual_at(std::size_t sample, const S* all) const {
    State<S> state;
    NoQualityFlags flags;
    const Chain& chain = bound->chain();
    bound->corrected_static_pressure(sample, all, state);
    chain.correct(state, state[Quantity::static_defect], flags);
    const S measured = chain.lams_airspeed(state, all);
    const S along =
        state[Quantity::lams_airspeed] / measured;  // cosine of the beam, but for effects on its speed
    chain.air(state, all, flags);
    return S(sensitivity[sample]) * along * (measured - state[Quantity::corrected_airspeed]);
  }

  double predicted_beam_speed_at(std::size_t sample, const double* all) const {
    State<double> state;
    NoQualityFlags flags;
    const Chain& chain = bound->chain();
    bound->corrected_static_pressure(sample, all, state);
    chain.correct(state, state[Quantity::static_defect], flags);
    const double along = state[Quantity::lams_airspeed] / chain.lams_airspeed(state, all);
    chain.air(state, all, flags);
    return along * state[Quantity::corrected_airspeed];
  }

  /// Derivatives by dual numbers of the parameters `places` among those `wanted`, into their columns.
  template <class Function>
  void differentiate(const std::size_t* at, std::size_t count, const double* all,
                     const std::vector<std::size_t>& wanted, const std::vector<std::size_t>& places,
                     double* derivatives, const Function& value_at) const {
    std::vector<Jet> dual(parameters.size());
    for (std::size_t first = 0; first < places.size(); first += jet_width) {
      const std::size_t width = std::min<std::size_t>(jet_width, places.size() - first);
      for (std::size_t p = 0; p < dual.size(); ++p) dual[p] = Jet(all[p]);
      for (std::size_t k = 0; k < width; ++k)
        dual[wanted[places[first + k]]].v[static_cast<Eigen::Index>(k)] = 1.0;
      for (std::size_t i = 0; i < count; ++i) {
        const Jet value = value_at(at[i], dual.data());
        for (std::size_t k = 0; k < width; ++k)
          derivatives[places[first + k] * count + i] = value.v[static_cast<Eigen::Index>(k)];
      }
    }
  }

  /// The rate of change of delta-p from LAMS with the airspeed, hPa/(m/s), where the files' parameters say
  /// that the air is.
  std::vector<double> find_sensitivity() const;

  void residuals(const std::vector<Batch::Input>& inputs, const std::vector<Batch::Input>& reference_inputs,
                 const double* pressure, std::size_t count, const double* all, double* out) const;
  void find_mask(const MaskOptions& options);
  Mask mask_of(std::size_t sample, double residual, const MaskOptions& options,
               const RegimeSet& regimes) const;
};

std::vector<double> Residuals::Implementation::find_sensitivity() const {
  const std::size_t count = samples->time.size();
  std::vector<double> mach(count);
  std::vector<double> pressure(count);
  std::vector<double> airspeed(count);
  bound->batch().run(bound->columns(),
                     {{Quantity::corrected_mach, mach.data()},
                      {Quantity::corrected_static_pressure, pressure.data()},
                      {Quantity::corrected_airspeed, airspeed.data()}},
                     count, parameters.data());
  std::vector<double> result(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double squared = mach[i] * mach[i];
    result[i] = -1.4 * squared * pressure[i] / ((1.0 + 0.2 * squared) * airspeed[i]);
  }
  return result;
}

void Residuals::Implementation::residuals(const std::vector<Batch::Input>& inputs,
                                          const std::vector<Batch::Input>& reference_inputs,
                                          const double* pressure, std::size_t count, const double* all,
                                          double* out) const {
  std::vector<double> other(count);
  if (kind == Reference::Kind::lams) {
    bound->batch().run(inputs, {{Quantity::static_defect, other.data()}, {Quantity::lams_static_defect, out}},
                       count, all);
    for (std::size_t i = 0; i < count; ++i) out[i] -= other[i];
    return;
  }
  std::vector<double> defect(count);
  bound->batch().run(
      inputs, {{Quantity::port_static_pressure, other.data()}, {Quantity::static_defect, defect.data()}},
      count, all);
  for (std::size_t i = 0; i < count; ++i) out[i] = -(other[i] + defect[i]);
  if (kind == Reference::Kind::pressure) {
    for (std::size_t i = 0; i < count; ++i) out[i] += pressure[i];
    return;
  }
  reference->batch().run(
      reference_inputs,
      {{Quantity::port_static_pressure, other.data()}, {Quantity::static_defect, defect.data()}}, count,
      all + own_parameters);
  for (std::size_t i = 0; i < count; ++i) out[i] += other[i] + defect[i];
}

Mask Residuals::Implementation::mask_of(std::size_t sample, double residual, const MaskOptions& options,
                                        const RegimeSet& regimes) const {
  const FlightSamples& flight = *samples;
  const double airspeed = flight.motion.airspeed.empty() ? nan : flight.motion.airspeed[sample];
  const double p = (*flight.model.find(Quantity::static_pressure))[sample];
  const double q = (*flight.model.find(Quantity::dynamic_pressure))[sample];
  if (std::isnan(p) || std::isnan(q)) return Mask::missing;
  if (regimes[static_cast<std::size_t>(Regime::ground)]) return Mask::ground;
  if (airspeed < options.least_airspeed) return Mask::low_speed;
  if (!flight.flaps.empty() && flight.flaps[sample] > options.most_flaps) return Mask::flaps;
  for (const Regime regime : options.exclude) {
    if (regimes[static_cast<std::size_t>(regime)]) return Mask::regime;
  }
  if (std::isnan(residual)) {
    State<double> state;
    if (kind != Reference::Kind::lams && bound->is_missing_needed(sample)) return Mask::missing;
    if (kind == Reference::Kind::pressure && std::isnan(flight.pressure[sample])) return Mask::reference;
    if (kind == Reference::Kind::static_system && reference->is_missing_needed(sample))
      return Mask::reference;
    if (kind == Reference::Kind::lams) {
      // The chain of the laser needs more than the law: what the law alone lacks is missing, what the laser
      // lacks is the reference's.
      bound->corrected_static_pressure(sample, parameters.data(), state);
      const bool law = std::isnan(state[Quantity::static_defect]);
      const bool any =
          std::any_of(bound->columns().begin(), bound->columns().end(),
                      [&](const Batch::Input& column) { return std::isnan(column.values[sample]); });
      if (any) return law ? Mask::missing : Mask::reference;
    }
    return Mask::impossible;
  }
  if (kind == Reference::Kind::lams) {
    const double beam = (*flight.model.find(Quantity::lams_airspeed))[sample];
    if (std::abs(beam - airspeed) > options.most_laser_departure) return Mask::laser_unlocked;
  }
  return Mask::none;
}

void Residuals::Implementation::find_mask(const MaskOptions& options) {
  const FlightSamples& flight = *samples;
  std::vector<double> residual(flight.time.size());
  residuals(bound->columns(), reference ? reference->columns() : std::vector<Batch::Input>{},
            flight.pressure.data(), flight.time.size(), parameters.data(), residual.data());
  const std::vector<RegimeSet> regimes = regimes_of_samples(flight.time, flight.intervals);
  mask.resize(flight.time.size());
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = mask_of(i, residual[i], options, regimes[i]);
  if (!options.intervals || flight.time.empty() || !options.intervals->is_for(flight.name)) return;
  for (const Exclusion& exclusion :
       placed(*options.intervals, flight.time.front(), flight.time.back()).exclude) {
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (flight.time[i] >= exclusion.begin && flight.time[i] < exclusion.end) mask[i] = Mask::excluded;
    }
  }
}

Residuals::Residuals(std::shared_ptr<const FlightSamples> samples, const ModelFile& model,
                     const Reference& reference, const MaskOptions& options)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& own = *implementation_;
  own.samples = std::move(samples);
  own.kind = reference.kind;
  own.model = model.model;
  own.bound.emplace(model, own.samples->model);
  own.parameters = own.bound->chain().parameters();
  own.own_parameters = own.parameters.size();
  add_linear(own.model, own.linear);
  if (reference.kind == Reference::Kind::static_system) {
    own.reference_model = reference.system->model;
    own.reference.emplace(*reference.system, own.samples->reference);
    const std::vector<double>& more = own.reference->chain().parameters();
    own.parameters.insert(own.parameters.end(), more.begin(), more.end());
    add_linear(own.reference_model, own.linear);
  }
  own.find_mask(options);
  if (own.kind == Reference::Kind::lams) own.sensitivity = own.find_sensitivity();
}

Residuals::Residuals(Residuals&&) noexcept = default;
Residuals& Residuals::operator=(Residuals&&) noexcept = default;
Residuals::~Residuals() = default;

const FlightSamples& Residuals::samples() const { return *implementation_->samples; }
std::size_t Residuals::size() const { return implementation_->samples->time.size(); }
const std::vector<double>& Residuals::parameters() const { return implementation_->parameters; }
const std::vector<bool>& Residuals::is_linear() const { return implementation_->linear; }
const std::vector<Mask>& Residuals::mask() const { return implementation_->mask; }

std::array<std::size_t, mask_count> Residuals::mask_counts() const {
  std::array<std::size_t, mask_count> counts{};
  for (const Mask mask : implementation_->mask) ++counts[static_cast<std::size_t>(mask)];
  return counts;
}

std::vector<double> Residuals::values(const double* parameters) const {
  const Implementation& own = *implementation_;
  std::vector<double> result(size());
  own.residuals(own.bound->columns(), own.reference ? own.reference->columns() : std::vector<Batch::Input>{},
                own.samples->pressure.data(), size(), parameters, result.data());
  return result;
}

void Residuals::evaluate(const std::size_t* samples, std::size_t count, const double* parameters,
                         const std::vector<std::size_t>& wanted, double* residual,
                         double* derivatives) const {
  const Implementation& own = *implementation_;
  std::vector<double> store;
  std::vector<double> reference_store;
  std::vector<double> pressure;
  const std::vector<Batch::Input> inputs = own.bound->gathered(samples, count, store);
  std::vector<Batch::Input> reference_inputs;
  if (own.reference) reference_inputs = own.reference->gathered(samples, count, reference_store);
  if (own.kind == Reference::Kind::pressure) {
    pressure.resize(count);
    for (std::size_t i = 0; i < count; ++i) pressure[i] = own.samples->pressure[samples[i]];
  }
  own.residuals(inputs, reference_inputs, pressure.data(), count, parameters, residual);

  std::vector<double> moved(parameters, parameters + own.parameters.size());
  std::vector<double> before;
  std::vector<double> reference_before;
  std::vector<std::size_t> curved;  // places in `wanted`
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const std::size_t parameter = wanted[k];
    if (!own.linear[parameter]) {
      curved.push_back(k);
      continue;
    }
    const bool of_reference = parameter >= own.own_parameters;
    const Bound& bound = of_reference ? *own.reference : *own.bound;
    const std::vector<Batch::Input>& its_inputs = of_reference ? reference_inputs : inputs;
    const std::size_t offset = of_reference ? own.own_parameters : 0;
    std::vector<double>& defect = of_reference ? reference_before : before;
    if (defect.empty() && count > 0) {
      defect.resize(count);
      bound.batch().run(its_inputs, {{Quantity::static_defect, defect.data()}}, count, parameters + offset);
    }
    const double step = step_of(of_reference ? own.reference_model : own.model, parameter - offset);
    double* const column = derivatives + k * count;
    moved[parameter] = parameters[parameter] + step;
    bound.batch().run(its_inputs, {{Quantity::static_defect, column}}, count, moved.data() + offset);
    const double made = moved[parameter] - parameters[parameter];
    moved[parameter] = parameters[parameter];
    const double scale = (of_reference ? 1.0 : -1.0) / made;
    for (std::size_t i = 0; i < count; ++i) column[i] = scale * (column[i] - defect[i]);
  }

  own.differentiate(samples, count, parameters, wanted, curved, derivatives,
                    [&own](std::size_t sample, const Jet* dual) { return own.residual_at(sample, dual); });
}

void Residuals::evaluate_speed(const std::size_t* samples, std::size_t count, const double* parameters,
                               const std::vector<std::size_t>& wanted, double* residual,
                               double* derivatives) const {
  const Implementation& own = *implementation_;
  for (std::size_t i = 0; i < count; ++i) residual[i] = own.speed_residual_at(samples[i], parameters);
  std::vector<std::size_t> all(wanted.size());
  std::iota(all.begin(), all.end(), 0);
  own.differentiate(
      samples, count, parameters, wanted, all, derivatives,
      [&own](std::size_t sample, const Jet* dual) { return own.speed_residual_at(sample, dual); });
}

std::vector<double> Residuals::predicted_beam_speed(const double* parameters) const {
  std::vector<double> result(size());
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = implementation_->predicted_beam_speed_at(i, parameters);
  return result;
}

std::vector<double> Residuals::wanted_defect(const double* parameters) const {
  std::vector<double> result = values(parameters);
  const std::vector<double> defect = quantity(Quantity::static_defect, parameters);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += defect[i];
  return result;
}

std::vector<double> Residuals::quantity(Quantity quantity, const double* parameters) const {
  const Implementation& own = *implementation_;
  std::vector<double> result(size());
  own.bound->batch().run(own.bound->columns(), {{quantity, result.data()}}, size(), parameters);
  return result;
}

std::vector<std::string> residual_parameter_names(const ModelFile& model, const Reference& reference) {
  std::vector<std::string> names;
  const auto add = [&names](const Model& of, const char* prefix) {
    for (const ModelEffect& effect : of.effects) {
      for (const std::string& parameter : parameter_names(effect))
        names.push_back(fmt::format("{}{}.{}", prefix, effect.id, parameter));
    }
  };
  add(model.model, "");
  if (reference.kind == Reference::Kind::static_system) add(reference.system->model, "reference:");
  return names;
}

}  // namespace pcor
