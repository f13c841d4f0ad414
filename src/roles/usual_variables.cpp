#include "roles/usual_variables.hpp"

#include <algorithm>
#include <stdexcept>

namespace pcor::internal {
namespace {

using Names = std::vector<std::string>;

const std::vector<UsualVariables>& all_usual_variables() {
  static const std::vector<UsualVariables> all{
      {facts_of(Quantity::ambient_temperature), {"ATX", "AT_A"}, true},
      {facts_of(Quantity::vapor_pressure), {"EDPC", "EWX"}, true},
      {facts_of(Quantity::dew_point), {"DPXC"}, true},
      {facts_of(Quantity::radome_dynamic_pressure), {"QCR"}},
      {facts_of(Quantity::attack_differential_pressure), {"ADIFR"}},
      {facts_of(Quantity::sideslip_differential_pressure), {"BDIFR"}},
      {facts_of(Quantity::attack), {"ATTACK", "AKRD"}},
      {facts_of(Quantity::sideslip), {"SSLIP", "SSRD"}},
      {facts_of(Quantity::true_airspeed), {"TASX", "TAS"}},
      {facts_of(Quantity::altitude), {"GGALT", "GGALTC", "ALTV"}},
      {{"other_altitude", "m", "altitude of an inertial system or of the pressure, up positive"},
       {"ALTX", "ALT", "PALT"}},
      {facts_of(Quantity::vertical_speed), {"GGVSPD", "VSPD"}},
      {facts_of(Quantity::latitude), {"GGLAT", "LATC", "LAT"}},
      {{"longitude", "deg", "longitude, east positive"}, {"GGLON", "LONC", "LON"}},
      {facts_of(Quantity::pitch), {"PITCH"}},
      {facts_of(Quantity::roll), {"ROLL"}},
      {facts_of(Quantity::heading), {"THDG"}},
      {facts_of(Quantity::ground_speed), {"GGSPD", "GSF"}},
      {facts_of(Quantity::ground_track), {"GGTRK", "TKAT"}},
      {{"ground_speed_east", "m/s", "ground speed, east positive"}, {"GGVEW", "VEWC", "VEW"}},
      {{"ground_speed_north", "m/s", "ground speed, north positive"}, {"GGVNS", "VNSC", "VNS"}},
      {facts_of(Quantity::normal_acceleration), {"BNORMA"}},
      {facts_of(Quantity::longitudinal_acceleration), {"BLONGA", "BLONA"}},
      {facts_of(Quantity::height_above_ground), {"HGM232", "RALT", "HGME", "HGM"}},
      {facts_of(Quantity::flaps), {"FLAPS"}},
      {facts_of(Quantity::liquid_water), {"PLWCC", "PLWCD", "PLWC", "PLWC1"}},
      {facts_of(Quantity::transducer_temperature), {"TBAY"}},
      {facts_of(Quantity::cabin_pressure), {"PCAB"}},
      {facts_of(Quantity::date), {"Time", "time", "time_offset"}},
  };
  return all;
}

const UsualVariables* find(std::string_view name) {
  const std::vector<UsualVariables>& all = all_usual_variables();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [name](const UsualVariables& each) { return each.series.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace

const UsualVariables& usual_series(std::string_view name) {
  const UsualVariables* const found = find(name);
  if (found == nullptr) throw std::out_of_range("no series " + std::string(name));
  return *found;
}

Names usual_variables(Quantity role) {
  const UsualVariables* const found = find(facts_of(role).name);
  return found == nullptr || found->chosen_by_model ? Names{} : found->names;
}

Names usual_heights() {
  Names names = usual_variables(Quantity::altitude);
  const Names& others = usual_series("other_altitude").names;
  names.insert(names.end(), others.begin(), others.end());
  return names;
}

const std::vector<PressurePair>& measured_pressures() {
  static const std::vector<PressurePair> pairs{
      {"PSFD", "QCF"}, {"PSFRD", "QCFR"}, {"PSF", "QCF"}, {"PS_A", "QC_A"}};
  return pairs;
}

const std::vector<PressurePair>& processed_pressures() {
  static const std::vector<PressurePair> pairs{{"PSXC", "QCXC"}, {"PSX", "QCX"}};
  return pairs;
}

const std::vector<Thermometer>& usual_thermometers() {
  static const std::vector<Thermometer> thermometers{
      {"TTX", "rosemount-boom-2004"},      {"TTRR", "rosemount-boom-2004"}, {"TTRL", "rosemount-boom-2004"},
      {"RTF1", "rosemount-unheated-2014"}, {"RTX", "rosemount-boom-2004"},  {"TTHR1", "harco-heated-2022"},
      {"TTHR2", "harco-heated-2022"},      {"TTHL1", "harco-heated-2022"},  {"TTHL2", "harco-heated-2022"},
      {"RTH1", "harco-heated-2022"},       {"RTH2", "harco-heated-2022"},   {"TTWH", "rosemount-deiced-2004"},
  };
  return thermometers;
}

}  // namespace pcor::internal
