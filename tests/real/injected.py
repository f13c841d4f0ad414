"""Hidden effects as changes of recorded series, and the effects that count as correct.

An effect of the first static port decreases PSFD and increases QCF and QCR; an effect of the second port decreases PSFRD and
increases QCFR. `right` lists correct ids; ids of the second system start with "reference:". The catalogue only approximates
a foreign shape, so all effects of its family count as correct.
"""

from dataclasses import dataclass

import numpy

from air import standard


@dataclass(frozen=True)
class Hidden:
    name: str
    change: object  # change(air, series, size) modifies the series
    right: tuple = ()
    probe: float = 0.1  # size at which the residual is nearly linear in the size
    traced: tuple = ()  # correct variables, for causes outside the catalogue


def port(series, delta, other=False):
    static, *dynamic = ("PSFRD", "QCFR") if other else ("PSFD", "QCF", "QCR")
    series[static] = series[static] - delta
    for name in dynamic:
        series[name] = series[name] + delta


def at_port(name, right, shape, other=False):
    """Effect at a static port: delta-p is size * shape(air), hPa; the shapes are of the order of 1."""
    right = (right,) if isinstance(right, str) else right
    return Hidden(name, lambda air, series, size: port(series, size * shape(air), other),
                  tuple("reference:" + each for each in right) if other else right)


def on(name, variable, shape, right, probe=0.1, also=()):
    def change(air, series, size):
        error = size * shape(air)
        for target, factor in ((variable, 1), *also):
            series[target] = series[target] + factor * error
    return Hidden(name, change, right, probe)


def lagged(values, tau):
    """A first-order filter of a series that is linear between its samples."""
    values = numpy.where(numpy.isfinite(values), values, numpy.nanmean(values))
    if abs(tau) < 1e-9:
        return values
    made, keep = values.copy(), numpy.exp(-1 / abs(tau))
    for number in range(1, len(values)):
        slope = values[number] - values[number - 1]
        made[number] = values[number] - abs(tau) * slope + keep * (made[number - 1] - values[number - 1] + abs(tau) * slope)
    return values + numpy.sign(tau) * (made - values)


def of_lag(name, variable, right, probe=0.5, twice=False, extra=None):
    def change(air, series, size):
        before = series[variable]
        after = lagged(lagged(before, size / 2), size / 2) if twice else lagged(before, size)
        series[variable] = after
        if extra:
            series[extra] = series[extra] - (after - before)
    return Hidden(name, change, right, probe)


