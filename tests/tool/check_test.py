#!/usr/bin/env python3
"""`pcor check` on simulated flights, and on flights without the inputs of a check.

    check_test.py TOOL SOURCE_DIRECTORY

Random numbers are fixed, so results are the same in every run.
"""

import csv
import os
import re
import shutil
import sys
import unittest

import netCDF4

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
import comparison_test  # noqa: E402
from comparison_test import FLIGHTS, OTHER_SYSTEM, SCENARIO, SHORT_GV, ComparisonTest, addresses_in  # noqa: E402
from scenarios import simulate  # noqa: E402
from tool_test import TOOL, note_texts  # noqa: E402

NAMES = ["total-pressure", "static-pressure", "reverse-heading", "circles", "speed-run", "pitch", "yaw", "layers",
         "lams-temperature", "spectrum"]
# Two minutes of yaw, which are called a manoeuvre, and headings to compare.
HEADINGS = SCENARIO.replace("cycles = 10", "cycles = 14").replace(
    '[[leg]]\nkind = "landing"',
    '[[leg]]\nkind = "reverse-heading"\n\n[[leg]]\nkind = "circle"\n\n[[leg]]\nkind = "landing"')
ONE, TWO, GV = (FLIGHTS / name for name in ("one.nc", "two.nc", "gv.nc"))


def setUpModule():
    for output, text, seed in ((ONE, HEADINGS, 3), (TWO, HEADINGS, 4), (GV, SHORT_GV, 20)):
        simulate(TOOL, output, text, seed)


def tearDownModule():
    comparison_test.MADE.cleanup()


class CheckTest(ComparisonTest):
    def check(self, *arguments, flights=(ONE,)):
        """The checks by name."""
        return {each["name"]: each for each in self.json_of("check", *flights, *arguments)["checks"]}

    def changed(self, change, name="changed.nc"):
        path = self.path / name
        shutil.copy(ONE, path)
        with netCDF4.Dataset(path, "a") as file:
            change(file)
        return path

    def without(self, *variables):
        """A flight in which these variables have other, unknown names."""
        def change(file):
            for variable in variables:
                file.renameVariable(variable, "NO_" + variable)
        return self.changed(change)

    def assert_not_run(self, check, *words):
        self.assertFalse(check["ran"], check["finding"])
        self.assertIsNone(check["verdict"])
        for word in words:
            self.assertIn(word, check["reason"])


