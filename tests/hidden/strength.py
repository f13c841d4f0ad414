"""How strong an effect is on a flight: what the fitted model cannot absorb of it, against the noise.

The same flights are simulated without noise, with the effect and without. The difference of their residuals, less
what the coefficients of the user's model can take over, has an rms of so many hPa for a unit of strength. Effects
are nearly linear; where the strength wanted is far from the one tried, it is tried again there.
"""

import hashlib
import json

import netCDF4
import numpy

import plans
import secret_effects


def read(path, *names):
    with netCDF4.Dataset(path) as file:
        return [numpy.ma.filled(file[name][:].astype(float), numpy.nan).ravel() for name in names]


def residual_of(tool, flight, model, folder, arguments=()):
    path = folder / "residuals.nc"
    tool.run("compare", flight, "-m", model, "--residuals", path, "--quiet", *arguments)
    (residual,) = read(path, "RESIDUAL_1")
    path.unlink()
    return residual


def columns_of(flight, aircraft, without):
    """What the coefficients of the user's model multiply, hPa."""
    p, q, a, qr, attack = read(flight, plans.STATIC[aircraft], "QCF", "ADIFR", "QCR", "ATTACK")
    with numpy.errstate(all="ignore"):
        mach = numpy.sqrt(5.0 * numpy.expm1(numpy.log1p(q / p) * 2.0 / 7.0))
        columns = {"static-constant": p, "static-alpha": p * a / qr, "static-qp": q, "static-mach3": p * mach**3,
                   "static-attack": p * attack}
    return numpy.array([columns[name] for name in plans.LAWS[aircraft] if name not in without]).T


def left_over(difference, columns):
    """The rms of what the columns do not explain of a difference of residuals, and of all of it."""
    used = numpy.isfinite(difference) & numpy.isfinite(columns).all(axis=1)
    x, y = columns[used], difference[used]
    scale = numpy.sqrt((x**2).mean(axis=0))
    coefficients = numpy.linalg.lstsq(x / scale, y, rcond=None)[0]
    rest = y - x / scale @ coefficients
    return float(numpy.sqrt((rest**2).mean())), float(numpy.sqrt((y**2).mean()))


class Calibration:
    """The rms that effects leave on the training flights of a plan, remembered in a folder."""

    def __init__(self, tool, folder, cache):
        self.tool, self.folder, self.cache = tool, folder, cache
        self.bare = {}

    def flight(self, name, text):
        scenario, flight = self.folder / f"{name}.toml", self.folder / f"{name}.nc"
        scenario.write_text(text)
        self.tool.run("simulate", scenario, "-o", flight, "--quiet")
        return flight

    def without_effect(self, plan, part, without, arguments):
        key = (plan, part, without, arguments)
        if key not in self.bare:
            flight = self.flight("bare", plans.scenario_text(plan, part, 1, noiseless=True, without=without))
            model = self.folder / "right.toml"
            model.write_text(plans.model_text(plan.aircraft, without))
            residual = residual_of(self.tool, flight, model, self.folder, arguments)
            self.bare[key] = residual, columns_of(flight, plan.aircraft, without)
            flight.unlink()
        return self.bare[key]

    def rms_of(self, secret, plan, strength):
        """The rms on both training flights, hPa, of what `strength` of the effect leaves, and of all that it does."""
        without = secret_effects.lacking(secret, plans.LAWS[plan.aircraft])
        effects = secret.text(plan.aircraft, strength)
        texts = [plans.scenario_text(plan, part, 1, effects=effects, noiseless=True, without=without)
                 for part in (0, 1)]
        model_text = plans.model_text(plan.aircraft, without, secret.moist)
        key = hashlib.sha1(json.dumps([*texts, model_text, secret.arguments]).encode()).hexdigest()
        remembered = self.cache / key
        if remembered.exists():
            return json.loads(remembered.read_text())
        differences, columns = [], []
        model = self.folder / "user.toml"
        model.write_text(model_text)
        for part, text in enumerate(texts):
            bare, column = self.without_effect(plan, part, without, secret.arguments)
            flight = self.flight("with", text)
            differences.append(residual_of(self.tool, flight, model, self.folder, secret.arguments) - bare)
            columns.append(column)
            flight.unlink()
        rms = left_over(numpy.concatenate(differences), numpy.concatenate(columns))
        part = remembered.with_suffix(f".{id(self)}")
        part.write_text(json.dumps(rms))
        part.replace(remembered)
        return rms

    def strength_of(self, secret, plan, rms):
        """The strength that leaves an rms in hPa, what it really leaves, and whether it would have to be beyond
        all sizes met, in which case the strength is the limit."""
        if not secret.scalable:
            return 0.0, self.rms_of(secret, plan, 0.0)[0], False
        tried = secret.usual
        left, whole = self.rms_of(secret, plan, tried)
        most = min(secret_effects.LIMIT, secret_effects.LARGEST / max(whole, 1e-9))
        if left * most <= rms:
            return most * tried, left * most, True
        strength = tried * rms / left
        if not 0.2 < rms / left < 2.5:
            strength *= rms / self.rms_of(secret, plan, strength)[0]
        return strength, rms, False
