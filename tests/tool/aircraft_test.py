#!/usr/bin/env python3
"""Files of other aircraft, with their names, units, signs and rates, without options.

    aircraft_test.py TOOL SOURCE_DIRECTORY

The flights are one simulated flight of a C-130, written with the conventions of each family of data/aircraft.
"""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import netCDF4
import numpy

TOOL = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()


class Copy:
    """A variable of another convention: its source, its unit and its quantity."""

    def __init__(self, source, unit, factor=1.0, offset=0.0):
        self.source, self.unit, self.factor, self.offset = source, unit, factor, offset


KELVIN = 273.15
NCAR = {name: Copy(name, unit) for name, unit in
        {"PSFD": "hPa", "QCF": "hPa", "TTRR": "degC", "DPXC": "degC", "GGALT": "m", "GGVSPD": "m/s", "PITCH": "degree",
         "ROLL": "degree", "THDG": "degree", "ATTACK": "degree", "SSLIP": "degree"}.items()}
FAMILIES = {
    "ncar": ({"institution": "NCAR Research Aviation Facility", "Aircraft": "N130AR"}, "Time", "time_offset", NCAR,
             "pressure:PSXC", {"PSXC": Copy("TRUE_PS", "mb")}),
    "faam-core": (
        {"institution": "FAAM", "Title": "Standard Data from FAAM BAE-146", "Conventions": "NCAR-RAF/nimbus"},
        "Time", "Time",
        {"P10_STAT": Copy("PSFD", "hPa"), "P0_S10": Copy("QCF", "hPa"), "IAT_DI_R": Copy("TTRR", "K", 1.0, KELVIN),
         "TDEW_GE": Copy("DPXC", "degK", 1.0, KELVIN), "ALT_GIN": Copy("GGALT", "m"),
         "VELD_GIN": Copy("GGVSPD", "m s-1", -1.0), "PTCH_GIN": Copy("PITCH", "degree"),
         "ROLL_GIN": Copy("ROLL", "degree"), "HDG_GIN": Copy("THDG", "degree"), "AOA": Copy("ATTACK", "degree"),
         "AOSS": Copy("SSLIP", "degree"), "TAT_DI_R": Copy("TRUE_AT", "degK", 1.0, KELVIN)},
        "pressure:PS_RVSM", {"PS_RVSM": Copy("TRUE_PS", "hPa")}),
    "wyoming-king-air": (
        {"institution": "University of Wyoming - Dept of Atmospheric Science", "Conventions": "NCAR-RAF/nimbus"},
        "time", "time",
        {"ps_hads_a": Copy("PSFD", "mbar"), "qc_hads_a": Copy("QCF", "mbar"), "trose": Copy("TRUE_AT", "C"),
         "tdp": Copy("DPXC", "C"), "tas": Copy("TASX", "m/s"), "GALT": Copy("GGALT", "m"),
         "AVzvel": Copy("GGVSPD", "m/s"), "AVpitch": Copy("PITCH", "deg"), "AVroll": Copy("ROLL", "deg"),
         "AVthead": Copy("THDG", "deg"), "alpha": Copy("ATTACK", "deg"), "beta": Copy("SSLIP", "deg")},
        "pressure:pmb", {"pmb": Copy("TRUE_PS", "mbar")}),
    "noaa-wp-3d": (
        {"institution": "NOAA Aircraft Operations Center", "platform": "N42RF"}, "Time", "Time",
        {"PSM.1": Copy("PSFD", "mb"), "PQM.1": Copy("QCF", "mb"), "TTM.1": Copy("TTRR", "C"), "TDM.1": Copy("DPXC", "C"),
         "ALTref": Copy("GGALT", "m"), "PITCHref": Copy("PITCH", "deg"), "ROLLref": Copy("ROLL", "deg"),
         "THDGref": Copy("THDG", "deg"), "AA.d": Copy("ATTACK", "deg"), "SA.d": Copy("SSLIP", "deg"),
         "TAS.d": Copy("TASX", "m/s")},
        "pressure:PS.c", {"PS.c": Copy("TRUE_PS", "mb")}),
    "halo-bahamas": (
        {"institution": "DLR", "title": "HALO BAHAMAS basic data", "platform": "HALO D-ADLR"}, "tid", "TIME",
        {"PS": Copy("PSFD", "Pa", 100.0), "QC": Copy("QCF", "Pa", 100.0), "TAT": Copy("TTRR", "K", 1.0, KELVIN),
         "TD": Copy("DPXC", "K", 1.0, KELVIN), "IRS_ALT": Copy("GGALT", "m"), "IRS_VV": Copy("GGVSPD", "m/s"),
         "IRS_THE": Copy("PITCH", "deg"), "IRS_PHI": Copy("ROLL", "deg"), "IRS_HDG": Copy("THDG", "deg"),
         "ALPHA": Copy("ATTACK", "deg"), "BETA": Copy("SSLIP", "deg"), "TAS": Copy("TASX", "m/s")},
        "pressure:PS_TRUE", {"PS_TRUE": Copy("TRUE_PS", "hPa")}),
}


