#!/usr/bin/env python3
"""One flight in several file formats: process gives the same results.

    repacked_test.py TOOL SOURCE_DIRECTORY
"""

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
RESULTS = ("PCOR", "PSXC", "QCXC", "MACHX", "ATX", "TASX", "PCOR_LAMS", "ATLAMS", "QCLAMS", "PCORFLAG")
PACKING = 0.02  # hPa, of a number of 16 bits
FOLDER = tempfile.TemporaryDirectory()
FLIGHT = Path(FOLDER.name) / "flight.nc"


def copy(path, kind="NETCDF4", records=slice(None), names=None, packed=(), **storage):
    """The flight, or some of its records, as another file; `packed` variables as integers of 16 bits."""
    with netCDF4.Dataset(FLIGHT) as flight, netCDF4.Dataset(path, "w", format=kind) as file:
        flight.set_auto_maskandscale(False)
        file.setncatts({name: flight.getncattr(name) for name in flight.ncattrs()})
        for name, dimension in flight.dimensions.items():
            file.createDimension(name, None if dimension.isunlimited() else len(dimension))
        for name in names or flight.variables:
            variable = flight[name]
            attributes = {each: variable.getncattr(each) for each in variable.ncattrs()}
            fill = attributes.pop("_FillValue", None)
            of_time = variable.dimensions[:1] == ("Time",)
            values = variable[records] if of_time else variable[...]
            kind_of_numbers = variable.dtype
            if name in packed:
                attributes.update(scale_factor=PACKING, add_offset=500.0)
                values, kind_of_numbers, fill = np.round((values - 500.0) / PACKING), "i2", None
            if kind != "NETCDF4" and kind_of_numbers == str:
                continue
            made = file.createVariable(name, kind_of_numbers, variable.dimensions, fill_value=fill,
                                       **(storage if of_time else {}))
            made.set_auto_maskandscale(False)
            made.setncatts(attributes)
            made[:] = values


class Repacked(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)

    def results(self, flight):
        output = self.path / "out.nc"
        done = subprocess.run([TOOL, "process", flight, "-m", MODEL, "-o", output, "--quiet"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        with netCDF4.Dataset(output) as file:
            file.set_auto_maskandscale(False)
            return {name: file[name][:] for name in RESULTS}

    def assert_same(self, results, expected):
        for name in RESULTS:
            np.testing.assert_array_equal(results[name], expected[name], name)

    def test_kinds_of_files(self):
        expected = self.results(FLIGHT)
        self.assertGreater(np.mean(expected["PSXC"] > 0), 0.9)
        other = self.path / "other.nc"
        for kind in ("NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA", "NETCDF4_CLASSIC", "NETCDF4"):
            with self.subTest(kind):
                copy(other, kind)
                self.assert_same(self.results(other), expected)

    def test_compression(self):
        expected = self.results(FLIGHT)
        other = self.path / "other.nc"
        for storage in ({"zlib": True, "complevel": 9, "shuffle": True}, {"zlib": True, "fletcher32": True}):
            with self.subTest(str(storage)):
                copy(other, **storage)
                self.assert_same(self.results(other), expected)

    def test_order_of_variables(self):
        with netCDF4.Dataset(FLIGHT) as file:
            names = list(file.variables)
        other = self.path / "other.nc"
        copy(other, names=names[::-1])
        self.assert_same(self.results(other), self.results(FLIGHT))

    def test_two_parts(self):
        expected = self.results(FLIGHT)
        parts = []
        for number, records in enumerate((slice(0, 700), slice(700, None))):
            copy(self.path / f"{number}.nc", records=records)
            parts.append(self.results(self.path / f"{number}.nc"))
        # The laser's filter restarts, and a bit is set.
        filtered = ~np.array(1 << 16, expected["PCORFLAG"].dtype)
        for name in RESULTS:
            joined, whole = np.concatenate([part[name] for part in parts]), expected[name]
            if name == "PCORFLAG":
                joined, whole = joined & filtered, whole & filtered
            np.testing.assert_array_equal(joined, whole, name)

    def test_packed(self):
        other = self.path / "other.nc"
        copy(other, packed=("PSFD", "QCF"))
        results, expected = self.results(other), self.results(FLIGHT)
        flying = expected["QCXC"] > 20
        self.assertGreater(np.mean(flying), 0.8)
        # Each pressure is off by half a step of the packing, and the law has tenths of one for one of the other.
        for name in ("PSXC", "QCXC"):
            np.testing.assert_allclose(results[name][flying], expected[name][flying], rtol=0, atol=PACKING)


if __name__ == "__main__":
    subprocess.run([TOOL, "simulate", SOURCE / "data/scenarios/c130-short.toml", "-o", FLIGHT, "--quiet"], check=True)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
