#pragma once

#include <array>
#include <string_view>

namespace pcor {

/// Known effect that no coefficient of a model can describe, and the reason.
struct EffectWithoutTrace {
  std::string_view id;
  std::string_view title;
  std::string_view reason;
};

template <class Field>
void describe(const EffectWithoutTrace& self, Field& field) {
  field("id", self.id, "id of the effect");
  field("title", self.title, "title of the effect");
  field("reason", self.reason, "reason for which no term of a model describes it");
}

/// Known effects that single samples cannot show, so that no term of the model can describe them.
inline constexpr std::array<EffectWithoutTrace, 23> effects_without_trace{{
    {"aircraft-change", "skin, paint, port or pod changed between campaigns",
     "nothing varies for one state of the aircraft: a refit on the later flights gives a new model with a "
     "separate date; a step of delta-p between flights is described by aircraft-step"},
    {"pitot-blockage", "ice or water in the pitot tube",
     "the total pressure then depends on the obstacle: such samples are detected by the second "
     "pitot and excluded, not corrected"},
    {"radome-port-ice", "frozen port of the radome, or a default angle in its place",
     "the angle of attack is then not measured: such samples are excluded"},
    {"lams-resolution", "noise and steps of the laser's spectrum",
     "noise of zero mean: increases the scatter of the residual without a bias of coefficients"},
    {"lams-fold", "wrong Nyquist fold of the laser's signal",
     "the airspeed is then wrong by a large amount: samples near the fold are excluded, and the retrieval is "
     "corrected"},
    {"lams-volume", "laser and pitot measure different air in turbulence",
     "noise of zero mean due to turbulence: increases the scatter of the residual without a bias of "
     "coefficients"},
    {"lams-tas-lock", "search window of the laser follows the airspeed of the pressures",
     "the laser then repeats the pressures: the residual cannot show it, but the beam's spectra do"},
    {"avionics-filter", "filter and delay of a redundant source",
     "error of the compared source, not of the corrected pressures"},
    {"horizontal-gradient", "slope of the isobars along the track",
     "property of the atmosphere: changes the height of the hydrostatic check but not the pressures"},
    {"hydrostatic-t-gradient", "temperature of the column differs from that along the track",
     "property of the atmosphere: changes the height of the hydrostatic check but not the pressures"},
    {"wind-change", "wind differs between the legs",
     "property of the atmosphere: changes the sum of two reverse-heading winds but not the pressures"},
    {"mach-source", "Mach number of another pressure pair in the law",
     "error of configuration: assign to the role mach the variable used in the fit of the law"},
    {"pcor-regime", "wrong set of coefficients, sign or taper",
     "error of configuration: compare the published models with each other"},
    {"line-resonance", "resonance of the pressure lines",
     "acts only at frequencies above 1 Hz and has a zero mean over the fitted samples"},
    {"real-gas-cp", "specific heats of air are not exactly those of an ideal gas",
     "the constants are part of the physics, not coefficients: below 0.07 hPa, and of the same shape as "
     "lams-scale"},
    {"gravity-geopotential", "geometric height used as geopotential height",
     "changes the height of the hydrostatic check but not the pressures"},
    {"non-hydrostatic", "vertical acceleration of the air",
     "changes the height of the hydrostatic check but not the pressures"},
    {"gps-height", "noise and steps of the GPS height",
     "changes the height of the hydrostatic check but not the pressures"},
    {"vspd-baro", "vertical speed from a pressure altitude",
     "changes the reference angle of attack, from pitch and vertical speed, but not the pressures"},
    {"heading-offset", "error of the heading",
     "changes the wind of reverse-heading legs but not the pressures"},
    {"lams-dropout", "laser without signal where aerosol is thin",
     "missing samples have no error; they are more frequent at high altitude, as the regimes of a comparison "
     "show"},
    {"ground-return", "downward beam hits the ground",
     "the airspeed is then that of the ground: such samples are excluded"},
    {"propeller-inflow", "suction of the propellers ahead of the laser",
     "estimated below 0.1 m/s, and a constant fraction of the airspeed: included in lams-scale"},
}};

}  // namespace pcor
