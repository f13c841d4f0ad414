"""Real flight without noise: its corrected pressures are the truth; its noise is stored separately."""

import os
import zlib
from pathlib import Path

import netCDF4
import numpy

FLIGHT = "GOTEX-rf06-C130-2004.nc"
LAW = (0.0033746, 0.0179237, 0.0415025)  # a0, a1, a2 of the first system, from least squares on this flight
OTHER_LAW = (0.002047, 0.008890, 0.07119)  # of the second system, equation 18 of the memo
# Variables that nimbus computed from recorded pressures; they would reveal the changes of a case.
COMPUTED = {"PSFC", "PSFDC", "PSX", "PSXC", "PSFD1", "PSFD2", "PSURF", "QCFC", "QCFRC", "QCRC", "QCX", "QCXC", "XMACH2", "PCONE"}
ROLES = {"recovery_temperature": "TTX", "vapor_pressure": "EDPC", "radome_dynamic_pressure": "QCR",
         "attack_differential_pressure": "ADIFR", "sideslip_differential_pressure": "BDIFR", "attack": "ATTACK",
         "sideslip": "SSLIP", "altitude": "GGALT", "vertical_speed": "VSPD", "roll": "ROLL", "pitch": "PITCH",
         "heading": "THDG", "latitude": "GGLAT", "normal_acceleration": "ACINS", "cabin_pressure": "PCAB",
         "height_above_ground": "HGM232", "liquid_water": "PLWCC"}


def model_text(pair, law, laser=False):
    roles = {"static_pressure": pair[0], "dynamic_pressure": pair[1]} | ROLES | ({"lams_airspeed": "VLAMS"} if laser else {})
    terms = zip(("static-constant", "static-alpha", "static-qp"), ("a0", "a1", "a2"), law)
    return "\n".join(['format = "pcor-model/1"', 'aircraft = "C-130 N130AR"', "[variables]",
                      *(f'{role} = "{name}"' for role, name in roles.items()),
                      *(["[lams]", "elevation = 0.0", "azimuth = 0.0"] if laser else []),
                      "[temperature]", "recovery_factor = 0.95", "[humidity]", "moist = true",
                      *(f'[[effect]]\nid = "{name}"\nparameters = {{ {key} = {value!r} }}' for name, key, value in terms), ""])


def generator(*words):
    return numpy.random.default_rng(zlib.crc32(" ".join(map(str, words)).encode()))


def standard(series):
    return (series - series.mean()) / series.std()


def least_squares_residual(y, columns):
    scaled = columns / numpy.sqrt((columns**2).mean(axis=0))
    return y - scaled @ numpy.linalg.lstsq(scaled, y, rcond=None)[0]


