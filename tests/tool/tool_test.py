#!/usr/bin/env python3
"""The tool: its output, exit status and files.

    tool_test.py TOOL SOURCE_DIRECTORY

Flights are made from the text of the example flight, with the fault under test written into it.
"""

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOOL = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()
MODEL = (SOURCE / "data/models/c130-psfd-qcr-2003.toml").read_text()


def example_flight():
    return subprocess.run([SOURCE / "tools/make_example_flight"], check=True, capture_output=True, text=True).stdout


CDL = example_flight()


class ToolTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = Path(self.folder.name)

    def flight(self, change=lambda cdl: cdl, name="flight.nc"):
        """A flight from the example's text after `change`."""
        cdl = change(CDL)
        path = self.path / name
        subprocess.run(["ncgen", "-k", "classic", "-o", path, "-"], input=cdl, check=True, text=True)
        return path

    def model(self, change=lambda toml: toml):
        path = self.path / "model.toml"
        text = change(MODEL)
        path.write_text(text)
        return path

    def run_tool(self, *arguments, **options):
        return subprocess.run([TOOL, *arguments], capture_output=True, text=True, **options)

    def process(self, flight, model=None, output=None, *more):
        output = self.path / "out.nc" if output is None else output
        return self.run_tool("process", flight, "-m", model or self.model(), "-o", output, *more)

    def assert_refused(self, result, *words, status=1):
        """One line on standard error with the words, the status, and no output or partial file."""
        self.assertEqual(result.returncode, status, result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertEqual(result.stdout, "")
        for word in words:
            self.assertIn(word, result.stderr)
        self.assertFalse((self.path / "out.nc").exists())
        left = {p.name for p in self.path.iterdir()} - {"flight.nc", "model.toml", "readonly"}
        self.assertEqual(left, set(), "temporary files remain")


def replace(pattern, text, count=0):
    """A replacement; an error if the old text is absent."""

    def change(source):
        changed, found = re.subn(pattern, text, source, count=count, flags=re.MULTILINE)
        assert found, f"nothing matches {pattern}"
        return changed

    return change


def note_texts(result):
    """Texts of the notes of a JSON result."""
    return [note["text"] for note in result.get("notes", [])]


def data_of(name):
    return rf"(^ *{name} =)([^;]*);"


def with_data(name, edit):
    """A change to the values of one variable: `edit` gets and returns a list of texts."""

    def change(source):
        match = re.search(data_of(name), source, flags=re.MULTILINE)
        assert match, f"no data of {name}"
        values = [value.strip() for value in match.group(2).split(",")]
        return source[: match.start(2)] + " " + ", ".join(edit(values)) + source[match.end(2) :]

    return change


class Done(ToolTest):
    def test_processes_a_flight(self):
        result = self.process(self.flight())
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("corrected 600 of 600 samples", result.stdout)
        self.assertIn("To look at the result: ncdump", result.stdout)
        self.assertEqual(result.stderr, "")

    def test_writes_json(self):
        result = self.process(self.flight(), None, None, "--json", "-")
        summary = json.loads(result.stdout)
        self.assertEqual(summary["records"], 600)
        self.assertIn("PSXC", summary["variables"])

    def test_is_quiet(self):
        result = self.process(self.flight(), None, None, "--quiet")
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def test_old_output_is_replaced(self):
        output = self.path / "out.nc"
        output.write_text("old")
        self.assertEqual(self.process(self.flight()).returncode, 0)
        self.assertEqual(output.read_bytes()[:3], b"CDF")

    def test_prints_the_catalogue(self):
        result = self.run_tool("effects")
        self.assertEqual(result.returncode, 0)
        self.assertIn("static-alpha-quad", result.stdout)
        one = self.run_tool("effects", "static-qp", "--json", "-")
        self.assertEqual(json.loads(one.stdout)["parameters"][0]["name"], "a2")

    def test_prints_place_and_scaling_of_an_effect(self):
        odd = json.loads(self.run_tool("effects", "static-beta-odd", "--json", "-").stdout)
        self.assertEqual((odd["family"], odd["place"]), ("sideslip", "port"))
        self.assertEqual(odd["scalings"], [{"static_pressure": -1, "dynamic_pressure": 1}])
        text = self.run_tool("effects", "clock-skew").stdout
        self.assertRegex(text, r"family +clock\n *place +clock\n")

    def test_explains_undetectable_effects(self):
        self.assertIn("lams-fold", self.run_tool("effects", "--verbose").stdout)
        result = self.run_tool("effects", "lams-fold")
        self.assertEqual(result.returncode, 0)
        self.assertIn("Nyquist", result.stdout)
        self.assertIn("lams-fold", self.run_tool("effects", "lams-fod").stderr)

    def test_prints_its_version(self):
        self.assertRegex(self.run_tool("--version").stdout, r"^pcor \d+\.\d+\.\d+\n$")


class Usage(ToolTest):
    def test_unknown_sub_command(self):
        self.assert_refused(self.run_tool("proces"), "proces", "process", status=2)

    def test_missing_option(self):
        self.assert_refused(self.run_tool("process", "flight.nc", "-o", "out.nc"), "--model", status=2)

    def test_no_flight(self):
        for command in ("inspect", "process"):
            self.assert_refused(self.run_tool(command), "FLIGHT.nc", status=2)

    def test_wrong_choice(self):
        result = self.process(self.flight(), None, None, "--correct-with", "radar")
        self.assert_refused(result, "radar", status=2)

    def test_unknown_option(self):
        result = self.process(self.flight(), None, None, "--sufix", "_X")
        self.assert_refused(result, "'--sufix'", "--suffix", status=2)
        self.assert_refused(self.run_tool("process", "--sufix"), "'--sufix'", "--suffix", status=2)

    def test_no_arguments(self):
        self.assert_refused(self.run_tool(), "pcor --help", status=2)

    def test_unknown_effect(self):
        self.assert_refused(self.run_tool("effects", "static-alpa"), "static-alpha")

    def test_full_standard_output(self):
        with open("/dev/full", "w") as full:
            result = subprocess.run([TOOL, "effects"], stdout=full, stderr=subprocess.PIPE, text=True)
        self.assertEqual(result.returncode, 1)
        self.assertIn("standard output", result.stderr)


class Notes(ToolTest):
    def test_a_long_note_keeps_its_action(self):
        model = self.model(lambda toml: toml.replace("[[effect]]", "[uncertainty]\nstatic_defect = 0.1\n\n[[effect]]", 1))
        note = next(line for line in self.process(self.flight(), model).stdout.splitlines() if "these sensors" in line)
        self.assertIn("set static_pressure, dynamic_pressure and recovery_temperature in [uncertainty]", note)

    def test_calibration_of_a_sensor_states_no_uncertainty(self):
        model = self.model(lambda toml: toml.replace("[[effect]]", '[uncertainty]\n"temp-offset.offset" = 0.3\n\n[[effect]]', 1))
        result = self.process(self.flight(), model, None, "--uncertainty", "total")
        self.assert_refused(result, "the calibration of a sensor alone does not suffice")

    def test_coarse_pressure_is_reported(self):
        def whole(values):
            return [str(round(float(value))) for value in values]
        result = self.process(self.flight(with_data("PSFD", whole)), None, None, "--verbose")
        self.assertIn("PSFD is recorded in steps of 1 hPa: rounding alone contributes 0.29 hPa rms", result.stdout)

    def test_law_for_another_time_and_aircraft_is_reported(self):
        model = self.model(
            lambda toml: re.sub(r'^valid_from.*$', 'valid_from = "2010-01-01"', toml, flags=re.MULTILINE)
            .replace("valid_to", "# valid_to").replace("N130AR", "N677F")
        )
        result = self.process(self.flight(), model)
        self.assertIn("the law is valid from 2010-01-01", result.stdout)
        self.assertIn("N130AR'", result.stdout)

    def test_formula_of_a_role_is_in_its_unit(self):
        """TTRR is in degC in the file; a formula that names it means the recovery temperature, in K."""
        effect = '\n[[effect]]\nid = "mine"\nformula = "k * (TTRR - recovery_temperature)"\nparameters = {{ k = {} }}\n'
        means = []
        for k in (0.0, 1.0):
            result = self.process(self.flight(), self.model(lambda toml: toml + effect.format(k)), None, "--json", "-")
            means.append(json.loads(result.stdout)["delta_p_hpa"]["mean"])
        self.assertAlmostEqual(means[0], means[1], places=9)

    def test_formula_of_another_variable_states_its_unit(self):
        effect = '\n[[effect]]\nid = "mine"\nformula = "k * GGALT"\nparameters = { k = 0.0 }\n'
        result = self.process(self.flight(), self.model(lambda toml: toml + effect))
        self.assertIn("a formula of the model reads GGALT in", result.stdout)

    def test_dependencies_name_used_variables(self):
        self.process(self.flight())
        header = subprocess.run(["ncdump", "-h", self.path / "out.nc"], capture_output=True, text=True).stdout
        self.assertIn('PCOR:Dependencies = "3 PSFD QCR ADIFR"', header)
        self.assertIn('TASX:Dependencies = "3 MACHX ATX EDPC"', header)


class BadFlight(ToolTest):
    def test_no_such_file(self):
        self.assert_refused(self.process(self.path / "none.nc"), "none.nc")

    def test_not_netcdf(self):
        path = self.path / "flight.nc"
        path.write_text("this is not a netCDF file\n")
        self.assert_refused(self.process(path), "flight.nc", "netCDF")

    def test_truncated(self):
        path = self.flight()
        path.write_bytes(path.read_bytes()[:-5000])
        self.assert_refused(self.process(path), "flight.nc", "truncated")

    def test_missing_variable(self):
        flight = self.flight(lambda cdl: cdl.replace("QCR", "QCRX"))
        result = self.process(flight)
        self.assert_refused(result, "QCR", "QCRX", "[variables]")
        self.assertNotIn("--reference", result.stderr)

    def test_unknown_unit(self):
        flight = self.flight(replace(r'PSFD:units = "[^"]*"', 'PSFD:units = "bananas"'))
        self.assert_refused(self.process(flight), "PSFD", "bananas", "[units]")

    def test_wrong_unit(self):
        flight = self.flight(replace(r'PSFD:units = "[^"]*"', 'PSFD:units = "m/s"'))
        self.assert_refused(self.process(flight), "PSFD", "m/s", "hPa")

    def test_absent_unit(self):
        flight = self.flight(replace(r"^.*PSFD:units.*$", ""))
        self.assert_refused(self.process(flight), "PSFD", "[units]", "static_pressure")

    def test_stated_unit(self):
        flight = self.flight(replace(r"^.*PSFD:units.*$", ""))
        model = self.model(lambda toml: toml + '\n[units]\nunit.static_pressure = "hPa"\n')
        self.assertEqual(self.process(flight, model).returncode, 0)

    def test_all_values_missing(self):
        flight = self.flight(with_data("PSFD", lambda values: ["-32767"] * len(values)))
        self.assert_refused(self.process(flight), "PSFD")

    def test_time_backwards(self):
        flight = self.flight(with_data("time_offset", lambda t: t[:100] + [t[50]] + t[101:]))
        self.assert_refused(self.process(flight), "time", "100")

    def test_time_repeats(self):
        flight = self.flight(with_data("time_offset", lambda t: t[:100] + [t[99]] + t[101:]))
        self.assert_refused(self.process(flight), "time", "100")

    def test_gap_is_reported(self):
        flight = self.flight(
            with_data("time_offset", lambda t: t[:300] + [str(float(x) + 50) for x in t[300:]])
        )
        result = self.process(flight)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("1 gap", result.stdout)

    def test_no_records(self):
        def empty(cdl):
            cdl = re.sub(r"Time = \d+ ;", "Time = UNLIMITED ;", cdl)
            return re.sub(r"^ *[A-Za-z_0-9]+ =[^;]*;$", lambda m: m.group(0) if "base_time" in m.group(0) else "",
                          cdl[: cdl.index("data:")], flags=0) + "data:\n base_time = 0 ;\n}\n"

        self.assert_refused(self.process(self.flight(empty)), "record")

    def test_bad_values_inside(self):
        bad = {10: "NaNf", 20: "Infinityf", 30: "-32767", 40: "0", 50: "-5"}
        edit = lambda values: [bad.get(i, value) for i, value in enumerate(values)]
        for name in ("PSFD", "QCR", "QCF", "TTRR"):
            result = self.process(self.flight(with_data(name, edit)))
            self.assertEqual(result.returncode, 0, result.stderr)


class BadOutput(ToolTest):
    def test_output_is_the_input(self):
        flight = self.flight()
        before = flight.read_bytes()
        self.assert_refused(self.process(flight, None, flight), "flight.nc")
        self.assertEqual(flight.read_bytes(), before)

    def test_output_is_a_link_to_the_input(self):
        flight = self.flight()
        before = flight.read_bytes()
        link = self.path / "readonly"
        link.symlink_to(flight)
        self.assert_refused(self.process(flight, None, link), "readonly")
        self.assertEqual(flight.read_bytes(), before)

    def test_outputs_are_not_inputs(self):
        flight, model = self.flight(), self.model()
        before = flight.read_bytes(), model.read_bytes()
        for output, json_file in ((model, "-"), (self.path / "out.nc", flight), (self.path / "out.nc", model),
                                  (self.path / "out.nc", self.path / "out.nc")):
            result = self.process(flight, model, output, "--json", json_file)
            self.assert_refused(result, "choose")
        self.assertEqual((flight.read_bytes(), model.read_bytes()), before)

    def test_unwritable_json_path_is_an_error(self):
        result = self.process(self.flight(), None, None, "--json", self.path / "none" / "result.json")
        self.assert_refused(result, "none")

    def test_file_name_may_be_invalid_utf8(self):
        name = os.fsencode(self.path) + b"/w\xff.nc"
        os.rename(self.flight(), name)
        result = subprocess.run([TOOL, "process", name, "-m", self.model(), "-o", self.path / "out.nc", "--json", "-"],
                                capture_output=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout)["records"], 600)

    def test_a_stopped_run_writes_no_file(self):
        flight, model = self.flight(), self.model()
        for stop in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            run = subprocess.Popen([TOOL, "process", flight, "-m", model, "-o", self.path / "out.nc"],
                                   stdout=subprocess.DEVNULL)
            run.send_signal(stop)
            run.wait()
            left = {p.name for p in self.path.iterdir()} - {"flight.nc", "model.toml", "out.nc"}
            self.assertEqual(left, set())

    def test_no_such_folder(self):
        self.assert_refused(self.process(self.flight(), None, self.path / "none" / "out.nc"), "none")

    def test_full_device(self):
        self.assert_refused(self.process(self.flight(), None, "/dev/full"), "/dev/full")

    def test_failure_keeps_the_old_output(self):
        output = self.path / "out.nc"
        output.write_text("old")
        flight = self.flight(replace(r'PSFD:units = "[^"]*"', 'PSFD:units = "bananas"'))
        self.assertEqual(self.process(flight).returncode, 1)
        self.assertEqual(output.read_text(), "old")

    def test_output_variable_with_an_existing_name(self):
        flight = self.flight(lambda cdl: cdl.replace("GGALT", "PSXC"))
        self.assert_refused(self.process(flight, None, None, "--all"), "PSXC", "--suffix")
        self.assertEqual(self.process(flight, None, None, "--all", "--suffix", "_NEW").returncode, 0)


class BadModel(ToolTest):
    def refuse(self, change, *words):
        self.assert_refused(self.process(self.flight(), self.model(change)), "model.toml", *words)

    def test_no_such_file(self):
        self.assert_refused(self.process(self.flight(), self.path / "none.toml"), "none.toml")

    def test_syntax_error(self):
        self.refuse(lambda toml: 'name = "x\n' + toml, "model.toml:1:")

    def test_unknown_effect(self):
        self.refuse(lambda toml: toml + '\n[[effect]]\nid = "static-alpa"\n', "static-alpha")

    def test_unknown_parameter(self):
        self.refuse(
            lambda toml: toml + '\n[[effect]]\nid = "static-qp"\nparameters = { a3 = 1.0 }\n', "a3", "a2"
        )

    def test_missing_role(self):
        self.refuse(replace(r"^static_pressure.*$", ""), "static_pressure")

    def test_not_finite(self):
        self.refuse(lambda toml: toml + '\n[[effect]]\nid = "static-qp"\nparameters = { a2 = nan }\n', "a2")


if __name__ == "__main__":
    if not os.access(TOOL, os.X_OK):
        sys.exit(f"{TOOL} is not a program")
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
