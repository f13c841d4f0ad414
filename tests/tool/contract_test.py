#!/usr/bin/env python3
"""For any input, `process` writes in every record a value, or a missing value and a bit that gives the reason.

    contract_test.py TOOL SOURCE_DIRECTORY

Each input of the model gets each kind of value that a file may contain, in separate records.
"""

import itertools
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import netCDF4
import numpy as np

TOOL = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()
MODEL = SOURCE / "data/scenarios/models/c130-psfd-eq18.toml"
FILL = -32767.0  # as NCAR's files have it

# Results derived from each input, and so missing with it. Without humidity the air counts as dry, and a bit
# is set.
OF_LASER = {"PCOR_LAMS", "ATLAMS", "QCLAMS"}
OF_MODEL = {"PCOR", "PSXC", "QCXC", "MACHX", "ATX", "TASX"}
FOUND_FROM = {
    "PSFD": OF_MODEL | OF_LASER,
    "QCF": OF_MODEL | OF_LASER,
    "TTRR": {"ATX", "TASX", "PCOR_LAMS", "QCLAMS"},
    "EDPC": set(),
    "QCR": OF_MODEL | {"ATLAMS", "QCLAMS"},
    "ADIFR": OF_MODEL | {"ATLAMS", "QCLAMS"},
    "ATTACK": OF_LASER,
    "SSLIP": OF_LASER,
    "VLAMS": OF_LASER,
}
RESULTS = sorted(OF_MODEL | OF_LASER)

# Invalid values, or values that no flight has, for any input.
NONE = {"the fill value": FILL, "NaN": np.nan, "infinity": np.inf, "minus infinity": -np.inf, "1e30": 1e30,
        "the usual fill value": netCDF4.default_fillvals["f8"], "1e300": 1e300, "-1e20": -1e20}
# Values that some input may have, and others may not.
ODD = {"zero": 0.0, "a denormal": 5e-324, "minus one": -1.0, "ten thousand": 1e4, "minus a thousand": -1e3}

# Limits of any air about an aircraft (hPa, 1, K or degC, m/s): far wider than flown.
POSSIBLE = {"PCOR": (-1100, 1100), "PCOR_LAMS": (-1100, 1100), "PSXC": (0, 1200), "QCXC": (0, 2000), "QCLAMS": (0, 2000),
            "MACHX": (0, 5), "ATX": (-150, 400), "ATLAMS": (-150, 400), "TASX": (0, 1500)}


def process(flight, output):
    subprocess.run([TOOL, "process", flight, "-m", MODEL, "-o", output, "--quiet"], check=True, capture_output=True)
    with netCDF4.Dataset(output) as file:
        results = {name: np.ma.filled(file[name][:].astype(float), np.nan) for name in RESULTS}
        return results, np.ma.filled(file["PCORFLAG"][:], 0)


class Contract(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        path = Path(cls.folder.name)
        subprocess.run([TOOL, "simulate", SOURCE / "data/scenarios/c130-short.toml", "-o", path / "flight.nc", "--quiet"],
                       check=True)
        cls.cases = {}  # of each spoilt record the input and the kind of its value
        with netCDF4.Dataset(path / "flight.nc") as flight, netCDF4.Dataset(path / "good.nc", "w") as good, \
                netCDF4.Dataset(path / "spoilt.nc", "w") as spoilt:
            values = {name: np.ma.filled(flight[name][:].astype(float), np.nan) for name in ("Time", "FLAPS", *FOUND_FROM)}
            whole = np.flatnonzero(np.all([np.isfinite(each) for each in values.values()], axis=0) & (values["QCF"] > 50.0))
            kinds = list(itertools.product(FOUND_FROM, {**NONE, **ODD}.items()))
            # Two good records between invalid ones show that the invalid ones do not affect them.
            step = min(3, len(whole) // len(kinds))
            assert step == 3, "the flight is too short for all cases"
            for file in (good, spoilt):
                file.setncatts({name: flight.getncattr(name) for name in flight.ncattrs()})
                file.createDimension("Time", None)
                for name, series in values.items():
                    made = file.createVariable(name, "f8", ("Time",), fill_value=None if name == "Time" else FILL)
                    made.set_auto_maskandscale(False)
                    made.setncatts({each: flight[name].getncattr(each) for each in flight[name].ncattrs()
                                    if each != "_FillValue"})
                    made[:] = series
            for record, (name, (kind, value)) in zip(whole[1::step], kinds):
                spoilt[name].set_auto_maskandscale(False)
                spoilt[name][record] = value
                cls.cases[int(record)] = (name, kind)
        cls.good, cls.good_bits = process(path / "good.nc", path / "good-out.nc")
        cls.spoilt, cls.bits = process(path / "spoilt.nc", path / "spoilt-out.nc")

    def test_results_are_plausible_or_missing_and_flagged(self):
        for name, (least, most) in POSSIBLE.items():
            values = self.spoilt[name]
            possible = (values >= least) & (values <= most)
            silent = np.isnan(values) & (self.bits == 0)
            self.assertTrue(np.all(possible | np.isnan(values)), f"{name}: {self.at(~possible & ~np.isnan(values))}")
            self.assertFalse(np.any(silent), f"{name} is missing without a bit: {self.at(silent)}")

    def test_results_of_a_missing_input_are_missing(self):
        for record, (name, kind) in self.cases.items():
            if kind not in NONE:
                continue
            for result in FOUND_FROM[name]:
                self.assertTrue(np.isnan(self.spoilt[result][record]),
                                f"{result} is {self.spoilt[result][record]} where {name} is {kind}")
            self.assertNotEqual(self.bits[record] & ~self.good_bits[record], 0, f"no bit marks {name} as {kind}")

    def test_results_without_the_missing_input_are_unchanged(self):
        for record, (name, kind) in self.cases.items():
            if name == "EDPC" or kind not in NONE:
                continue  # the air counts as dry
            for result in set(RESULTS) - FOUND_FROM[name]:
                self.assertEqual(self.spoilt[result][record], self.good[result][record], f"{result} where {name} is {kind}")

    def test_no_other_record_changes(self):
        untouched = np.ones(len(self.bits), dtype=bool)
        untouched[list(self.cases)] = False
        for name in RESULTS:
            np.testing.assert_array_equal(self.spoilt[name][untouched], self.good[name][untouched], name)
        # A bit marks an incomplete window of time averages, ATLAMSF alone.
        other = ~np.uint32(1 << 16)
        np.testing.assert_array_equal(self.bits[untouched] & other, self.good_bits[untouched] & other)

    def test_good_flight_has_all_results(self):
        """Otherwise the other tests would be empty."""
        for name in RESULTS:
            self.assertTrue(np.all(np.isfinite(self.good[name][list(self.cases)])), name)

    def at(self, where):
        return [self.cases.get(int(record), "untouched") for record in np.flatnonzero(where)]


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