def write(path, family, simulated, more=()):
    """A flight of that family; at 1 Hz, pressures and temperatures of FAAM at the rate of the simulation."""
    attributes, dimension, time_name, variables, _, truth = FAMILIES[family]
    with netCDF4.Dataset(simulated) as source, netCDF4.Dataset(path, "w", format="NETCDF4") as file:
        for name, value in attributes.items():
            file.setncattr(name, value)
        file.createDimension(dimension, None)
        file.createDimension("sps5", 5)
        time = numpy.asarray(source["Time"][:], float)
        stamp = file.createVariable(time_name, "f8", (dimension,))
        stamp.units = source["Time"].units
        stamp[:] = time
        if time_name == "time_offset":  # GENPRO and old nimbus
            base = file.createVariable("base_time", "i4", ())
            base[...] = int(netCDF4.date2num(netCDF4.num2date(time[0], source["Time"].units),
                                             "seconds since 1970-01-01"))
            del stamp.units
            stamp[:] = time - time[0]
        for name, copy in {**variables, **truth, **dict(more)}.items():
            values = numpy.ma.filled(source[copy.source][:].astype(float), numpy.nan)
            fast = family == "faam-core" and values.ndim == 2
            if values.ndim == 2 and not fast:
                values = values.mean(axis=1)
            new = file.createVariable(name, "f4", (dimension, "sps5") if fast else (dimension,), fill_value=-32767.0)
            new.units = copy.unit
            new[:] = numpy.ma.masked_invalid(copy.factor * values + copy.offset)