class Results(CheckTest):
    def test_json(self):
        result = self.json_of("check", ONE, "-m", self.model(), "--reference", f"static:{OTHER_SYSTEM}")
        self.assertEqual([each["name"] for each in result["checks"]], NAMES)
        for each in result["checks"]:
            self.assertLessEqual({"name", "ran", "reason", "verdict", "key", "judged", "decided", "numbers", "finding",
                                  "cannot_see", "tables", "notes"}, set(each))
            self.assertEqual(each["ran"], each["reason"] == "")
            if each["ran"]:
                self.assertIn(each["verdict"], ("consistent", "inconsistent", "inconclusive"))
                self.assertTrue(each["cannot_see"])
                self.assertTrue(each["numbers"])
        for name in NAMES[:7]:
            self.assertTrue(result["checks"][NAMES.index(name)]["ran"], name)
        for each in result["checks"][:2]:
            self.assertLessEqual({"slope", "offset_hpa", "rms_hpa"}, set(each["numbers"]))

    def test_verdicts_follow_from_numbers_that_are_printed(self):
        arguments = ("check", ONE, "-m", self.model())
        text = self.done(*arguments).stdout
        for check in self.json_of(*arguments)["checks"]:
            if not check["ran"]:
                continue
            for number in check["judged"]:
                for name in ("value", "stderr"):
                    self.assertIn(number[name], check["numbers"].values(), check["name"])
                size, error, limit = abs(number["value"]), number["stderr"], number["matters"]
                expected = ("inconsistent" if size > limit and size > 3.0 * error else
                            "consistent" if size + 2.0 * error <= limit else "inconclusive")
                self.assertEqual(number["verdict"], expected, check["name"])
            key = check["key"]
            self.assertIn(key, check["judged"])
            sentence = f"{key['value']:+.3f} +- {key['stderr']:.3f} {key['unit']}, {key['what']}: "
            self.assertTrue(check["decided"].startswith(sentence), check["decided"])
            self.assertIn(f"  {check['verdict']}: {check['decided']}.\n", text)
            # A check withholds a verdict that its data do not allow: an uncorrected system, turbulence.
            self.assertIn(check["verdict"], (key["verdict"], "inconclusive"))

    def test_several_flights(self):
        both = self.check("-m", self.model(), flights=(ONE, TWO))
        self.assertEqual(both["reverse-heading"]["numbers"]["pairs"], 2)
        self.assertEqual(both["circles"]["numbers"]["circles"], 2)

    def test_second_system_without_a_model_is_uncorrected(self):
        check = self.check("-m", self.model())["static-pressure"]
        self.assertEqual(check["verdict"], "inconclusive")
        self.assertIn("uncorrected", check["finding"])
        text = self.run_tool("check", ONE, "-m", self.model()).stdout
        self.assertRegex(text, r"(?m)^static-pressure .*uncorrected")
        check = self.check("-m", self.model(), "--reference", f"static:{OTHER_SYSTEM}")["static-pressure"]
        self.assertEqual(check["verdict"], "consistent")

    def test_without_a_model_pressures_are_as_recorded(self):
        """The files of the simulator have no corrected pressures, so the pair is as measured."""
        result = self.json_of("check", ONE)
        self.assertEqual(result["model"], "PSFD/QCF as recorded")
        self.assertEqual([each["name"] for each in result["checks"]], NAMES)

    def test_table_of_flights(self):
        table = self.path / "checks.csv"
        self.json_of("check", ONE, TWO, "--table", table)
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([(row["flight"], row["check"]) for row in rows],
                         [(path.name, name) for path in (ONE, TWO) for name in NAMES])
        alone = self.check(flights=(TWO,))
        for row in rows[len(NAMES):]:
            result = alone[row["check"]]
            self.assertEqual(row["verdict"], result["verdict"] if result["ran"] else "not run")
            if result["ran"]:
                self.assertEqual(float(row["value"]), result["key"]["value"])
                self.assertEqual(float(row["tolerance"]), result["key"]["matters"])
            else:
                self.assertEqual(row["reason"], result["reason"])

    def test_table_has_the_reason_of_a_withheld_verdict(self):
        """Without a model of the second system its pair is uncorrected."""
        table = self.path / "checks.csv"
        self.json_of("check", ONE, "-m", self.model(), "--table", table)
        with open(table, newline="") as file:
            row = next(row for row in csv.DictReader(file) if row["check"] == "static-pressure")
        self.assertEqual(row["verdict"], "inconclusive")
        self.assertIn("second system", row["reason"])

    def test_text(self):
        text = self.done("check", ONE, "-m", self.model(), "--reference", f"static:{OTHER_SYSTEM}").stdout
        for name in NAMES:
            self.assertRegex(text, rf"(?m)^{name} ")
        counts = sum(int(count) for count in re.findall(r"(\d+) [a-z]", text.splitlines()[0].split(": ")[-1]))
        self.assertEqual(counts, len(NAMES), text.splitlines()[0])
        self.assertNotIn("nan", text)

    def test_command_to_copy(self):
        self.model(name="my model.toml")
        self.link(ONE, "flight 1.nc")
        text = self.done("check", "flight 1.nc", "-m", "my model.toml", cwd=self.path).stdout
        self.assertIn("'flight 1.nc'", self.run_as_printed(text))
        text = self.done("check", "flight 1.nc", cwd=self.path).stdout
        self.assertIn("'flight 1.nc'", self.run_as_printed(text))

    def test_quiet(self):
        result = self.done("check", ONE, "--quiet")
        self.assertEqual((result.stdout, result.stderr), ("", ""))

    def test_report(self):
        report = self.path / "check.html"
        self.done("check", ONE, TWO, "-m", self.model(), "--reference", f"static:{OTHER_SYSTEM}", "--report", report)
        text = self.run_tool("check", GV, "--report", self.path / "gv.html").stdout
        self.assertNotIn("--report", text, "the pictures are in the report that was written")
        html = report.read_text()
        self.assertEqual(addresses_in(html), set())
        for word in ("Verdicts", "Reverse heading", "Limitations"):
            self.assertIn(word, html)

    def test_intervals(self):
        veto = self.write("veto.toml", 'format = "pcor-intervals/1"\n[[veto]]\nregime = "circle"\n'
                          'begin = "20:00:00"\nend = "23:00:00"\n')
        self.assert_not_run(self.check("-m", self.model(), "--intervals", veto)["circles"], "no circle was found")


