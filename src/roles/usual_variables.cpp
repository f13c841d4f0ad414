#include "roles/usual_variables.hpp"

#include <map>

namespace pcor::internal {
namespace {

using Names = std::vector<std::string>;

const std::map<Quantity, Names>& all_usual_variables() {
  static const std::map<Quantity, Names> all{
      {Quantity::radome_dynamic_pressure, {"QCR"}},
      {Quantity::attack_differential_pressure, {"ADIFR"}},
      {Quantity::sideslip_differential_pressure, {"BDIFR"}},
      {Quantity::attack, {"ATTACK", "AKRD"}},
      {Quantity::sideslip, {"SSLIP", "SSRD"}},
      {Quantity::true_airspeed, {"TASX", "TAS"}},
      {Quantity::altitude, {"GGALT", "GGALTC", "ALTX", "ALT", "PALT"}},
      {Quantity::vertical_speed, {"GGVSPD", "VSPD"}},
      {Quantity::latitude, {"GGLAT", "LATC", "LAT"}},
      {Quantity::pitch, {"PITCH"}},
      {Quantity::roll, {"ROLL"}},
      {Quantity::heading, {"THDG"}},
      {Quantity::ground_speed, {"GGSPD", "GSF"}},
      {Quantity::ground_track, {"GGTRK", "TKAT"}},
      {Quantity::normal_acceleration, {"BNORMA"}},
      {Quantity::longitudinal_acceleration, {"BLONGA", "BLONA"}},
      {Quantity::height_above_ground, {"HGM232", "RALT", "HGME", "HGM"}},
      {Quantity::flaps, {"FLAPS"}},
      {Quantity::liquid_water, {"PLWCC", "PLWCD", "PLWC", "PLWC1"}},
      {Quantity::transducer_temperature, {"TBAY"}},
      {Quantity::cabin_pressure, {"PCAB"}},
  };
  return all;
}

}  // namespace

Names usual_variables(Quantity role) {
  const auto found = all_usual_variables().find(role);
  return found == all_usual_variables().end() ? Names{} : found->second;
}

}  // namespace pcor::internal
