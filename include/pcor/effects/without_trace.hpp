#pragma once

#include <array>
#include <string_view>

namespace pcor {

/// A known effect that no coefficient of a model can describe, and why.
struct EffectWithoutTrace {
  std::string_view id;
  std::string_view title;
  std::string_view reason;
};

/// The effects that are known but leave no trace on single samples that a term of the model could follow.
inline constexpr std::array<EffectWithoutTrace, 23> effects_without_trace{{
    {"aircraft-change", "skin, paint, port or pod changed between campaigns",
     "within one state of the aircraft nothing varies: it is a new model with its own date, which a refit on "
     "the later flights makes; what of it is a step of delta-p between flights is aircraft-step"},
    {"pitot-blockage", "ice or water in the pitot tube",
     "the total pressure then follows the obstacle and not the air: such samples are found by the second "
     "pitot and left out, not corrected"},
    {"radome-port-ice", "frozen port of the radome, or a default angle in its place",
     "the angle of attack is then not measured at all: such samples are left out"},
    {"lams-resolution", "noise and steps of the laser's spectrum",
     "it is noise of zero mean: it widens the residual and shifts no coefficient"},
    {"lams-fold", "wrong Nyquist fold of the laser's signal",
     "the airspeed is then another one altogether: samples near the fold are left out, and the retrieval is "
     "repaired"},
    {"lams-volume", "laser and pitot feel different air in turbulence",
     "it is noise of zero mean that turbulence makes: it widens the residual and shifts no coefficient"},
    {"lams-tas-lock", "search window of the laser follows the airspeed of the pressures",
     "the laser then repeats the pressures: no residual is left that could show it, but the beam's spectra "
     "do"},
    {"avionics-filter", "filter and delay of a redundant source",
     "it is of the source that is compared with and not of the pressures that are corrected"},
    {"horizontal-gradient", "slope of the isobars along the track",
     "it is of the atmosphere: it moves the height of the hydrostatic check and no pressure"},
    {"hydrostatic-t-gradient", "temperature of the column differs from that along the track",
     "it is of the atmosphere: it moves the height of the hydrostatic check and no pressure"},
    {"wind-change", "wind differs between the legs",
     "it is of the atmosphere: it moves the sum of two reverse-heading winds and no pressure"},
    {"mach-source", "Mach number of another pressure pair in the law",
     "it is an error of configuration: give the role mach the variable that the law was fitted with"},
    {"pcor-regime", "wrong set of coefficients, sign or taper",
     "it is an error of configuration: compare the published models with each other"},
    {"line-resonance", "resonance of the pressure lines",
     "it acts at frequencies above 1 Hz alone and has a zero mean over the samples that are fitted"},
    {"real-gas-cp", "specific heats of air are not exactly those of an ideal gas",
     "the constants are part of the physics and no coefficient: below 0.07 hPa, and of the shape of "
     "lams-scale"},
    {"gravity-geopotential", "geometric height taken for a geopotential one",
     "it moves the height of the hydrostatic check and no pressure"},
    {"non-hydrostatic", "vertical acceleration of the air",
     "it moves the height of the hydrostatic check and no pressure"},
    {"gps-height", "noise and steps of the GPS height",
     "it moves the height of the hydrostatic check and no pressure"},
    {"vspd-baro", "vertical speed from a pressure altitude",
     "it moves the angle of attack of reference, from pitch and vertical speed, and no pressure"},
    {"heading-offset", "error of the heading", "it moves the wind of reverse-heading legs and no pressure"},
    {"lams-dropout", "laser without signal where aerosol is thin",
     "samples are missing, and a missing one has no error; they are missing more often high up, which the "
     "regimes of a comparison show"},
    {"ground-return", "downward beam hits the ground",
     "the airspeed is then that of the ground: such samples are left out"},
    {"propeller-inflow", "suction of the propellers ahead of the laser",
     "below 0.1 m/s by estimate, and a constant part of the airspeed: it is part of lams-scale"},
}};

}  // namespace pcor