class Air:
    """Recorded series, truth, and noise of the difference between the second and the first system."""

    run = slice(140, 2499)  # samples in flight, flaps retracted, without gaps

    def __init__(self):
        self.path = Path(os.environ["PCOR_FLIGHTS"]) / FLIGHT
        with netCDF4.Dataset(self.path) as file:
            self.raw = {name: numpy.ma.filled(file[name][:].astype(float), numpy.nan) for name in file.variables
                        if file[name].ndim == 1 and file[name].dtype.kind == "f"}
        raw = self.raw
        self.size = len(raw["PSFD"])
        self.hours = numpy.arange(self.size) / 3600
        with numpy.errstate(all="ignore"):
            self.ratio = numpy.where(raw["QCR"] > 5, raw["ADIFR"] / raw["QCR"], 0.0)
            self.side = numpy.where(raw["QCR"] > 5, raw["BDIFR"] / raw["QCR"], 0.0)
        delta = raw["PSFD"] * (LAW[0] + LAW[1] * self.ratio) + LAW[2] * raw["QCF"]
        self.p, self.q = raw["PSFD"] + delta, raw["QCF"] - delta
        self.law = numpy.array([raw["PSFD"], raw["PSFD"] * self.ratio, raw["QCF"]])[:, self.run].T
        other = raw["PSFRD"] * (1 + OTHER_LAW[0] + OTHER_LAW[1] * self.ratio) + OTHER_LAW[2] * raw["QCFR"]
        structure = numpy.column_stack([self.law, *(x[self.run] for x in (
            raw["QCF"] * self.ratio, raw["QCF"] * raw["ATTACK"] ** 2, self.hours))])
        self.static_noise = least_squares_residual((other - self.p)[self.run], structure)
        self.total_noise = least_squares_residual((raw["PSFRD"] + raw["QCFR"] - raw["PSFD"] - raw["QCF"])[self.run], structure)
        self.covariance_root = root_of(self.static_noise)

    def surrogate(self, noise, how, draw):
        """Noise with the autocorrelation of `noise` that is not correlated with the flight."""
        ramp = numpy.linspace(noise[0], noise[-1], len(noise))
        noise = noise - ramp + ramp.mean()  # periodic
        if how == "shift":
            made = numpy.roll(noise, draw.integers(150, len(noise) - 150))
        elif how == "phases":
            spectrum = numpy.fft.rfft(noise - noise.mean())
            made = numpy.fft.irfft(numpy.abs(spectrum) * numpy.exp(2j * numpy.pi * draw.random(len(spectrum))), len(noise))
        elif how == "signs":  # segments of at least 30 s between zeros
            made, sign, begin = numpy.roll(noise - noise.mean(), draw.integers(150, len(noise) - 150)), 1, 0
            zeros = numpy.flatnonzero(numpy.diff(numpy.sign(made))) + 1
            for end in [*zeros, len(made)]:
                if end - begin >= 30 or end == len(made):
                    sign = draw.choice((-1, 1))
                    made[begin:end] *= sign
                    begin = end
        elif how == "fast":  # without changes slower than 31 s
            made = numpy.roll(noise, draw.integers(150, len(noise) - 150))
            made = made - numpy.convolve(numpy.pad(made, 15, mode="reflect"), numpy.ones(31) / 31, "valid")
        else:
            made = numpy.zeros_like(noise)
        whole = numpy.zeros(self.size)
        whole[self.run] = made
        whole[self.run.stop:] = made[:self.size - self.run.stop]
        return whole

    def series(self, noise=None, total=None):
        """Series of a flight whose second system follows its law, with added noise of static and total pressure, hPa."""
        made, zero = dict(self.raw), numpy.zeros(self.size)
        noise, total = (zero if x is None else x for x in (noise, total))
        whole = self.p + self.q + total
        a0, a1, a2 = OTHER_LAW
        made["PSFRD"] = (self.p + noise - a2 * whole) / (1 + a0 + a1 * self.ratio - a2)
        made["QCFR"] = whole - made["PSFRD"]
        return made

    def oracle_z(self, column):
        """z of the size of a known column, fitted together with the law under the recorded noise."""
        white = numpy.linalg.solve(self.covariance_root, numpy.column_stack([self.law, column[self.run]]))
        return float(numpy.linalg.norm(least_squares_residual(white[:, 3], white[:, :3])))

    def write(self, path, series):
        with netCDF4.Dataset(self.path) as file, netCDF4.Dataset(path, "w") as copy:
            file.set_auto_maskandscale(False)
            copy.createDimension("Time", self.size)
            copy.setncatts({name: file.getncattr(name) for name in file.ncattrs()})
            for name, old in file.variables.items():
                if old.ndim > 1 or name in COMPUTED:
                    continue
                keep = {key: old.getncattr(key) for key in old.ncattrs()}
                fill = keep.pop("_FillValue", None)
                changed = name in series and series[name] is not self.raw[name]
                new = copy.createVariable(name, "f8" if changed else old.dtype, ("Time",) * old.ndim, fill_value=fill)
                new.set_auto_maskandscale(False)
                new.setncatts(keep)
                new[...] = numpy.nan_to_num(series[name], nan=-32767.0) if changed else old[...]
            if "VLAMS" in series:
                new = copy.createVariable("VLAMS", "f8", ("Time",), fill_value=-32767.0)
                new.setncatts({"units": "M/s", "long_name": "Airspeed along the laser beam"})
                new[:] = numpy.nan_to_num(series["VLAMS"], nan=-32767.0)


def root_of(noise, max_lag=400):
    """Cholesky root of the covariance, from the autocorrelation up to `max_lag` seconds."""
    centred, size = noise - noise.mean(), len(noise)
    lags = numpy.array([centred[k:] @ centred[:size - k] for k in range(max_lag)]) / size
    lags = numpy.concatenate([lags * (1 - numpy.arange(max_lag) / max_lag), numpy.zeros(size - max_lag)])
    index = numpy.abs(numpy.subtract.outer(numpy.arange(size), numpy.arange(size)))
    return numpy.linalg.cholesky(lags[index] + 1e-6 * numpy.eye(size))


def with_memory(kind, size, draw):
    """Noise with standard deviation 1: `kind` is "1/f" or the time constant of an Ornstein-Uhlenbeck process, s."""
    if kind == "1/f":
        spectrum = numpy.fft.rfft(draw.standard_normal(size))
        return standard(numpy.fft.irfft(spectrum / numpy.sqrt(numpy.maximum(numpy.arange(len(spectrum)), 1)), size))
    keep = numpy.exp(-1 / float(kind))
    made, shocks = numpy.zeros(size), draw.standard_normal(size) * numpy.sqrt(1 - keep**2)
    value = draw.standard_normal()
    for number in range(size):
        value = keep * value + shocks[number]
        made[number] = value
    return made
