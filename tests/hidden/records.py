"""Recorded series of a flight, changed at the location of an error: a port, a transducer, a thermometer.

delta-p is added to the measured static pressure and subtracted from the measured dynamic pressure. So an error of the static
port that requires delta-p decreases the measured static pressure and increases the measured dynamic pressure.
"""

import netCDF4
import numpy


class Records:
    """Series of a flight simulated without noise, including the true values."""

    def __init__(self, path, part):
        self.part = part  # number of the flight
        with netCDF4.Dataset(path) as file:
            self.values = {name: numpy.ma.filled(file[name][:].astype(float), numpy.nan) for name in file.variables
                           if file[name].dtype.kind == "f"}
        self.path, self.changed = path, set()
        self.static = "PSFD" if "PSFD" in self.values else "PSF"
        self.thermometer = "TTRR" if "TTRR" in self.values else "TTHR1"
        self.p, self.q, self.mach = (self.values[f"TRUE_{name}"] for name in ("PS", "QC", "MACH"))
        self.alpha, self.beta = self.values["TRUE_ALPHA"], self.values["TRUE_BETA"]  # deg
        with numpy.errstate(all="ignore"):
            flown = self.values["QCR"] > 20  # hPa
            self.attack = numpy.where(flown, self.values["ADIFR"] / self.values["QCR"], 0.0)
            self.sideslip = numpy.where(flown, self.values["BDIFR"] / self.values["QCR"], 0.0)
        self.hours = numpy.arange(len(self.p)) / 3600.0
        self.extra_load = self.values["TRUE_NORMA"] / 9.80665  # normal acceleration minus 1 g, g
        self.roll = numpy.radians(self.values["ROLL"])
        self.bay = self.values["TBAY"] + 273.15  # temperature of the transducers, K

    def add(self, name, error):
        self.values[name] = self.values[name] + error
        self.changed.add(name)

    def port(self, delta_p):
        """Error of the static port of the first system, hPa; the radome uses the same static pressure."""
        self.add(self.static, -delta_p)
        self.add("QCF", delta_p)
        self.add("QCR", delta_p)

    def other_port(self, delta_p):
        self.add("PSFRD", -delta_p)
        self.add("QCFR", delta_p)

    def pitot(self, loss):
        self.add("QCF", -loss)

    def write(self):
        with netCDF4.Dataset(self.path, "a") as file:
            for name in self.changed:
                file[name][:] = numpy.ma.masked_invalid(self.values[name])


def without_truth(flight, kept):
    """Removes the variables and attributes that only a simulator has. The complete file is moved to `kept` unless None."""
    with netCDF4.Dataset(flight) as file:
        file.set_auto_maskandscale(False)
        recorded = flight.with_name("recorded.nc")
        with netCDF4.Dataset(recorded, "w") as copy:
            copy.set_fill_off()
            for name, dimension in file.dimensions.items():
                copy.createDimension(name, None if dimension.isunlimited() else len(dimension))
            removed = ("simulation_effects", "simulation_legs", "history")
            copy.setncatts({name: file.getncattr(name) for name in file.ncattrs() if name not in removed})
            for name, variable in file.variables.items():
                if name.startswith("TRUE_"):
                    continue
                attributes = {key: variable.getncattr(key) for key in variable.ncattrs()}
                made = copy.createVariable(name, variable.dtype, variable.dimensions, chunksizes=[len(variable)],
                                           fill_value=attributes.pop("_FillValue", None))
                made.set_auto_maskandscale(False)
                made.setncatts(attributes)
                made[:] = variable[:]
    if kept is None:
        flight.unlink()
    else:
        flight.replace(kept)
    recorded.replace(flight)
