#!/usr/bin/env python3
"""Output files of the tool, read by the programs that scientists use: ncdump, NCO, xarray and the CF checker.

    clients_test.py TOOL SOURCE_DIRECTORY [COMPLIANCE_CHECKER]

The example flight is processed at 1 Hz as an old classic file, and at 25 Hz as a netCDF-4 file that crosses midnight.
"""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import netCDF4
import numpy
import xarray

TOOL = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()
CHECKER = sys.argv[3] if len(sys.argv) > 3 else ""
MODEL = SOURCE / "data/models/c130-psfd-qcr-2003.toml"
RATE = 25


def run(*command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, **options).stdout


def old_flight(path):
    """The example flight as a classic file with base_time and time_offset, one value missing."""
    cdl = run(SOURCE / "tools/make_example_flight")
    subprocess.run(["ncgen", "-k", "classic", "-o", path, "-"], input=cdl, check=True, text=True)
    with netCDF4.Dataset(path, "a") as flight:
        flight["PSFD"][7] = numpy.ma.masked
    return numpy.datetime64("2003-06-01T12:00:00")


def high_rate_flight(path, old):
    """The same flight at 25 Hz as a netCDF-4 file, from one minute before midnight."""
    with netCDF4.Dataset(old) as source, netCDF4.Dataset(path, "w") as flight:
        flight.createDimension("Time", None)
        flight.createDimension(f"sps{RATE}", RATE)
        time = flight.createVariable("Time", "i4", ("Time",))
        time.units = "seconds since 2003-06-01 00:00:00 +0000"
        records = len(source["PSFD"]) // RATE * 5
        time[:] = 86340 + numpy.arange(records)
        for name in ("PSFD", "QCF", "QCR", "ADIFR", "BDIFR"):
            high = flight.createVariable(name, "f4", ("Time", f"sps{RATE}"), fill_value=-32767.0)
            high.setncatts({key: source[name].getncattr(key) for key in ("units", "long_name")})
            samples = numpy.interp(numpy.linspace(20, 590, records * RATE), numpy.arange(600), source[name][:].filled(900))
            high[:] = samples.reshape(records, RATE)
        for name in ("TTRR", "EDPC", "GGALT"):
            low = flight.createVariable(name, "f4", ("Time",), fill_value=-32767.0)
            low.setncatts({key: source[name].getncattr(key) for key in ("units", "long_name")})
            low[:] = numpy.interp(numpy.linspace(20, 590, records), numpy.arange(600), source[name][:])
        flight["PSFD"][3, 4] = numpy.ma.masked
    return numpy.datetime64("2003-06-01T23:59:00")


class Clients(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        path = Path(cls.folder.name)
        old, new = path / "old.nc", path / "new.nc"
        cls.start = {"old": old_flight(old), "new": high_rate_flight(new, old)}
        cls.outputs = {}
        for flight in (old, new):
            cls.outputs[flight.stem] = path / f"{flight.stem}-corrected.nc"
            run(TOOL, "process", flight, "-m", MODEL, "-o", cls.outputs[flight.stem])

    def test_ncdump_reads_times(self):
        for name, output in self.outputs.items():
            with self.subTest(flight=name):
                text = run("ncdump", "-t", "-v", "Time", output)
                self.assertIn(str(self.start[name]).replace("T", " ").removesuffix(":00"), text)

    def test_nco_averages_without_missing_values(self):
        for name, output in self.outputs.items():
            with self.subTest(flight=name):
                mean = self.outputs[name].with_suffix(".mean.nc")
                run("ncra", "-O", "-v", "PSXC", output, mean)
                with netCDF4.Dataset(mean) as averaged, netCDF4.Dataset(output) as whole:
                    expected = whole["PSXC"][:].mean(axis=0)
                    # ncra sums 32-bit floats in double precision; the result is a float again.
                    numpy.testing.assert_allclose(averaged["PSXC"][0], expected, rtol=1e-6)

    def test_xarray_decodes_times_and_missing_values(self):
        for name, output in self.outputs.items():
            with self.subTest(flight=name):
                with xarray.open_dataset(output) as flight:
                    times = flight.Time.values
                    self.assertEqual(times[0], self.start[name])
                    self.assertTrue((numpy.diff(times) == numpy.timedelta64(1, "s")).all())
                    self.assertEqual(int(flight.PSXC.isnull().sum()), 1)
                    self.assertEqual(int((flight.PCORFLAG & 1).sum()), 1)
                    self.assertEqual(flight.PSXC.dims, ("Time",) if name == "old" else ("Time", f"sps{RATE}"))

    def test_correction_reproduces_the_true_pressure(self):
        """The example's true static pressure falls evenly from 1000 to 700 hPa; its values have three decimals."""
        with netCDF4.Dataset(self.outputs["old"]) as flight:
            truth = 1000 - 300 * numpy.arange(600) / 599
            self.assertLess(abs(flight["PSXC"][:] - truth).max(), 2e-3)

    def test_cf_checker_reports_no_error(self):
        if not CHECKER:
            self.skipTest("compliance-checker is not installed: tools/check installs it")
        for name, output in self.outputs.items():
            with self.subTest(flight=name):
                report = subprocess.run([CHECKER, "--test=cf:1.8", output], capture_output=True, text=True).stdout
                self.assertIn("All tests passed!", report, report)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])
