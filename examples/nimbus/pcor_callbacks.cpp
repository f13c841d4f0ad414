// Code that a host needs for pcor in its table of derived variables.
#include "pcor_callbacks.hpp"

#include <cmath>

#include <pcor/realtime/nimbus.hpp>

namespace {

using pcor::Quantity;

// There is no `time` input: the host passes no time to a callback, and a clock made from the host's date
// costs more than the correction. pcor then counts samples; the host calls `pcor_reset` after omitted
// samples.
struct Host {
  using Entry = DERTBL;
  static double get(Entry* entry, std::size_t input) {
    const float value = GetSample(entry, input);
    return value == -32767.0F ? std::nan("") : static_cast<double>(value);
  }
  static void put(Entry* entry, double value) { PutSample(entry, static_cast<float>(value)); }
  static bool high_rate() { return FeedBack == HIGH_RATE_FEEDBACK; }
};

struct FuselageTag;
using Fuselage = pcor::NimbusSystem<Host, FuselageTag>;

// The C-130's law of 2016 for PSFD and QCF: data/models/c130-psfd-2016.toml.
pcor::Model law_of_2016() {
  pcor::Model model;
  model.effects = {{"static-constant", {-4.389e-3}},
                   {"static-qp", {-2.966e-2}},
                   {"static-attack", {-6.831e-5}},
                   {"static-mach", {2.672e-2}},
                   {"static-alpha-quad", {2.447e-3}}};
  model.recovery = {{0.9959, 0.0283, 0.0374, 0.0762}};
  model.policy.taper_below = 40.0;
  return model;
}

}  // namespace

bool pcor_install(std::string* error) {
  pcor::Model model = law_of_2016();
  if (!pcor::check_defaults(model, "PCOR", DefaultNames(), pcor::Overrides::some, error)) return false;
  pcor::read_defaults(model, "PCOR", GetDefault);
  // The order of the dependencies of PCOR.
  return Fuselage::install(
      model, {"static_pressure", "dynamic_pressure", "recovery_temperature", "vapor_pressure", "attack"}, 1.0,
      25.0, error);
}

void pcor_reset() { Fuselage::reset(); }

extern "C" {
void spcor(DERTBL* entry) { Fuselage::compute(entry); }
void spsxc(DERTBL* entry) { Fuselage::fetch<Quantity::corrected_static_pressure>(entry); }
void sqcxc(DERTBL* entry) { Fuselage::fetch<Quantity::corrected_dynamic_pressure>(entry); }
void smachx(DERTBL* entry) { Fuselage::fetch<Quantity::corrected_mach>(entry); }
void satx(DERTBL* entry) { Fuselage::fetch<Quantity::ambient_temperature>(entry); }
void stasx(DERTBL* entry) { Fuselage::fetch<Quantity::corrected_airspeed>(entry); }
void spcorflag(DERTBL* entry) { Fuselage::fetch_quality(entry); }
}