ATTACK = ("static-alpha-quad", "static-attack", "static-alpha")
DRIFT = ("time-drift", "psfd-drift")
alpha = lambda air: air.raw["ATTACK"]
beta = lambda air: air.raw["SSLIP"]
load = lambda air: air.raw["ACINS"] / 9.80665
roll = lambda air: numpy.sin(numpy.radians(air.raw["ROLL"]))
constant = lambda air: numpy.ones(air.size)
smooth = lambda x, n=5: numpy.convolve(numpy.pad(x, n // 2, mode="edge"), numpy.ones(n) / n, "valid")


def turn_rate(air):
    heading = numpy.unwrap(numpy.radians(air.raw["THDG"]))
    return numpy.gradient(smooth(heading)) * 30


def inertial_attack(air):
    """Angle of attack from pitch and vertical speed, deg, without the radome."""
    return air.raw["PITCH"] - numpy.degrees(air.raw["VSPD"] / numpy.maximum(air.raw["TASX"], 40))


PORT = {  # shapes of the catalogue
    "static-alpha-quad": lambda air: air.q * alpha(air) ** 2 / 1000,
    "static-beta-odd": lambda air: air.p * air.side / 80,
    "static-beta-even": lambda air: air.p * beta(air) ** 2 / 800,
    "load-factor": lambda air: load(air) * 30,
    "roll-static": lambda air: roll(air) * 7,
    "time-drift": lambda air: air.hours,
}
PORT_FOREIGN = {  # name: (correct ids, shape)
    "attack that saturates": (ATTACK, lambda air: air.q / 60 * numpy.tanh((alpha(air) - 3.2) / 0.6)),
    "attack with a knee": (ATTACK, lambda air: air.q / 60 * numpy.maximum(alpha(air) - 4.2, 0)),
    "attack by pitch and climb": (ATTACK, lambda air: air.q * inertial_attack(air) ** 2 / 1000),
    "sideslip that saturates": ("static-beta-odd", lambda air: numpy.tanh(air.side / 0.04)),
    "sideslip with a knee": ("static-beta-even", lambda air: numpy.maximum(numpy.abs(beta(air)) - 0.6, 0)),
    "load factor by q, with a knee": ("load-factor", lambda air: air.q / 60 * numpy.maximum(load(air), -0.01) * 30),
    "roll that saturates": ("roll-static", lambda air: numpy.tanh(roll(air) / 0.08)),
    "roll by the rate of turn": ("roll-static", turn_rate),
    "drift that settles": (DRIFT, lambda air: numpy.exp(-air.hours * 3)),
}
OWN = [at_port(name, DRIFT if name == "time-drift" else name, shape) for name, shape in PORT.items()] + [
    of_lag("static-lag", "PSFD", ("static-lag",), extra="QCF"),
    on("static-leak", "PSFD", lambda air: (air.raw["PCAB"] - air.p) / 50, ("static-leak",), also=(("QCF", -1),)),
    on("psfd-bias", "PSFD", constant, ("psfd-bias",)),
    on("psfd-drift", "PSFD", lambda air: air.hours, DRIFT)]
OWN_FOREIGN = [at_port(name, *rest) for name, rest in PORT_FOREIGN.items()] + [
    of_lag("lag of second order", "PSFD", ("static-lag",), extra="QCF", twice=True),
    on("leak by the cabin pressure alone", "PSFD", lambda air: numpy.sqrt(air.raw["PCAB"] / 2), ("static-leak",),
       also=(("QCF", -1),))]
OTHER = [at_port(f"other {name}", DRIFT if name == "time-drift" else name, shape, True) for name, shape in PORT.items()]
OTHER += [on("other psfd-bias", "PSFRD", constant, ("reference:psfd-bias",)),
          of_lag("other static-lag", "PSFRD", ("reference:static-lag",), extra="QCFR")]
OTHER_FOREIGN = [at_port(f"other {name}", *rest, True) for name, rest in PORT_FOREIGN.items()]
LASER = [at_port(name, DRIFT if name == "time-drift" else name, shape) for name, shape in PORT.items()] + [
    on("qcf-zero", "QCF", constant, ("qcf-zero",)), on("qcf-drift", "QCF", lambda air: air.hours, ("qcf-drift",)),
    on("pitot-angle", "QCF", lambda air: -air.q * (alpha(air) ** 2 + beta(air) ** 2) / 1500, ("pitot-angle",)),
    of_lag("total-lag", "QCF", ("total-lag", "qcf-lag")),
    on("temp-offset", "TTX", constant, ("temp-offset", "recovery-factor")),
    on("temp-drift", "TTX", lambda air: air.hours, ("temp-drift",)), of_lag("temp-lag", "TTX", ("temp-lag",), 2.0),
    of_lag("clock-skew", "VLAMS", ("clock-skew",), 0.3),
    on("lams-scale", "VLAMS", lambda air: air.raw["TASX"] / 1000, ("lams-scale",)),
    on("lams-azimuth", "VLAMS", lambda air: air.raw["TASX"] * numpy.radians(beta(air)) / 50,
       ("lams-azimuth",)),
    on("lams-induction", "VLAMS", lambda air: air.raw["TASX"] * alpha(air) / 3000, ("lams-induction",))]
LASER_FOREIGN = [at_port(name, *rest) for name, rest in PORT_FOREIGN.items()] + [
    of_lag("thermometer lag of second order", "TTX", ("temp-lag",), 2.0, True),
    on("thermometer drift that settles", "TTX", lambda air: numpy.exp(-air.hours * 3), ("temp-drift",)),
    on("pitot with a knee", "QCF", lambda air: -numpy.maximum(alpha(air) ** 2 + beta(air) ** 2 - 12, 0) / 10,
       ("pitot-angle",))]

# Recorded causes outside the catalogue: variable, shape of the standardised series
SHAPES = {"line": lambda x: x, "square": lambda x: x**2 - 1, "step": lambda x: (x > 0) * 2.0, "wave": lambda x: numpy.sin(2 * x)}
CAUSES = (("SWT", "line"), ("RSTT", "line"), ("XUCIT1", "line"), ("GGTRK", "wave"), ("PTMP_RPO", "square"),
          ("FTMP_RWO", "line"), ("INTEMP", "line"), ("RDMATEMP_FCR", "step"), ("XFO3T", "line"), ("RSTB", "step"),
          ("SWT", "square"), ("CNTEMP", "line"), ("GGVEW", "line"), ("IRT", "line"), ("XFO3FS", "square"))


def like(air, cause):
    """Recorded variables whose correlation with the cause exceeds 0.85; they count as correct."""
    base = cause[air.run]
    with numpy.errstate(all="ignore"):
        return tuple(name for name, values in air.raw.items() if abs(numpy.corrcoef(base, values[air.run])[0, 1]) > 0.85)


def outside(air, variable, shape, where):
    values = air.raw[variable]
    part = values[air.run]
    series = SHAPES[shape](numpy.clip((values - part.mean()) / part.std(), -5, 5)) / 3
    change = {"own": lambda air, made, size: port(made, size * series),
              "other": lambda air, made, size: port(made, size * series, True),
              "laser": lambda air, made, size: made.__setitem__("VLAMS", made["VLAMS"] + size * series)}[where]
    also = {"GGTRK": ("GGTRK", "THDG", "TKAT", "CTHDG", "heading", "ground_track")}.get(variable, ())
    return Hidden(f"{variable} {shape} ({where})", change, (), 0.1, (variable, *also, *like(air, values)))
