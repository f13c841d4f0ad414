#!/usr/bin/env python3
"""Attributes of a corrected flight: model, input, and the CF and ACDD conventions.

    output_test.py TOOL SOURCE_DIRECTORY

The example flight gets latitude, longitude and other conventions, like a flight of another institution.
"""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import netCDF4

TOOL = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()
MODEL = SOURCE / "data/models/c130-psfd-qcr-2003.toml"
CDL = subprocess.run([SOURCE / "tools/make_example_flight"], check=True, capture_output=True, text=True).stdout
# Part of the CF table that pcor writes.
STANDARD_NAMES = {"air_pressure", "air_temperature", "altitude", "barometric_altitude", "latitude", "longitude",
                  "platform_speed_wrt_air", "status_flag", "time"}
UNCERTAIN_MODEL = MODEL.read_text().replace("[[effect]]", "[uncertainty]\nstatic_defect = 0.1\n\n[[effect]]", 1)


class Outputs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)
        self.input = self.path / "flight.nc"
        subprocess.run(["ncgen", "-k", "classic", "-o", self.input, "-"], input=CDL, check=True, text=True)
        with netCDF4.Dataset(self.input, "a") as flight:
            time = flight["PSFD"].dimensions
            for name, unit, first in (("LATC", "degree", 40.0), ("LONC", "degree", -105.0)):
                place = flight.createVariable(name, "f4", time)
                place.units = unit
                place.long_name = name
                place[:] = [first + i / 1000 for i in range(len(flight["PSFD"]))]
            flight["PSFD"].coordinates = "LATC LONC NOWHERE"
            flight["PSFD"].ancillary_variables = "PSFD_QC"

    def edit(self, change):
        with netCDF4.Dataset(self.input, "a") as flight:
            change(flight)

    def output(self, *more, model=None):
        path = self.path / "out.nc"
        law = self.path / "model.toml"
        law.write_text(model or UNCERTAIN_MODEL)
        subprocess.run([TOOL, "process", self.input, "-m", law, "-o", path, "--quiet", *more], check=True)
        output = netCDF4.Dataset(path)
        self.addCleanup(output.close)
        return output

    def test_declared_conventions_are_fulfilled(self):
        for claimed, expected in (("CF-1.0", ""), ("NCAR-RAF/nimbus", "NCAR-RAF/nimbus "),
                                  ("CF-1.6, NCAR-RAF/nimbus-1.3, ACDD-1.0", "NCAR-RAF/nimbus-1.3 ")):
            with self.subTest(input=claimed):
                self.edit(lambda flight: flight.setncattr("Conventions", claimed))
                self.assertEqual(self.output().Conventions, expected + "CF-1.8 ACDD-1.3")

    def test_an_unknown_unit_is_not_cf(self):
        def change(flight):
            odd = flight.createVariable("ODD", "f4", flight["PSFD"].dimensions)
            odd.units = "bananas"
            odd[:] = 1.0

        self.edit(change)
        self.assertEqual(self.output().Conventions.split()[-2:], ["CF-1.8", "ACDD-1.3"])
        self.assertEqual(self.output("--all").Conventions.split()[1:], ["ACDD-1.3"])

    def test_output_is_a_trajectory(self):
        output = self.output()
        self.assertEqual(output.featureType, "trajectory")
        (name,) = [name for name, variable in output.variables.items() if getattr(variable, "cf_role", "")]
        self.assertEqual(output[name].cf_role, "trajectory_id")
        self.assertIn("2003-06-01", str(netCDF4.chartostring(output[name][:])))

    def test_coordinates_have_names_and_units(self):
        for options in ((), ("--all", "--suffix", "_X")):
            output = self.output(*options)
            self.assertEqual((output["LATC"].units, output["LATC"].standard_name), ("degrees_north", "latitude"))
            self.assertEqual((output["LONC"].units, output["LONC"].standard_name), ("degrees_east", "longitude"))
            self.assertEqual((output["GGALT"].standard_name, output["GGALT"].positive), ("altitude", "up"))
            for variable in output.variables.values():
                places = getattr(variable, "coordinates", "").split()
                if variable.dimensions == ("Time",) and variable.name not in ("Time", "LATC", "LONC", "GGALT"):
                    self.assertEqual(places, ["LATC", "LONC", "GGALT"], variable.name)
                for name in places + getattr(variable, "ancillary_variables", "").split():
                    self.assertIn(name, output.variables, variable.name)

    def test_a_track_of_other_names_is_found_by_standard_names(self):
        def change(flight):
            for name, other, standard in (("LATC", "LAT_GIN", "latitude"), ("LONC", "LON_GIN", "longitude")):
                flight.renameVariable(name, other)
                flight[other].standard_name = standard

        self.edit(change)
        output = self.output()
        self.assertEqual(output["PSXC"].coordinates, "LAT_GIN LON_GIN GGALT")
        self.assertEqual(output.featureType, "trajectory")

    def test_flight_without_a_track_is_not_a_trajectory(self):
        self.edit(lambda flight: flight.renameVariable("LONC", "NOTHING"))
        output = self.output()
        self.assertFalse(hasattr(output, "featureType"))
        self.assertNotIn("trajectory_id", output.variables)

    def test_an_output_can_be_processed_again(self):
        first = self.output("--all")
        self.input = self.path / "first.nc"
        Path(first.filepath()).rename(self.input)
        again = self.output("--all", "--suffix", "_AGAIN", model=MODEL.read_text())
        self.assertEqual(sum(hasattr(variable, "cf_role") for variable in again.variables.values()), 1)
        self.assertEqual(again.pcor_input, "first.nc")

    def test_results_need_only_their_inputs(self):
        """PCORFLAG has bits for missing inputs; the results of these samples are still read back."""
        self.edit(lambda flight: flight["TTRR"].__setitem__(slice(100, 200), -32767.0))
        output = self.output()
        self.assertEqual(output["PSXC"][:].count(), len(output["PSXC"]))
        self.assertGreater(sum(flag != 0 for flag in output["PCORFLAG"][:]), 99)
        model = self.path / "recorded.toml"
        model.write_text(MODEL.read_text())
        result = subprocess.run([TOOL, "compare", self.path / "out.nc", "-m", model, "--reference", "pressure:PSXC", "--json",
                                 "-", "--min-airspeed", "0"], check=True, capture_output=True, text=True)
        self.assertEqual(json.loads(result.stdout)["masks"]["reference_missing"], 0)

    def test_standard_names_are_in_the_cf_table(self):
        for variable in self.output().variables.values():
            name = getattr(variable, "standard_name", "")
            if name:
                self.assertIn(name.removesuffix(" standard_error"), STANDARD_NAMES)
                self.assertNotIn(" standard_error", name.removesuffix(" standard_error"))

    def test_every_value_has_a_unit_and_flags_have_meanings(self):
        output = self.output()
        for variable in output.variables.values():
            self.assertTrue(variable.long_name)
            if variable.name == "PCORFLAG":
                self.assertEqual(len(variable.flag_masks), len(variable.flag_meanings.split()))
            elif variable.dtype != "S1":
                self.assertTrue(variable.units)

    def test_acdd_recommended_attributes_are_present(self):
        output = self.output()
        for attribute in ("title", "summary", "keywords", "Conventions", "history", "date_created",
                          "time_coverage_start", "time_coverage_duration", "geospatial_lat_min", "geospatial_lat_units"):
            self.assertTrue(str(output.getncattr(attribute)), attribute)

    def test_output_contains_the_complete_model(self):
        output = self.output()
        law = self.path / "from_output.toml"
        law.write_text(output.pcor_model_toml)
        again = self.path / "again.nc"
        subprocess.run([TOOL, "process", self.input, "-m", law, "-o", again, "--quiet"], check=True)
        with netCDF4.Dataset(again) as second:
            self.assertTrue((second["PSXC"][:] == output["PSXC"][:]).all())
            self.assertEqual(second.pcor_model_sha256, output.pcor_model_sha256)
        self.assertTrue(output.pcor_model)
        self.assertTrue(output.pcor_model_source)

    def test_coefficients_have_standard_errors(self):
        model = UNCERTAIN_MODEL
        model = model.replace("[[effect]]", '[[effect]]\nid = "static-mach3"\nparameters = { m3 = 0.0001 }\n'
                              "stderr = { m3 = 0.00002 }\n\n[[effect]]", 1)
        self.assertIn("static-mach3.m3 = 0.0001 +- 2e-05", self.output(model=model).pcor_model_coefficients)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
