#include "simulate/effects.hpp"

#include <algorithm>
#include <cmath>
#include <pcor/physics/constants.hpp>
#include <pcor/physics/geodesy.hpp>

#include "simulate/air.hpp"
#include "simulate/aircraft.hpp"

namespace pcor::internal::simulate {
namespace {

using Effect = Scenario::Effect;
using Law = Scenario::Law;
constexpr double seconds_per_hour = 3600.0;

double number(const Effect& effect, const std::string& key) { return effect.parameters.at(key); }

/// Adds `value(step)` to a series at every step.
template <class Value>
void add(Series& series, const Truth& truth, Value value) {
  series.resize(truth.size());
  for (std::size_t i = 0; i < series.size(); ++i) series[i] += value(i);
}

bool in_cloud(const Truth& truth, std::size_t i) { return truth.liquid_water[i] > 0.0; }

void add_to_law(const Effect& effect, const Truth&, SystemFaults* system, Faults&) {
  system->law.*find_fault(effect.id)->term += effect.parameters.begin()->second;
}

/// The fault of the pair of pressures, or of the instruments.
template <class Fault>
Fault& fault_of(Fault SystemFaults::*fault, SystemFaults* system, Faults&) {
  return system->*fault;
}
template <class Fault>
Fault& fault_of(Fault Faults::*fault, SystemFaults*, Faults& faults) {
  return faults.*fault;
}

template <auto fault>
void add_number(const Effect& effect, const Truth&, SystemFaults* system, Faults& faults) {
  fault_of(fault, system, faults) += effect.parameters.begin()->second;
}

/// Adds a value that depends on the truth of each step.
template <auto fault, double (*value)(const Effect&, const Truth&, std::size_t)>
void add_series(const Effect& effect, const Truth& truth, SystemFaults* system, Faults& faults) {
  add(fault_of(fault, system, faults), truth, [&](std::size_t i) { return value(effect, truth, i); });
}

template <double (*value)(const Effect&, const Truth&, std::size_t)>
constexpr auto add_defect = add_series<&SystemFaults::static_defect, value>;

double offset(const Effect& effect, const Truth&, std::size_t) { return number(effect, "offset"); }

// l = q k theta^n, theta the angle between the flow and the pitot's axis. Memo footnote 3: below 0.2 % of q
// to 5 deg.
double pitot_angle(const Effect& effect, const Truth& truth, std::size_t i) {
  const double angle = std::hypot(truth.attack[i] - number(effect, "axis"), truth.sideslip[i]);
  return number(effect, "k") * (truth.total_pressure[i] - truth.pressure[i]) *
         std::pow(angle, number(effect, "power"));
}

void transducer_thermal(const Effect& effect, const Truth& truth, SystemFaults* system, Faults&) {
  const double reference = number(effect, "reference");
  add(system->static_error, truth,
      [&](std::size_t i) { return number(effect, "static") * (truth.bay_temperature[i] - reference); });
  add(system->dynamic_error, truth,
      [&](std::size_t i) { return number(effect, "dynamic") * (truth.bay_temperature[i] - reference); });
}

void time_drift(const Effect& effect, const Truth& truth, SystemFaults* system, Faults&) {
  const auto hours = [](std::size_t i) { return static_cast<double>(i) * time_step / seconds_per_hour; };
  add(system->static_error, truth, [&](std::size_t i) { return number(effect, "static") * hours(i); });
  add(system->dynamic_error, truth, [&](std::size_t i) { return number(effect, "dynamic") * hours(i); });
}

double flaps_gear(const Effect& effect, const Truth& truth, std::size_t i) {
  constexpr double full = 50.0;  // percent
  return number(effect, "defect") * truth.flaps[i] / full;
}

double thrust(const Effect& effect, const Truth& truth, std::size_t i) {
  return number(effect, "defect") * 0.01 * truth.torque[i];
}

// The vortices of the wing have images below the ground, at 2 h: far above it d falls as (b/4h)^2.
double ground_effect(const Effect& effect, const Truth& truth, std::size_t i) {
  const double ratio = 4.0 * truth.height[i] / number(effect, "span");
  return number(effect, "defect") / (1.0 + ratio * ratio);
}

// Weight and inertia of the air between the port and the transducer `below` and `behind` it, at the
// temperature of the bay: dp = rho (f_normal below + f_forward behind), with the specific forces f measured
// by an accelerometer.
double line_head(const Effect& effect, const Truth& truth, std::size_t i) {
  const Air line{truth.pressure[i], truth.bay_temperature[i], 0.0};
  const double normal = truth.normal_acceleration[i] + constants::standard_gravity;
  return density(line) *
         (normal * number(effect, "below") + truth.forward_acceleration[i] * number(effect, "behind")) /
         pascal_per_hpa;
}

double load_factor(const Effect& effect, const Truth& truth, std::size_t i) {
  return number(effect, "per_g") * truth.normal_acceleration[i] / constants::standard_gravity;
}

double roll_static(const Effect& effect, const Truth& truth, std::size_t i) {
  return number(effect, "defect") * std::sin(constants::radians_per_degree * truth.roll[i]);
}

double static_transonic(const Effect& effect, const Truth& truth, std::size_t i) {
  return number(effect, "strength") * truth.pressure[i] *
         std::pow(std::max(0.0, truth.mach[i] - number(effect, "onset")), number(effect, "power"));
}

double qcr_angle(const Effect& effect, const Truth& truth, std::size_t i) {
  return number(effect, "attack") * truth.attack[i] * truth.attack[i] +
         number(effect, "sideslip") * truth.sideslip[i] * truth.sideslip[i];
}

void adif_drift(const Effect& effect, const Truth& truth, SystemFaults*, Faults& faults) {
  faults.attack_gain += number(effect, "gain");
  add(faults.attack_ratio, truth, [&](std::size_t i) {
    return number(effect, "offset") +
           number(effect, "per_hour") * static_cast<double>(i) * time_step / seconds_per_hour;
  });
}

double lams_elevation(const Effect& effect, const Truth&, std::size_t) { return number(effect, "error"); }

// The wing bends with the lift that it carries more than at the start.
double lams_pod_flex(const Effect& effect, const Truth& truth, std::size_t i) {
  const double load = 1.0 + truth.normal_acceleration[i] / constants::standard_gravity;
  return number(effect, "per_tonne") * 1e-3 * (load * truth.weight[i] - truth.weight[0]);
}

double lams_induction(const Effect& effect, const Truth& truth, std::size_t i) {
  return -truth.airspeed[i] * (number(effect, "fraction") + number(effect, "per_attack") * truth.attack[i]);
}

double lams_cloud(const Effect& effect, const Truth& truth, std::size_t i) {
  return in_cloud(truth, i) ? number(effect, "error") : 0.0;
}

double temp_offset(const Effect& effect, const Truth& truth, std::size_t i) {
  return number(effect, "offset") + number(effect, "slope") * (truth.temperature[i] - constants::ice_point);
}

// De-icing heat warms the element in inverse relation to the mass flow, of which Z is a measure; there are no
// measurements below 0.18.
double temp_deice_heat(const Effect& effect, const Truth& truth, std::size_t i) {
  constexpr double flow_scale = 0.269589;  // K/hPa
  constexpr double min_flow = 0.18;
  constexpr double usual_flow = 0.3;
  const double flow = flow_scale * truth.pressure[i] * truth.mach[i] / truth.temperature[i];
  return number(effect, "heat") * std::pow(std::max(flow, min_flow) / usual_flow, number(effect, "power"));
}

// Wet within a second, dry again in the time stated.
void temp_wetting(const Effect& effect, const Truth& truth, SystemFaults*, Faults& faults) {
  const double wet_time = 1.0;  // s, estimate
  double wet = 0.0;
  add(faults.temperature_error, truth, [&](std::size_t i) {
    const bool cloud = in_cloud(truth, i);
    wet += ((cloud ? 1.0 : 0.0) - wet) * time_step / (cloud ? wet_time : number(effect, "drying"));
    return number(effect, "error") * wet;
  });
}

void humidity_error(const Effect& effect, const Truth&, SystemFaults*, Faults& faults) {
  faults.humidity_gain += number(effect, "gain");
  faults.dew_point += number(effect, "dew_point");
}

void clock_skew(const Effect& effect, const Truth&, SystemFaults*, Faults& faults) {
  faults.clock[effect.on] += number(effect, "seconds");
}

void sensor_response(const Effect& effect, const Truth&, SystemFaults*, Faults& faults) {
  faults.response[effect.on] += number(effect, "tau");
}

double shaped(const std::string& shape, double x) {
  if (shape == "quadratic") return x * x;
  if (shape == "step") return x > 0.0 ? 1.0 : 0.0;
  if (shape == "sine") return std::sin(x);
  return x;
}

// strength * shape((x - centre)/scale) of any series x.
void unknown(const Effect& effect, const Truth& truth, SystemFaults* system, Faults& faults) {
  const Series& series = truth.*find_series(effect.of);
  const auto value = [&](std::size_t i) {
    const double x = (series[i] - number(effect, "centre")) / number(effect, "scale");
    return number(effect, "strength") * shaped(effect.shape, x);
  };
  if (effect.location == "static") add(system->static_defect, truth, value);
  if (effect.location == "total") add(system->total_loss, truth, value);
  if (effect.location == "lams") add(faults.lams_speed, truth, value);
  if (effect.location == "temperature") add(faults.temperature_error, truth, value);
}

bool acts_on(const Effect& effect, const Scenario::System& system) {
  return effect.on.empty() || effect.on == system.static_pressure || effect.on == system.dynamic_pressure;
}

bool acts_on_systems(const Effect& effect, const FaultInfo& info) {
  if (effect.id == "unknown") return effect.location == "static" || effect.location == "total";
  return info.target == Target::system;
}

}  // namespace

const std::vector<FaultInfo>& fault_info() {
  static const std::vector<FaultInfo> info{
      {"static-constant", Target::system, {{"a0", "1"}}, add_to_law, &Law::a0},
      {"static-alpha", Target::system, {{"a1", "1"}}, add_to_law, &Law::a1},
      {"static-qp", Target::system, {{"a2", "1"}}, add_to_law, &Law::a2},
      {"static-attack", Target::system, {{"a3", "1/deg"}}, add_to_law, &Law::a3},
      {"static-alpha-quad", Target::system, {{"a4", "1/deg2"}}, add_to_law, &Law::a4},
      {"static-mach", Target::system, {{"m1", "1"}}, add_to_law, &Law::m1},
      {"static-mach2", Target::system, {{"m2", "1"}}, add_to_law, &Law::m2},
      {"static-mach3", Target::system, {{"m3", "1"}}, add_to_law, &Law::m3},
      {"static-beta-odd", Target::system, {{"b1", "1"}}, add_to_law, &Law::b1},
      {"static-beta-even", Target::system, {{"b2", "1/deg2"}}, add_to_law, &Law::b2},
      {"static-transonic",
       Target::system,
       {{"strength", "1"}, {"onset", "1", 0.82}, {"power", "1", 2.0}},
       add_defect<static_transonic>},
      {"flaps-gear", Target::system, {{"defect", "hPa at 50 %"}}, add_defect<flaps_gear>},
      {"speedbrake-thrust", Target::system, {{"defect", "hPa at 100 %"}}, add_defect<thrust>},
      {"ground-effect",
       Target::system,
       {{"defect", "hPa at the ground"}, {"span", "m", 40.4}},
       add_defect<ground_effect>},
      {"line-head",
       Target::system,
       {{"below", "m", 0.0}, {"behind", "m", 0.0}},
       add_series<&SystemFaults::static_head, line_head>},
      {"load-factor", Target::system, {{"per_g", "hPa"}}, add_defect<load_factor>},
      {"roll-static", Target::system, {{"defect", "hPa"}}, add_defect<roll_static>},
      {"pitot-angle",
       Target::system,
       {{"k", "1/deg^power"}, {"power", "1", 2.0}, {"axis", "deg", 0.0}},
       add_series<&SystemFaults::total_loss, pitot_angle>},
      {"static-lag", Target::system, {{"tau", "s"}}, add_number<&SystemFaults::static_lag>},
      {"total-lag", Target::system, {{"tau", "s"}}, add_number<&SystemFaults::total_lag>},
      {"static-leak", Target::system, {{"fraction", "1"}}, add_number<&SystemFaults::leak>},
      {"qcf-zero", Target::system, {{"offset", "hPa"}}, add_series<&SystemFaults::dynamic_error, offset>},
      {"qcf-gain", Target::system, {{"gain", "1"}}, add_number<&SystemFaults::dynamic_gain>},
      {"psfd-bias", Target::system, {{"offset", "hPa"}}, add_series<&SystemFaults::static_error, offset>},
      {"transducer-thermal",
       Target::system,
       {{"static", "hPa/K", 0.0}, {"dynamic", "hPa/K", 0.0}, {"reference", "K", 290.0}},
       transducer_thermal},
      {"time-drift", Target::system, {{"static", "hPa/h", 0.0}, {"dynamic", "hPa/h", 0.0}}, time_drift},
      {"qcr-angle",
       Target::instrument,
       {{"attack", "hPa/deg2", 0.0}, {"sideslip", "hPa/deg2", 0.0}},
       add_series<&Faults::radome_loss, qcr_angle>},
      {"adif-drift",
       Target::instrument,
       {{"gain", "1", 0.0}, {"offset", "1", 0.0}, {"per_hour", "1/h", 0.0}},
       adif_drift},
      {"lams-elevation",
       Target::instrument,
       {{"error", "deg"}},
       add_series<&Faults::lams_elevation, lams_elevation>},
      {"lams-azimuth", Target::instrument, {{"error", "deg"}}, add_number<&Faults::lams_azimuth>},
      {"lams-pod-flex",
       Target::instrument,
       {{"per_tonne", "deg/t"}},
       add_series<&Faults::lams_elevation, lams_pod_flex>},
      {"lams-scale", Target::instrument, {{"scale", "1"}}, add_number<&Faults::lams_scale>},
      {"lams-induction",
       Target::instrument,
       {{"fraction", "1", 0.0}, {"per_attack", "1/deg", 0.0}},
       add_series<&Faults::lams_speed, lams_induction>},
      {"lams-cloud", Target::instrument, {{"error", "m/s"}}, add_series<&Faults::lams_speed, lams_cloud>},
      {"temp-offset",
       Target::instrument,
       {{"offset", "K", 0.0}, {"slope", "1", 0.0}},
       add_series<&Faults::temperature_error, temp_offset>},
      {"recovery-factor", Target::instrument, {{"error", "1"}}, add_number<&Faults::recovery>},
      {"temp-lag", Target::instrument, {{"tau", "s"}}, add_number<&Faults::temperature_lag>},
      {"temp-wetting", Target::instrument, {{"error", "K"}, {"drying", "s", 10.0}}, temp_wetting},
      {"temp-deice-heat",
       Target::instrument,
       {{"heat", "K at Z = 0.3"}, {"power", "1", -1.78}},
       add_series<&Faults::temperature_error, temp_deice_heat>},
      {"humidity-error", Target::instrument, {{"gain", "1", 0.0}, {"dew_point", "K", 0.0}}, humidity_error},
      {"clock-skew", Target::variable, {{"seconds", "s"}}, clock_skew},
      {"sensor-response", Target::variable, {{"tau", "s"}}, sensor_response},
      {"unknown",
       Target::instrument,
       {{"strength", "hPa, m/s or K"},
        {"centre", "unit of the variable", 0.0},
        {"scale", "unit of the variable", 1.0}},
       unknown},
  };
  return info;
}

const FaultInfo* find_fault(std::string_view id) {
  for (const FaultInfo& info : fault_info()) {
    if (info.id == id) return &info;
  }
  return nullptr;
}

const Series Truth::*find_series(std::string_view name) {
  if (name == "hidden") return &Truth::hidden;
  for (const TruthInfo& info : truth_info) {
    if (!name.empty() && (info.recorded == name || info.name == name)) return info.series;
  }
  return nullptr;
}

Faults faults_of(const Scenario& scenario, const Truth& truth) {
  Faults faults;
  for (const Scenario::System& system : scenario.systems) faults.systems.emplace_back().law = system.law;
  for (const Effect& effect : scenario.effects) {
    const FaultInfo& info = *find_fault(effect.id);
    if (!acts_on_systems(effect, info)) {
      info.act(effect, truth, nullptr, faults);
      continue;
    }
    for (std::size_t i = 0; i < scenario.systems.size(); ++i) {
      if (acts_on(effect, scenario.systems[i])) info.act(effect, truth, &faults.systems[i], faults);
    }
  }
  return faults;
}

}  // namespace pcor::internal::simulate