class OtherAircraft(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        scenario = (SOURCE / "data/scenarios/c130-short.toml").read_text().replace('aircraft = "C-130"',
                                                                                   'aircraft = "C-130"\nrate = 5', 1)
        (cls.path / "short.toml").write_text(scenario)
        cls.simulated = cls.path / "short.nc"
        subprocess.run([TOOL, "simulate", cls.path / "short.toml", "-o", cls.simulated, "--quiet"], check=True)
        (cls.path / "bare.toml").write_text('format = "pcor-model/1"\nname = "bare"\n'
                                            '[[effect]]\nid = "static-constant"\n[[effect]]\nid = "static-qp"\n')
        for family in FAMILIES:
            write(cls.path / f"{family}.nc", family, cls.simulated)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def run_tool(self, *arguments, status=0):
        result = subprocess.run([TOOL, *map(str, arguments)], capture_output=True, text=True, cwd=self.path)
        self.assertEqual(result.returncode, status, result.stderr + result.stdout)
        return result

    def json(self, *arguments):
        self.run_tool(*arguments, "--quiet", "--json", "result.json")
        return json.loads((self.path / "result.json").read_text())

    def test_aircraft_is_identified_by_file_attributes(self):
        for family in FAMILIES:
            flight = self.json("inspect", f"{family}.nc")["flights"][0]
            self.assertEqual(flight["alike"], [family])
            roles = flight["roles"]
            for role, variable in (("static_pressure", list(FAMILIES[family][3])[0]),
                                   ("dynamic_pressure", list(FAMILIES[family][3])[1])):
                self.assertEqual(roles[role]["variable"], variable, family)
            for role in ("altitude", "pitch", "roll", "heading"):
                self.assertIn(role, roles, family)
            self.assertIn("lams_airspeed", [missing["role"] for missing in flight["missing"]])

    def test_inspect_refit_and_process_correct_every_aircraft(self):
        """inspect, refit and process, without options about variables, units, signs or rates."""
        for family, (*_, reference, _) in FAMILIES.items():
            self.run_tool("inspect", f"{family}.nc", "--write-model", f"{family}.toml")
            self.run_tool("refit", f"{family}.nc", "-m", f"{family}.toml", "-o", f"{family}.fitted.toml", "--reference",
                          reference)
            self.run_tool("process", f"{family}.nc", "-m", f"{family}.fitted.toml", "-o", f"{family}.out.nc")
            with netCDF4.Dataset(self.path / f"{family}.out.nc") as out, netCDF4.Dataset(self.simulated) as truth:
                corrected = numpy.ma.filled(out["PSXC"][:], numpy.nan).reshape(truth["TRUE_PS"].shape[0], -1)
                true = numpy.asarray(truth["TRUE_PS"][:]).mean(axis=1)
                flying = numpy.asarray(truth["TRUE_TAS"][:]).mean(axis=1) > 80
                error = corrected.mean(axis=1)[flying] - true[flying]
                # The law of the simulation has the attack by the radome, of which the angle is a line; 0.1 hPa of noise.
                self.assertLess(numpy.sqrt(numpy.mean(error ** 2)), 0.35, family)

    def test_a_model_without_variables_runs(self):
        """compare, refit and check on all families, with roles from the flight; the same numbers for all."""
        rms = {}
        for family, (*_, reference, _) in FAMILIES.items():
            compared = self.json("compare", f"{family}.nc", "-m", "bare.toml", "--reference", reference)
            rms[family] = compared["models"][0]["rms_hpa"]
            regimes = {regime["name"] for regime in compared["models"][0]["regimes"]}
            self.assertLessEqual({"pitch manoeuvre", "climb", "descent"}, regimes, family)
            self.json("refit", f"{family}.nc", "-m", "bare.toml", "-o", "fitted.toml", "--reference", reference)
            self.json("check", f"{family}.nc", "-m", "bare.toml")
        for family, value in rms.items():
            # Rounding of 32-bit floats in other units, and means over the second.
            self.assertAlmostEqual(value, rms["ncar"], delta=0.02, msg=family)

    def test_reports_its_choices(self):
        result = self.run_tool("compare", "faam-core.nc", "-m", "bare.toml", "--reference", "pressure:PS_RVSM")
        self.assertIn("roles by faam-core: static_pressure = P10_STAT, dynamic_pressure = P0_S10", result.stderr)
        self.assertIn("VELD_GIN: the vertical speed is positive downward", result.stderr)

    def test_downward_vertical_speed_is_inverted(self):
        """Climbs are found if the vertical speed is positive downward."""
        flight = self.json("inspect", "faam-core.nc")["flights"][0]
        self.assertEqual(flight["roles"]["vertical_speed"]["sign"], "-")
        here = {regime["name"]: regime for regime in flight["regimes"]}
        there = {regime["name"]: regime for regime in self.json("inspect", "ncar.nc")["flights"][0]["regimes"]}
        for name in ("climb", "descent"):
            self.assertEqual(here[name]["begin"][:16], there[name]["begin"][:16])

    def test_series_of_opposite_sign_are_reported(self):
        """Each variable is compared with a correlated one, on a flight with turns and climbs; all agree if no sign is
        reversed."""
        flight, turned = self.path / "turns.nc", self.path / "turned.nc"
        self.run_tool("simulate", SOURCE / "data/scenarios/c130-eq18.toml", "-o", flight, "--quiet")

        def notes(path):
            return [note["text"] for note in self.json("inspect", path)["flights"][0]["notes"]
                    if note["severity"] == "warning" and "opposite signs" in note["text"]]

        self.assertEqual(notes(flight), [])
        for variable, words in (("GGVSPD", "the vertical speed and the change of altitude"),
                                ("ROLL", "the roll and the rate of the heading"),
                                ("GGTRK", "the rate of the ground track and the rate of the heading"),
                                ("ATTACK", "the angle of attack and the pitch minus the climb angle"),
                                ("PITCH", "the pitch and the angle of attack plus the climb angle"),
                                ("SSLIP", "the sideslip and the drift angle")):
            with self.subTest(variable):
                turned.write_bytes(flight.read_bytes())
                with netCDF4.Dataset(turned, "a") as file:
                    file[variable][:] = -file[variable][:]
                found = notes(turned)
                self.assertTrue(any(words in note for note in found), found)
                self.assertIn(words, self.run_tool("compare", turned, "-m", "c130-psfd-eq18", "--reference",
                                                    "pressure:TRUE_PS", "--verbose").stdout)
                short = self.run_tool("compare", turned, "-m", "c130-psfd-eq18", "--reference", "pressure:TRUE_PS").stdout
                self.assertRegex(short, r"(?m)^warning 1: ")

    def test_variable_names_are_case_sensitive(self):
        """The exact name is used; another case is not a variable, and the message lists the existing names."""
        flight = self.path / "case.nc"
        flight.write_bytes((self.path / "ncar.nc").read_bytes())
        with netCDF4.Dataset(flight, "a") as file:
            other = file.createVariable("psfd", "f4", file["PSFD"].dimensions)
            other.units = "hPa"
            other[:] = file["PSFD"][:] - 20.0
        roles = self.json("inspect", flight)["flights"][0]["roles"]
        self.assertEqual(roles["static_pressure"]["variable"], "PSFD")
        model = self.path / "case.toml"
        text = ('format = "pcor-model/1"\nname = "m"\n[variables]\nstatic_pressure = "{}"\n'
                'dynamic_pressure = "QCF"\n[[effect]]\nid = "static-constant"\n')
        means = {}
        for name in ("PSFD", "psfd"):
            model.write_text(text.format(name))
            self.run_tool("process", flight, "-m", model, "-o", f"{name}-out.nc")
            with netCDF4.Dataset(self.path / f"{name}-out.nc") as output:
                means[name] = numpy.nanmean(output["PSXC"][:])
        self.assertAlmostEqual(means["PSFD"] - means["psfd"], 20.0, places=3)  # float32
        model.write_text(text.format("Psfd"))
        result = self.run_tool("process", flight, "-m", model, "-o", "out.nc", status=1)
        self.assertIn("PSFD", result.stderr)
        self.assertIn("psfd", result.stderr)

    def test_model_can_name_the_aircraft_roles(self):
        model = (self.path / "bare.toml").read_text().replace('name = "bare"', 'name = "bare"\nroles = "{}"')
        (self.path / "named.toml").write_text(model.format("halo-bahamas"))
        result = self.run_tool("compare", "faam-core.nc", "-m", "named.toml", "--reference", "pressure:PS_RVSM", status=1)
        self.assertRegex(result.stderr, r"faam-core\.nc: .*HALO.*static_pressure and dynamic_pressure")
        (self.path / "named.toml").write_text(model.format("faam-cor"))
        result = self.run_tool("compare", "faam-core.nc", "-m", "named.toml", "--reference", "pressure:PS_RVSM", status=1)
        self.assertRegex(result.stderr, "'faam-cor': .*; did you mean")

    def test_inspect_uses_the_requested_aircraft_names(self):
        flight = self.json("inspect", "faam-core.nc", "--roles", "ncar")["flights"][0]
        self.assertEqual(flight["names_of"], "ncar")
        self.assertNotIn("static_pressure", flight["roles"])
        self.assertIn("faam-core", self.run_tool("inspect", "ncar.nc", "--roles", "faam", status=1).stderr)

    def test_an_unreadable_flight_does_not_stop_the_others(self):
        (self.path / "bad.nc").write_text("no flight")
        result = self.json("inspect", "ncar.nc", "bad.nc", "faam-core.nc")["flights"]
        self.assertEqual([flight["path"] for flight in result], ["ncar.nc", "bad.nc", "faam-core.nc"])
        self.assertIn("bad.nc", result[1]["unreadable"])
        self.run_tool("inspect", "bad.nc", status=1)
        self.run_tool("inspect", "bad.nc", "bad.nc", status=1)

    def test_each_result_lists_the_choices(self):
        result = self.json("compare", "faam-core.nc", "-m", "bare.toml", "--reference", "pressure:PS_RVSM", "--report",
                           "choices.html")
        self.assertTrue(any("VELD_GIN" in choice for choice in result["choices"]), result["choices"])
        self.assertTrue("VELD_GIN: the vertical speed is positive downward" in (self.path / "choices.html").read_text())

    def test_user_defined_aircraft_names_are_used(self):
        """A file of names next to the model."""
        (self.path / "mine.toml").write_text('format = "pcor-aircraft/1"\nname = "mine"\ntitle = "my aircraft"\n'
                                             '[pressures]\nmeasured = [["PS", "QC"]]\n'
                                             '[series]\naltitude = ["IRS_ALT"]\n')
        (self.path / "of_mine.toml").write_text(
            (self.path / "bare.toml").read_text().replace('name = "bare"', 'name = "bare"\nroles = "mine.toml"'))
        result = self.run_tool("compare", "halo-bahamas.nc", "-m", "of_mine.toml", "--reference", "pressure:PS_TRUE")
        self.assertIn("roles by mine: static_pressure = PS", result.stderr)
        (self.path / "mine.toml").write_text('format = "pcor-aircraft/1"\nname = "mine"\ntitle = "x"\n[series]\nheigth = []\n')
        result = self.run_tool("compare", "halo-bahamas.nc", "-m", "of_mine.toml", "--reference", "pressure:PS_TRUE", status=1)
        self.assertIn("mine.toml:5:", result.stderr)
        self.assertIn("heigth", result.stderr)

    def test_an_ambiguous_file_is_reported(self):
        write(self.path / "both.nc", "halo-bahamas", self.simulated, {"PSM.1": Copy("PSFD", "mb"), "PQM.1": Copy("QCF", "mb")})
        with netCDF4.Dataset(self.path / "both.nc", "a") as file:
            file.institution = "DLR and NOAA"
        flight = self.json("inspect", "both.nc")["flights"][0]
        self.assertEqual(sorted(flight["alike"]), ["halo-bahamas", "noaa-wp-3d"])
        result = self.run_tool("compare", "both.nc", "-m", "bare.toml", "--reference", "pressure:PS_TRUE", status=1)
        self.assertRegex(result.stderr, r"both\.nc: .*halo-bahamas.*noaa-wp-3d.*roles = ")

    def test_unit_of_the_model_overrides_the_file(self):
        """The model corrects a wrong attribute of a file, with a note."""
        write(self.path / "wrong.nc", "ncar", self.simulated)
        with netCDF4.Dataset(self.path / "wrong.nc", "a") as file:
            file["PSFD"].units = "kPa"
        model = ('format = "pcor-model/1"\nname = "stated"\n[variables]\nstatic_pressure = "PSFD"\ndynamic_pressure = "QCF"\n'
                 '[humidity]\nmoist = false\n{}[[effect]]\nid = "static-constant"\n')
        (self.path / "stated.toml").write_text(model.format('[units]\nstatic_pressure = "hPa"\n'))
        stated = self.json("compare", "wrong.nc", "-m", "stated.toml", "--reference", "pressure:PSXC")
        (self.path / "plain.toml").write_text(model.format(""))
        right = self.json("compare", "ncar.nc", "-m", "plain.toml", "--reference", "pressure:PSXC")
        self.assertEqual(stated["models"][0]["rms_hpa"], right["models"][0]["rms_hpa"])
        self.assertIn("PSFD is read in 'hPa'",
                      " ".join(note["text"] for note in stated.get("notes", [])) +
                      self.run_tool("process", "wrong.nc", "-m", "stated.toml", "-o", "w.nc").stdout)

    def test_unit_of_a_role_that_the_law_does_not_read_is_noted(self):
        (self.path / "knots.toml").write_text(
            'format = "pcor-model/1"\nname = "stated"\n[variables]\nstatic_pressure = "PSFD"\ndynamic_pressure = "QCF"\n'
            'roll = "ROLL"\npitch = "PITCH"\n[units]\nroll = "radian"\npitch = "degree"\n[humidity]\nmoist = false\n'
            '[[effect]]\nid = "static-constant"\n')
        write(self.path / "right.nc", "ncar", self.simulated)
        notes = " ".join(note["text"] for note in
                         self.json("compare", "right.nc", "-m", "knots.toml", "--reference", "pressure:PSXC")["notes"])
        self.assertIn("ROLL is read in 'radian'", notes)
        self.assertNotIn("PITCH is read", notes)

    def test_flight_without_pressures_is_reported(self):
        with netCDF4.Dataset(self.path / "empty.nc", "w") as file:
            file.createDimension("Time", None)
            time = file.createVariable("Time", "f8", ("Time",))
            time.units = "seconds since 2020-01-01"
            time[:] = numpy.arange(50.0)
            other = file.createVariable("o3", "f4", ("Time",))
            other.units = "ppb"
            other[:] = 40.0
        result = self.run_tool("inspect", "empty.nc")
        self.assertIn("naming convention", result.stdout)
        self.assertIn("[variables]", result.stdout)
        self.assertIn("no model can be written", self.run_tool("inspect", "empty.nc", "--write-model", "e.toml", status=1).stderr)
        self.assertFalse((self.path / "e.toml").exists())

    def test_report(self):
        self.run_tool("inspect", "faam-core.nc", "ncar.nc", "--report", "page.html")
        page = (self.path / "page.html").read_text()
        for title in ("Roles and manoeuvres of 2 flights", "Height", "Roles of faam-core.nc", "Missing from ncar.nc"):
            self.assertIn(title, page)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
