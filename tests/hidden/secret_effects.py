"""Hidden effects ("secrets") and the names that count as correct.

`usual` is a realistic or estimated size, in the parameter of the simulator or of the change to the records. The hidden size
is 0.3 to 20 times the usual size, limited to 6 hPa rms before the model absorbs a part.

The simulator applies most effects. Variants of shape and location are applied to its noiseless records (records.py) with
formulas that the library does not have: scaling with q instead of p, another power, or a zero, gain or drift of a static or
dynamic transducer, of the port, of the thermometer, or of the second static system.

Other names count as correct only if their physics is identical. Effects with a similar shape do not count; the tool must list
them as aliases.

| hidden effect | also correct | reason |
|---|---|---|
| clock-skew of QCF | qcf-lag, clock-skew | q(t - tau) equals a first-order lag of q, or a laser that is early by tau |
| sensor-response of QCF | qcf-lag, total-lag | lag of q; at constant p the lag of the total line |
| unknown, linear in ENGTRQ, static | speedbrake-thrust | same formula; the constant is in the model |
| static-attack | static-alpha | the angle of attack is linear in ADIFR/QCR |
| humidity-error of the dew point | humidity-error | another parameter of the same effect |
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy

MAX_RMS = 6.0  # hPa, before the model absorbs a part


@dataclass(frozen=True)
class Secret:
    name: str
    body: str = ""  # body of [[effect]] in the scenario; {s} is the size, STATIC the static pressure variable
    usual: float = 1.0
    truth: tuple = ()  # correct ids; empty: outside the catalogue
    static: bool = False  # acts at the static port
    both_signs: bool = False
    aircraft: tuple = ("C-130", "GV")
    moist: bool = True  # the user's model assumes moist air
    traced: tuple = ()  # variables that a trace may name, for effects outside the catalogue
    change: Callable = None  # change(records, size), for effects that the simulator does not have
    laser: bool = True  # the reference is the laser; otherwise the second static system

    @property
    def scalable(self):
        return self.moist

    @property
    def outside(self):
        return not self.truth

    def text(self, aircraft, strength):
        if not self.body:
            return ""
        static = {"C-130": "PSFD", "GV": "PSF"}[aircraft]
        body = self.body.replace("STATIC", static)
        return "[[effect]]\n" + body.replace("{s}", repr(float(strength)))


def effect(name, parameter, usual, on="", static=False, both_signs=False, truth=None, **rest):
    identity = name.split(" ")[0]
    body = f'id = "{identity}"\n' + (f'on = "{on}"\n' if on else "") + f"{parameter} = {{s}}"
    return Secret(name, body, usual, truth or (identity,), static, both_signs, **rest)


def static(name, parameter, usual, both_signs=True, **rest):
    return effect(name, parameter, usual, on="STATIC", static=True, both_signs=both_signs, **rest)


def unknown(of, shape, centre, scale, where="static", usual=0.3, traced=None, truth=()):
    body = (f'id = "unknown"\nwhere = "{where}"\n' + ('on = "STATIC"\n' if where == "static" else "") +
            f'of = "{of}"\nshape = "{shape}"\nstrength = {{s}}\ncentre = {centre}\nscale = {scale}')
    names = traced or ((of,) if of != "hidden" else ())
    return Secret(f"unknown {of} {shape} ({where})", body, usual, truth, where == "static", True, traced=names)


HEIGHT = ("GGALT", "RALT", "PS_A", "PSFD", "PSFRD", "PSF")

CATALOGUE = (
    # Effects in the law of the aircraft that the user's model does not have
    static("static-alpha", "a1", 0.004, aircraft=("C-130",)),
    static("static-qp", "a2", 0.03),
    static("static-attack", "a3", 0.0014, truth=("static-attack", "static-alpha"), aircraft=("C-130",)),
    static("static-alpha-quad", "a4", 0.0024),
    static("static-mach", "m1", 0.03),
    static("static-mach2", "m2", 0.02),
    static("static-mach3", "m3", 0.02, aircraft=("C-130",)),
    static("static-beta-odd", "b1", 0.0018),
    static("static-beta-even", "b2", 2e-5),
    static("static-transonic", "strength", 1.0, aircraft=("GV",)),
    static("flaps-gear", "defect", 1.5),
    static("speedbrake-thrust", "defect", 0.5),
    static("ground-effect", "defect", 0.3),
    static("load-factor", "per_g", 1.0),
    static("roll-static", "defect", 0.3),
    effect("pitot-angle", "k", 1e-4, on="QCF"),
    effect("static-lag", "tau", 0.2, on="STATIC"),
    effect("total-lag", "tau", 0.2, on="QCF"),
    effect("static-leak", "fraction", 5e-4, on="STATIC"),
    effect("line-head", "behind", 5.0, on="STATIC", both_signs=True),
    effect("qcf-zero", "offset", 0.3, on="QCF", both_signs=True),
    effect("qcf-gain", "gain", 0.005, on="QCF", both_signs=True),
    effect("psfd-bias", "offset", 0.1, on="STATIC", both_signs=True),
    effect("transducer-thermal", "dynamic", 0.02, on="QCF", both_signs=True),
    effect("time-drift of QCF", "dynamic", 0.2, on="QCF", both_signs=True, truth=("qcf-drift",)),
    effect("qcr-angle", "attack", 0.0273),
    effect("adif-drift per hour", "per_hour", 0.005, both_signs=True, truth=("adif-drift",)),
    effect("lams-elevation", "error", 0.5, both_signs=True),
    effect("lams-azimuth", "error", 0.5, both_signs=True),
    effect("lams-pod-flex", "per_tonne", 0.005, both_signs=True),
    effect("lams-scale", "scale", 1e-3, both_signs=True),
    effect("lams-induction", "per_attack", 5e-4, both_signs=True),
    effect("lams-cloud", "error", -0.5),
    effect("temp-offset", "offset", 0.5, both_signs=True),
    effect("recovery-factor", "error", 0.02, both_signs=True),
    effect("temp-lag", "tau", 2.3),
    effect("temp-deice-heat", "heat", 0.5),
    effect("temp-wetting", "error", -1.0),
    effect("humidity-error", "gain", 0.1, both_signs=True),
    effect("humidity-error of the dew point", "dew_point", 2.0, both_signs=True, truth=("humidity-error",)),
    effect("clock-skew", "seconds", 0.5, on="VLAMS", both_signs=True),
    effect("clock-skew of QCF", "seconds", 0.3, on="QCF", truth=("qcf-lag", "clock-skew")),
    effect("sensor-response of QCF", "tau", 0.3, on="QCF", truth=("qcf-lag", "total-lag")),
    Secret("humidity-neglected", truth=("humidity-neglected",), moist=False),
    unknown("ENGTRQ", "linear", 50, 100, truth=("speedbrake-thrust",)),
)

OUTSIDE = (
    unknown("ENGTRQ", "sine", 50, 8),
    unknown("ENGTRQ", "step", 55, 1),
    unknown("ENGTRQ", "quadratic", 40, 25),
    unknown("PCAB", "quadratic", 870, 60),
    unknown("TBAY", "sine", 283, 2.0),
    unknown("GGALT", "step", 4200, 1, traced=HEIGHT),
    unknown("GGLAT", "sine", 40, 0.1),
    unknown("THDG", "sine", 0, 57.3, traced=("THDG", "GGTRK")),
    unknown("GGVSPD", "quadratic", 0, 5),
    unknown("TBAY", "step", 282, 1, where="temperature", usual=0.5),
    unknown("TASX", "sine", 0, 4, where="lams", traced=("TASX", "VLAMS", "QCF", "QC_A", "MACH_A", "QCFR", "QCR")),
    unknown("hidden", "linear", 0, 1),
    unknown("hidden", "linear", 0, 1, where="lams"),
    unknown("hidden", "sine", 0, 0.5, where="temperature", usual=0.5),
)

PAIRS = (
    ("static-lag", "static-beta-odd"), ("static-alpha-quad", "time-drift of QCF"), ("load-factor", "lams-cloud"),
    ("total-lag", "roll-static"), ("speedbrake-thrust", "clock-skew"), ("static-beta-even", "temp-lag"),
)


def variant(name, usual, change, truth=None, **rest):
    """The first word of `name` is the correct id unless `truth` is given; the other words describe the variant."""
    return Secret(name, "", usual, truth or (name.split(" ")[0],), both_signs=True, change=change, **rest)


VARIANTS = (
    # Other shapes: q instead of p or p instead of q; another power
    variant("static-alpha by q", 0.03, lambda flight, s: flight.port(s * flight.q * flight.attack), static=True),
    variant("static-beta-odd by q", 0.012, lambda flight, s: flight.port(s * flight.q * flight.sideslip), static=True),
    variant("static-beta-even by q", 1.4e-4, lambda flight, s: flight.port(s * flight.q * flight.beta**2), static=True),
    variant("static-beta-even of power 4", 2e-6, lambda flight, s: flight.port(s * flight.p * flight.beta**4),
            static=True),
    variant("static-alpha-quad by p", 4e-4, lambda flight, s: flight.port(s * flight.p * flight.attack**2),
            static=True),
    variant("load-factor by q", 0.01, lambda flight, s: flight.port(s * flight.q * flight.extra_load), static=True),
    variant("roll-static by q", 0.003, lambda flight, s: flight.port(s * flight.q * numpy.sin(flight.roll)),
            static=True),
    variant("pitot-angle of power 4", 1e-5,
            lambda flight, s: flight.pitot(s * flight.q * (flight.alpha**2 + flight.beta**2) ** 2)),
    variant("pitot-angle of a tube that points 3 deg up", 1e-4,
            lambda flight, s: flight.pitot(s * flight.q * ((flight.alpha - 3) ** 2 + flight.beta**2))),
    # Other locations
    variant("psfd-gain", 2e-4, lambda flight, s: flight.add(flight.static, s * flight.p)),
    variant("psfd-drift", 0.1, lambda flight, s: flight.add(flight.static, s * flight.hours)),
    variant("psfd-thermal", 0.01, lambda flight, s: flight.add(flight.static, s * (flight.bay - 290))),
    variant("time-drift of the port", 2e-4, lambda flight, s: flight.port(s * flight.p * flight.hours), static=True),
    variant("temp-drift", 0.3, lambda flight, s: flight.add(flight.thermometer, s * flight.hours)),
    variant("aircraft-step", 3e-4, lambda flight, s: flight.port(s * flight.p * (flight.part > 0)), static=True),
)


def of_other(name, usual, change):
    """Fault of the second static system of the C-130."""
    return variant(f"{name} of the other system", usual, change, (f"reference:{name}",), aircraft=("C-130",))


OTHER = (
    of_other("psfd-bias", 0.2, lambda flight, s: flight.add("PSFRD", s)),
    of_other("psfd-drift", 0.1, lambda flight, s: flight.add("PSFRD", s * flight.hours)),
    of_other("qcf-gain", 0.005, lambda flight, s: flight.add("QCFR", s * flight.q)),
    of_other("static-beta-odd", 0.0018, lambda flight, s: flight.other_port(s * flight.p * flight.sideslip)),
    of_other("static-alpha-quad", 0.0024, lambda flight, s: flight.other_port(s * flight.q * flight.attack**2)),
)


def without_laser(secret):
    return replace(secret, name=f"{secret.name}, no laser", laser=False, aircraft=("C-130",))


OWN = ("static-beta-odd", "static-alpha-quad", "static-lag", "flaps-gear", "psfd-bias", "psfd-drift", "load-factor",
       "static-beta-even by q")
TWO_SYSTEMS = tuple(without_laser(secret) for secret in (*CATALOGUE, *VARIANTS, *OTHER)
                    if secret.name in OWN or secret in OTHER)
BY_NAME = {secret.name: secret for secret in (*CATALOGUE, *VARIANTS, *OTHER, *TWO_SYSTEMS, *OUTSIDE)}


def lacking(secret, law):
    """Effects of the law that flights and the user's model lack, because the secret is the same effect."""
    return tuple(name for name in law if name == secret.name)