class BadInput(CheckTest):
    def test_no_heading(self):
        checks = self.check("-m", self.model(), flights=(self.without("THDG"),))
        for name in ("reverse-heading", "circles"):
            self.assert_not_run(checks[name], "heading", "THDG")
        self.assertTrue(checks["total-pressure"]["ran"])

    def test_no_ground_velocity(self):
        checks = self.check(flights=(self.without("GGSPD", "GGTRK"),))
        for name in ("reverse-heading", "circles"):
            self.assert_not_run(checks[name], "ground speed", "GGSPD")

    def test_no_height(self):
        checks = self.check("-m", self.model(), flights=(self.without("GGALT"),))
        self.assertTrue(checks["pitch"]["ran"], checks["pitch"]["reason"])  # against the laser

    def test_no_second_system(self):
        checks = self.check(flights=(self.without("PSFRD", "QCFR", "PS_A", "QC_A"),))
        for name in ("total-pressure", "static-pressure"):
            self.assert_not_run(checks[name], "second", "PSFRD/QCFR", "--reference static:")

    def test_no_manoeuvres(self):
        for name, regime in (("pitch", "pitch manoeuvre"), ("yaw", "yaw manoeuvre"), ("speed-run", "speed run")):
            veto = self.write("veto.toml", f'format = "pcor-intervals/1"\n[[veto]]\nregime = "{regime}"\n'
                              'begin = "20:00:00"\nend = "23:00:00"\n')
            self.assert_not_run(self.check("--intervals", veto)[name], f"no {regime} was found", "--intervals")

    def test_a_single_leg(self):
        legs = self.write("legs.toml", 'format = "pcor-intervals/1"\n[[veto]]\nregime = "reverse heading"\n'
                          'begin = "20:00:00"\nend = "23:00:00"\n[[add]]\nregime = "reverse heading"\npair = 1\n'
                          'begin = "20:06:00"\nend = "20:07:00"\n')
        self.assert_not_run(self.check("--intervals", legs)["reverse-heading"], "single leg", "two")

    def test_a_flight_without_values(self):
        def change(file):
            for name, variable in file.variables.items():
                if variable.dimensions and name != "Time" and variable.dtype.kind == "f":
                    variable[:] = float("nan")
        nothing = self.changed(change)
        for arguments in ((), ("-m", self.model())):
            for check in self.check(*arguments, flights=(nothing,)).values():
                self.assert_not_run(check, "changed.nc")
        report = self.path / "check.html"
        self.done("check", nothing, "--report", report)
        self.assertIn("not run", report.read_text())
        # The other flight is still checked, and the result names the unchecked one.
        result = self.json_of("check", nothing, TWO)
        self.assertTrue(result["checks"][0]["ran"])
        self.assertTrue(any("changed.nc" in note for note in note_texts(result)))

    def test_invalid_inputs_are_refused(self):
        model = self.model()
        other = self.write("other.toml", model.read_text().replace('"PSFD"', '"PSFX"'))
        for arguments, words in (((ONE, ONE), ["one.nc", "twice"]), ((ONE, GV), ["aircraft"]),
                                 ((self.path / "none.nc",), ["none.nc"]), ((ONE, "-m", other), ["PSFX", "PSFD"]),
                                 ((ONE, "--reference", f"static:{self.path / 'none.toml'}"), ["none.toml"]),
                                 ((ONE, "-m", model, "--reference", f"static:{model}"), ["second", "PSFD/QCF"]),
                                 ((ONE, "-m", model, "--json", model), ["input"])):
            with self.subTest(words):
                self.refused("check", *arguments, words=words, output=self.path / "nothing")

    def test_wrong_usage_has_status_2(self):
        for arguments in ((), (ONE, "--secnd", OTHER_SYSTEM), (ONE, "--reference", "wind")):
            result = self.run_tool("check", *arguments)
            self.assertEqual(result.returncode, 2)


if __name__ == "__main__":
    if not os.access(TOOL, os.X_OK):
        sys.exit(f"{TOOL} is not a program")
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
