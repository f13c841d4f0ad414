#!/usr/bin/env python3
"""`pcor compare`, `pcor refit` and `pcor simulate` on simulated flights with a known law.

    comparison_test.py TOOL SOURCE_DIRECTORY

The flights are 15 minutes of a C-130 with the usual noise, about 1000 used samples; the law is equation 18, as in the
model. Random numbers are fixed, so results are the same in every run.
"""

import csv
import json
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
import unittest
from pathlib import Path

import netCDF4
import numpy
import xarray

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
from scenarios import simulate  # noqa: E402
from tool_test import SOURCE, TOOL, ToolTest, note_texts, replace  # noqa: E402

LAW = {"static-constant": ("a0", 0.004127875), "static-alpha": ("a1", 0.021279816), "static-qp": ("a2", 0.030849643)}

# The published model does not know of the laser.
PUBLISHED = SOURCE / "data/models/c130-psfd-eq18.toml"
LASER = 'lams_airspeed = "VLAMS"\nattack = "ATTACK"\nsideslip = "SSLIP"'
MODEL = replace(r"^attack_differential_pressure.*$", r"\g<0>\n" + LASER)(PUBLISHED.read_text())
OTHER_SYSTEM = SOURCE / "data/models/c130-psfrd-eq18.toml"

# The short scenario with a turn, and a speed run of more than 40 m/s, from which on it is called one.
SCENARIO = replace(r"^duration = 120$", '\\g<0>\n\n[[leg]]\nkind = "turn"')(
    replace(r"^high = 135$", "high = 140")((SOURCE / "data/scenarios/c130-short.toml").read_text())
)
SHORT_GV = (SOURCE / "data/scenarios/gv-eq20.toml").read_text().split("[[leg]]")[0] + """
[[leg]]
kind = "take-off"
altitude = 1500
speed = 140

[[leg]]
kind = "level"
duration = 120
"""

MADE = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)  # a browser that ends still writes
FLIGHTS = Path(MADE.name)
ONE, TWO, GV, STEADY = (FLIGHTS / name for name in ("one.nc", "two.nc", "gv.nc", "steady.nc"))


def setUpModule():
    for output, text, seed in ((ONE, SCENARIO, 3), (TWO, SCENARIO, 4), (GV, SHORT_GV, 20)):
        simulate(TOOL, output, text, seed)
    # A seed whose sideslip term is found between its bounds.
    simulate(TOOL, STEADY, (SOURCE / "data/scenarios/c130-no-manoeuvres.toml").read_text(), 2)


def tearDownModule():
    MADE.cleanup()


def with_effect(text):
    return lambda model: model + "\n[[effect]]\n" + text


def with_a0(value, more=""):
    return replace(r"^parameters = \{ a0 = .*$", f"parameters = {{ a0 = {value} }}{more}")


def contents(folder):
    return {path.name: path.read_bytes() if path.is_file() else None for path in folder.iterdir()}


# Their calibration is uncertain, and the covariance gives its correlation with the coefficients.
THERMOMETER = ["temp-offset.offset", "recovery-factor.da"]


DETAILED = ("inspect", "compare", "refit", "diagnose", "improve", "check", "temperature", "process")


class ComparisonTest(ToolTest):
    def model(self, change=lambda toml: toml, name="model.toml"):
        path = self.path / name
        path.write_text(change(MODEL))
        return path

    def write(self, name, text):
        path = self.path / name
        path.write_text(text)
        return path

    def done(self, *arguments, **options):
        """A successful run, with all details in its text."""
        has_details = arguments[0] in DETAILED and "--quiet" not in arguments
        result = self.run_tool(*arguments, *("--verbose",) * has_details, **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def json_of(self, *arguments):
        return json.loads(self.done(*arguments, "--json", "-").stdout)

    def compare(self, *arguments, flights=(ONE,), model=None):
        return self.json_of("compare", *flights, "-m", model or self.model(), *arguments)

    def refit(self, *arguments, flights=(ONE,), model=None, output=None):
        model, output = model or self.model(), output or self.path / "out.toml"
        return self.json_of("refit", *flights, "-m", model, "-o", output, *arguments)

    def refused(self, *arguments, words, output=None, status=1):
        """One line with the words; no file is written, with or without an existing output."""
        output = output or self.path / "out.toml"
        if arguments[0] == "refit" and not {"-o", "--output"} & set(arguments):
            arguments += ("-o", output)
        for old in (False, True):
            if old and output.parent.exists() and not output.exists():
                output.write_text("old")
            before = contents(self.path)
            result = self.run_tool(*arguments)
            self.assertEqual(contents(self.path), before, "files were changed or left behind")
            self.assertEqual(result.returncode, status, result.stderr)
            self.assertEqual(result.stdout, "")
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr[:2000])
            self.assertRegex(result.stderr, r"^pcor: ")
            self.assertNotRegex(result.stderr, r"; ?\n$", "no text after the semicolon")
            for word in words:
                self.assertIn(str(word), result.stderr)
        return result.stderr

    def run_as_printed(self, text):
        """Runs the command at the end of a text in a shell."""
        command = re.search(r": (\S*pcor \S.*)$", text.rstrip().splitlines()[-1]).group(1)
        environment = os.environ | {"PATH": f"{TOOL.parent}:{os.environ['PATH']}"}
        result = subprocess.run(command, shell=True, cwd=self.path, env=environment, capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, command + "\n" + result.stderr)
        return command

    def link(self, flight, name):
        path = self.path / name
        path.symlink_to(flight)
        return path


def values_of(refit):
    return {name: value for effect in refit["effects"] for name, value in effect["parameters"].items()}


def errors_of(refit):
    return {name: value for effect in refit["effects"] for name, value in effect["stderr"].items()}


def addresses_in(html):
    """The name of the SVG language is excepted: a browser does not request it."""
    return set(re.findall(r"https?://[^\s\"'<>]+", html)) - {"http://www.w3.org/2000/svg"}


class Compare(ComparisonTest):
    def assert_has_the_keys(self, model):
        self.assertLessEqual({"name", "rms_hpa", "bias_hpa", "noise_rms_hpa", "samples", "regimes"}, set(model))
        self.assertTrue(model["regimes"])
        for regime in model["regimes"]:
            self.assertLessEqual({"name", "rms_hpa", "bias_hpa", "samples"}, set(regime))

    def test_json_of_one_model(self):
        models = self.compare("--reference", "lams")["models"]
        self.assertEqual(len(models), 1)
        self.assert_has_the_keys(models[0])

    def test_json_of_two_models(self):
        models = self.compare("-m", self.model(name="other.toml"), "--reference", "lams")["models"]
        self.assertEqual(len(models), 2)
        for model in models:
            self.assert_has_the_keys(model)
        self.assertEqual(models[0]["samples"], models[1]["samples"])

    def test_json_goes_to_a_file_beside_the_text(self):
        result = self.done("compare", ONE, "-m", self.model(), "--json", self.path / "out.json")
        self.assertIn("residual", result.stdout)
        self.assertIn("models", json.loads((self.path / "out.json").read_text()))

    def test_is_quiet(self):
        result = self.done("compare", ONE, "-m", self.model(), "--quiet")
        self.assertEqual((result.stdout, result.stderr), ("", ""))

    def test_command_to_copy_for_a_good_model(self):
        self.model(name="my model.toml")
        self.link(ONE, "flight 1.nc")
        text = self.done("compare", "flight 1.nc", "-m", "my model.toml", cwd=self.path).stdout
        self.assertIn("process", self.run_as_printed(text))

    def test_command_to_copy_corrects_all_flights(self):
        self.model()
        flights = [self.link(flight, name).name for flight, name in ((ONE, "flight 1.nc"), (TWO, "flight 2.nc"))]
        text = self.done("compare", *flights, "-m", "model.toml", cwd=self.path).stdout
        self.assertIn("process", self.run_as_printed(text))
        self.assertEqual(sorted(path.name for path in (self.path / "corrected").iterdir()), flights)

    def test_short_table_has_the_largest_ratio_and_counts_the_other_rows(self):
        def ratios(text):
            return {name: float(ratio) for name, ratio in re.findall(r"^  (\S.*?)  +\d+ .* ([\d.]+)$", text, flags=re.MULTILINE)}

        model = self.model(with_a0(0.007))
        for more in ((), ("--reference", "lams", "--reference", "total:PSFRD+QCFR")):
            with self.subTest(more):
                all_rows = ratios(self.done("compare", ONE, "-m", model, *more).stdout.split("worst minutes")[0])
                text = self.run_tool("compare", ONE, "-m", model, *more).stdout
                rows = ratios(text)
                self.assertEqual(max(rows.values()), max(all_rows.values()))
                omitted = int(re.search(r"(\d+) rows omitted \(--verbose\)", text).group(1))
                self.assertGreaterEqual(omitted, len(all_rows) - len(rows))

    def test_short_table_has_the_regimes_with_the_largest_ratio_and_bias(self):
        arguments = ("compare", ONE, "-m", self.model(with_a0(0.007)), "--reference", "lams", "--reference", "total:PSFRD+QCFR")
        model = json.loads(self.done(*arguments, "--json", "-").stdout)["models"][0]
        text = self.run_tool(*arguments).stdout
        long = [part for part in model["regimes"] if part["samples"] >= 0.01 * model["samples"]]
        for worst in (max(long, key=lambda part: part["rms_hpa"] / part["noise_rms_hpa"]), max(long, key=lambda part: abs(part["bias_hpa"]))):
            self.assertIn(f"\n  {worst['name']} ", text)

    def test_a_residual_of_zero_has_no_autocorrelation_time(self):
        text = self.done("compare", ONE, "-m", self.model(), "--reference", f"static:{self.model()}").stdout
        self.assertIn("worst minutes", text)
        self.assertNotRegex(text, r"\bnan\b")

    def test_the_advised_command_names_few_of_many_flights(self):
        for many, shown in ((16, 16), (17, 2)):
            flights = [self.link(ONE if i % 2 else TWO, f"flight {many}-{i}.nc").name for i in range(many)]
            text = self.done("compare", *flights, "-m", self.model(with_a0(0.007)), cwd=self.path).stdout
            advice = text.rstrip().splitlines()[-1]
            self.assertEqual([flight for flight in flights if flight in advice],
                             flights if shown == many else [flights[0], flights[-1]])
            self.assertEqual(" ... " in advice, shown != many)

    def test_command_to_copy_for_a_failing_model(self):
        self.model(with_a0(0.007), name="it's mine.toml")
        flights = [self.link(flight, name).name for flight, name in ((ONE, "flight 1.nc"), (TWO, "flight 2.nc"))]
        text = self.done("compare", *flights, "-m", "it's mine.toml", "--exclude", "pitch manoeuvre",
                         "--min-airspeed", "70", cwd=self.path).stdout
        command = shlex.split(self.run_as_printed(text))
        self.assertEqual(command[1], "refit")
        for word in (*flights, "pitch manoeuvre", "it's mine.toml", "70"):
            self.assertIn(word, command)

    def test_every_record_is_used_or_has_a_reason(self):
        result = self.compare()
        with netCDF4.Dataset(ONE) as flight:
            records = len(flight.dimensions["Time"])
        self.assertEqual(sum(result["masks"].values()), records)
        self.assertEqual(result["masks"]["used"], result["models"][0]["samples"])

    def test_the_true_law_leaves_the_noise(self):
        """Floor and rms are estimated from about 1000/4 independent samples: each to 1/sqrt(2 x 250) = 4.5 %, the ratio
        to 6 %; the tolerance of 20 % is three times that."""
        model = self.compare()["models"][0]
        self.assertAlmostEqual(model["rms_hpa"] / model["noise_rms_hpa"], 1.0, delta=0.20)

    def test_the_true_law_has_no_bias(self):
        """Tolerance: four standard errors, exceeded by chance in 1 of 16000 cases."""
        model = self.compare()["models"][0]
        self.assertLess(abs(model["bias_hpa"]), 4.0 * model["bias_stderr_hpa"])

    def test_an_error_of_a0_is_the_bias(self):
        """The residual is linear in a0, so two models differ by 1e-3 p to the rounding of the floats in the file (1e-7
        of p). The residual is reference minus model: a larger a0 makes it smaller."""
        residuals = self.path / "residuals.nc"
        other = self.model(with_a0(0.005127875), "other.toml")
        first, second = self.compare("-m", other, "--residuals", residuals)["models"][:2]
        with netCDF4.Dataset(ONE) as flight, netCDF4.Dataset(residuals) as file:
            pressure = flight["PSFD"][:][file["MASK"][:] == 0].astype(float).mean()
        self.assertAlmostEqual(second["bias_hpa"] - first["bias_hpa"], -1e-3 * pressure, delta=1e-6 * pressure)

    def test_the_better_model_is_named(self):
        worse = self.model(lambda toml: with_a0(0.007)(toml).replace("equation 18\"", "worse\""), "worse.toml")
        text = self.done("compare", ONE, "-m", worse, "-m", self.model()).stdout
        self.assertIn("C-130 PSFD/QCF, equation 18 has the smallest rms.", text)

    def test_gps_does_not_rank_models_or_apply_a_wrong_one(self):
        """A model of zeros corrects nothing. The noise by GPS contains gusts and errors of the model, so it is not
        compared with the rms."""
        zeros = self.model(lambda toml: replace(r" = [\d.]+ \}$", " = 0 }")(toml).replace("equation 18\"", "zeros\""), "zeros.toml")
        for models in ((zeros,), (zeros, self.model())):
            names = [word for model in models for word in ("-m", model)]
            run = self.run_tool("compare", ONE, *names, "--reference", "wind", "--reference", "height")
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertNotIn("smallest rms", run.stdout)
            self.assertNotIn("close to the noise", run.stdout)
            self.assertRegex(run.stdout, r"(?m)^residual by height, hPa .* GPS bias .* max noise")
            if len(models) == 1:
                self.assertRegex(run.stdout.rstrip().splitlines()[-1], "pcor refit .* --reference height --reference wind ")

    def test_heights_alone_advise_no_refit(self):
        """Heights do not determine the level of delta-p, so a refit to heights keeps the level of the model."""
        zeros, page, output = self.model(replace(r" = [\d.]+ \}$", " = 0 }")), self.path / "compare.html", self.path / "compare.json"
        text = self.run_tool("compare", ONE, "-m", zeros, "--reference", "height", "--report", page, "--json", output).stdout.splitlines()
        self.assertIn("GPS does not determine the mean delta-p error", text[0])
        self.assertIn(f'aria-label="Summary"><ul>\n<li>{text[0]}</li>', page.read_text())
        self.assertNotIn("refit", text[-1])
        self.assertEqual(set(json.loads(output.read_text())["worst_references"][0]), {"name", "reference"})

    def test_gps_supports_only_a_model_with_a_small_error(self):
        """The law is true; only circles determine the level to 0.15 hPa, half the limit."""
        circles = self.path / "circles.nc"
        self.done("simulate", SOURCE / "data/scenarios/c130-circles.toml", "-o", circles, "--quiet")
        for flight, is_supported in ((ONE, False), (circles, True)):
            result = self.run_tool("compare", flight, "-m", PUBLISHED, "--reference", "wind", "--reference", "height").stdout
            stated = float(re.search(r"correction of [-+][\d.]+ \+- ([\d.]+) hPa", result).group(1))
            self.assertEqual(stated < 0.15, is_supported)
            self.assertEqual("pcor process" in result.rstrip().splitlines()[-1], is_supported, result)

    def test_the_bias_by_wind_has_the_sign_of_the_missing_correction(self):
        low = self.model(lambda toml: replace(r"a0 = [\d.]+", "a0 = 0.0")(toml), "low.toml")
        name = "a law with a name that is longer than the first column of the table"
        again = self.write("again.toml", replace(r'^name = .*$', f'name = "{name}"')(low.read_text()))
        names = ("-m", low, "-m", again, "--reference", "wind")
        result = self.json_of("compare", ONE, *names)
        self.assertGreater(result["by_gps"][0]["missing_hpa"], 2.0)
        self.assertGreater(result["models"][0]["bias_hpa"], 2.0)
        rows = re.findall(r"(?m)^model \d +\d.*$", self.run_tool("compare", ONE, *names).stdout)
        self.assertEqual([len(row) for row in rows], [89, 89], rows)

    def test_a_model_of_another_aircraft_names_both(self):
        of_gv = SOURCE / "data/models/gv-psf-2014.toml"
        self.refused("compare", ONE, "-m", of_gv, "--reference", "wind", words=["N677F", "N130AR"])

    def test_a_comparison_of_laws_of_one_system_is_no_test(self):
        result = self.compare("--reference", f"static:{PUBLISHED}", model=PUBLISHED)
        self.assertEqual(result["models"][0]["rms_hpa"], 0.0)
        self.assertTrue(any("PSFD" in note["text"] and note["severity"] == "warning" for note in result["notes"]))
        text = self.done("compare", ONE, "-m", PUBLISHED, "--reference", f"static:{PUBLISHED}").stdout
        self.assertNotIn("refit", text.rstrip().splitlines()[-1])

    def test_an_excluded_regime_is_counted(self):
        everything, without = self.compare(), self.compare("--exclude", "turn")
        turn = next(regime for regime in everything["models"][0]["regimes"] if regime["name"] == "turn")
        self.assertEqual(everything["masks"]["regime"], 0)
        self.assertEqual(without["masks"]["regime"], turn["samples"])
        self.assertEqual(without["masks"]["used"], everything["masks"]["used"] - turn["samples"])
        self.assertNotIn("turn", [regime["name"] for regime in without["models"][0]["regimes"]])

    def test_an_excluded_minute_is_counted(self):
        intervals = self.write("intervals.toml", 'format = "pcor-intervals/1"\n[[exclude]]\nbegin = "20:10:00"\n'
                               'end = "20:11:00"\nreason = "a test"\n')
        masks = self.compare("--intervals", intervals)["masks"]
        self.assertEqual(masks["excluded"], 60)
        self.assertEqual(masks["used"], self.compare()["masks"]["used"] - 60)

    def test_an_interval_outside_the_flight_gives_a_warning(self):
        intervals = self.write("intervals.toml", 'format = "pcor-intervals/1"\n[[exclude]]\nbegin = "03:10:00"\n'
                               'end = "03:11:00"\nreason = "a test"\n')
        text = self.run_tool("compare", ONE, "-m", self.model(), "--intervals", intervals).stdout
        self.assertRegex(text, "(?m)^warning.*03:10:00 to 03:11:00")

    def test_all_intervals_outside_the_flight_give_one_note(self):
        intervals = self.write("intervals.toml", 'format = "pcor-intervals/1"\n' + "".join(
            f'[[veto]]\nbegin = {begin}\nend = {end}\n' for begin, end in
            (("2011-11-18T20:10:00Z", "2011-11-18T20:11:00Z"), ("03:10:00", "03:11:00"), ("04:10:00", "04:11:00"))))
        notes = [note for note in self.compare("--intervals", intervals)["notes"] if "[[veto]]" in note["text"]]
        self.assertEqual([note["severity"] for note in notes], ["warning"])
        self.assertRegex(notes[0]["text"], r"03:10:00 to 03:11:00 and 2 more")

    def test_an_added_regime_has_its_statistics(self):
        intervals = self.write("intervals.toml", 'format = "pcor-intervals/1"\n[[add]]\nregime = "cloud"\n'
                               'begin = 2011-11-17T20:10:00Z\nend = 2011-11-17T20:12:00Z\n')
        regimes = self.compare("--intervals", intervals)["models"][0]["regimes"]
        self.assertIn(("cloud", 120), [(regime["name"], regime["samples"]) for regime in regimes])

    def test_flights_are_distinguished(self):
        result = self.compare(flights=(ONE, TWO))
        flights = result["models"][0]["flights"]
        self.assertEqual([flight["name"] for flight in flights], ["one.nc", "two.nc"])
        self.assertEqual(sum(flight["samples"] for flight in flights), result["models"][0]["samples"])

    def test_standard_error_is_empty(self):
        self.assertEqual(self.done("compare", ONE, TWO, "-m", self.model()).stderr, "")

    def test_report_is_one_file_without_network_access(self):
        report = self.path / "out.html"
        model = self.model()
        before = set(contents(self.path))
        self.done("compare", ONE, "-m", model, "--report", report, "--quiet")
        self.assertEqual(set(contents(self.path)) - before, {"out.html"})
        text = report.read_text()
        self.assertNotRegex(text, r"""(src|href|srcset|data)\s*=\s*["']?\s*(https?:)?//""")
        self.assertNotRegex(text, r"""url\(\s*["']?(https?:)?//|@import|fetch\(|XMLHttpRequest|import\(""")
        self.assertEqual(addresses_in(text), set())


class Table(ComparisonTest):
    def test_has_a_row_for_each_flight_and_model(self):
        table = self.path / "flights.csv"
        both = self.compare("--table", table, flights=(ONE, TWO))
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["flight"] for row in rows], ["one.nc", "two.nc"])
        self.assertEqual(sum(int(row["samples"]) for row in rows), both["models"][0]["samples"])
        squares = sum(int(row["samples"]) * float(row["rms_hpa"]) ** 2 for row in rows)
        self.assertAlmostEqual((squares / both["models"][0]["samples"]) ** 0.5 / both["models"][0]["rms_hpa"], 1.0,
                               delta=1e-12)


class ResidualFile(ComparisonTest):
    def residuals(self, *arguments):
        path = self.path / "residuals.nc"
        return path, self.compare("--residuals", path, *arguments)

    def test_ncdump_reads_the_file(self):
        path, _ = self.residuals()
        header = subprocess.run(["ncdump", "-h", path], check=True, capture_output=True, text=True).stdout
        self.assertIn("float RESIDUAL_1(Time)", header)

    def test_rms_equals_that_of_the_json(self):
        """Tolerance: rounding of floats, 6e-8 of each value."""
        path, result = self.residuals("-m", self.model(with_a0(0.005), "other.toml"), "--reference", "lams")
        with xarray.open_dataset(path) as file:
            for number, model in enumerate(result["models"], 1):
                residual = file[f"RESIDUAL_{number}"].values.astype(float)
                used = residual[~numpy.isnan(residual)]
                self.assertEqual(used.size, model["samples"])
                self.assertAlmostEqual(math.sqrt((used**2).mean()) / model["rms_hpa"], 1.0, delta=1e-6)

    def test_mask_marks_missing_residuals(self):
        path, result = self.residuals()
        with xarray.open_dataset(path) as file:
            mask, residual = file["MASK"], file["RESIDUAL_1"].values
            numpy.testing.assert_array_equal(mask.values == 0, ~numpy.isnan(residual))
            meanings = mask.attrs["flag_meanings"].split()
            self.assertEqual(len(meanings), len(mask.attrs["flag_masks"]))
            for bit, name in zip(mask.attrs["flag_masks"], meanings):
                self.assertEqual(numpy.count_nonzero(mask.values & bit), result["masks"][name], name)

    def test_regimes_are_flags(self):
        path, result = self.residuals()
        with xarray.open_dataset(path) as file:
            regime, used = file["REGIME"], file["MASK"].values == 0
            bits = dict(zip(regime.attrs["flag_meanings"].split(), regime.attrs["flag_masks"]))
            counts = {part["name"]: part["samples"] for part in result["models"][0]["regimes"]}
            for name in ("level", "climb", "turn", "pitch manoeuvre", "speed run"):
                flagged = (regime.values & bits[name.replace(" ", "_")]) != 0
                self.assertEqual(numpy.count_nonzero(flagged & used), counts[name], name)

    def test_residual_is_the_difference_of_two_deltas(self):
        """Both refer to the same pressure, so their difference is the residual, to the rounding of floats of 10 hPa
        (1e-6)."""
        path, _ = self.residuals()
        with xarray.open_dataset(path) as file:
            residual = file["RESIDUAL_1"].values
            used = ~numpy.isnan(residual)
            difference = (file["PCOR_REFERENCE_1"] - file["PCOR_1"]).values
            self.assertLess(numpy.abs(difference - residual)[used].max(), 3e-6)

    def test_each_flight_has_its_own_file(self):
        result = self.compare("--residuals", self.path / "r.nc", flights=(ONE, TWO))
        for flight in result["models"][0]["flights"]:
            with xarray.open_dataset(self.path / ("r-" + flight["name"])) as file:
                self.assertEqual(numpy.count_nonzero(file["MASK"].values == 0), flight["samples"])
        self.assertFalse((self.path / "r.nc").exists())

    def test_flights_of_equal_names_are_refused(self):
        (self.path / "a").mkdir()
        flight = self.link(ONE, "a/one.nc")
        self.refused("compare", ONE, flight, "-m", self.model(), "--residuals", self.path / "r.nc", words=["r-one.nc"])


class References(ComparisonTest):
    def test_lams_is_the_first_default_reference(self):
        silent, stated = self.compare(), self.compare("--reference", "lams")
        self.assertEqual(silent["reference"], "LAMS")
        self.assertEqual([model["reference"] for model in silent["models"]],
                         ["lams", "total:PSFRD+QCFR", "height", "wind"])
        self.assertEqual(silent["models"][:1], stated["models"])

    def test_help_lists_default_references(self):
        for command in ("compare", "refit"):
            self.assertIn("default: lams", self.done(command, "--help").stdout)

    def test_each_reference_has_its_own_table(self):
        text = self.done("compare", ONE, "-m", self.model(), "--reference", "pressure:TRUE_PS", "--reference", "height",
                         "--reference", "total:PSFRD+QCFR").stdout
        self.assertIn("references: pressure:TRUE_PS, total:PSFRD+QCFR, height", text)
        self.assertIn("residual = hydrostatic height against GPS height", text)
        self.assertIn("residual = total pressure of 'PSFRD+QCFR'", text)

    def test_a_reference_of_one_model_is_shown_for_that_model_only(self):
        """Each of the two pairs is the second pair of the other."""
        laser = replace(r"^attack_differential_pressure.*$", r"\g<0>\n" + LASER)
        other = self.write("other.toml", laser(OTHER_SYSTEM.read_text()))
        given = ("-m", self.model(), "-m", other)
        told = [(model["name"].split()[1][:-1], model["reference"])
                for model in self.json_of("compare", ONE, *given)["models"]]
        self.assertEqual(told, [("PSFD/QCF", "lams"), ("PSFRD/QCFR", "lams"), ("PSFD/QCF", "total:PSFRD+QCFR"),
                                ("PSFD/QCF", "height"), ("PSFRD/QCFR", "height"), ("PSFD/QCF", "wind"),
                                ("PSFRD/QCFR", "wind"), ("PSFRD/QCFR", "total:PSFD+QCF")])
        text = self.done("compare", ONE, *given).stdout
        self.assertIn("references: lams, total:PSFRD+QCFR, height, wind, total:PSFD+QCF\n", text)
        self.assertRegex(text, r"total pressure of 'PSFD\+QCF', .*\n.*\n.*\nC-130 PSFRD/QCFR, equation 18 +\d")

    def test_the_total_pressure_of_true_systems_is_one(self):
        """Two pairs of transducers with a noise of about 0.01 hPa each; delta-p cancels, so no law is needed."""
        result = self.compare("--reference", "total:PSFRD+QCFR")
        self.assertLess(result["models"][0]["rms_hpa"], 0.05)
        self.assertIsNone(result["models"][0]["r2"])

    def test_the_reference_with_the_largest_ratio_decides(self):
        """A drift of the static transducer by 2 hPa/h changes the total pressure, and hardly the residual by the
        laser."""
        drift = '\n[[effect]]\nid = "time-drift"\non = "PSFD"\nstatic = 2.0\n'
        scenario, flight = self.write("drift.toml", SCENARIO + drift), self.path / "drift.nc"
        self.done("simulate", scenario, "-o", flight, "--quiet")
        report = self.path / "compare.html"
        for name, worst, close, command in ((ONE, "lams", True, "process"), (flight, "total:PSFRD+QCFR", False, "diagnose")):
            with self.subTest(worst):
                result = self.compare("--report", report, flights=(name,))
                self.assertEqual([(each["reference"], each["close_to_noise"]) for each in result["worst_references"]],
                                 [(worst, close)])
                ratios = {each["reference"]: each["rms_over_noise"] for each in result["models"]}
                self.assertEqual(max(ratios[each] for each in ("lams", "total:PSFRD+QCFR")), ratios[worst])
                self.assertEqual(result["worst_references"][0]["rms_over_noise"], ratios[worst])
                text = self.done("compare", name, "-m", self.model()).stdout.splitlines()[-1]
                self.assertIn(f"{ratios[worst]:.1f} times the noise by {worst}", text)
                self.assertIn(f"pcor {command} ", text)
                html = report.read_text()
                self.assertRegex(html, f"{ratios[worst]:.1f} times the noise of [0-9.]+ hPa</h1>")
                self.assertIn(f"pcor {command} ", html)
        # A wrong law too: the reason for a refit is a ratio that a refit changes.
        text = self.done("compare", flight, "-m", self.model(with_a0(0.007))).stdout.splitlines()[-1]
        self.assertRegex(text, r"The rms is [\d.]+ times the noise by lams, and [\d.]+ times the noise by total:PSFRD\+QCFR, which "
                               r"a refit does not change\. To refit its coefficients: ")

    def test_static_system(self):
        """Both laws are true, so the residual is the noise of two transducers, each about 0.01 hPa."""
        result = self.compare("--reference", f"static:{OTHER_SYSTEM}")
        self.assertIn("PSFRD/QCFR", result["reference"])
        self.assertLess(result["models"][0]["rms_hpa"], 0.03)

    def test_true_pressure(self):
        """The law is true, so the residual is the noise of the transducer, about 0.01 hPa."""
        result = self.compare("--reference", "pressure:TRUE_PS")
        self.assertIn("TRUE_PS", result["reference"])
        self.assertLess(result["models"][0]["rms_hpa"], 0.02)

    def test_pressure_of_the_avionics(self):
        """PS_A is 0.6 s late, 0.35 hPa in a climb of 5 m/s: more than the noise, and in total less than 0.5 hPa."""
        result = self.compare("--reference", "pressure:PS_A")
        climb = next(part for part in result["models"][0]["regimes"] if part["name"] == "climb")
        self.assertLess(result["models"][0]["rms_hpa"], 0.5)
        self.assertAlmostEqual(climb["bias_hpa"], 0.35, delta=0.1)

    def test_a_model_without_laser_has_other_references(self):
        result = self.compare("--reference", "pressure:TRUE_PS", model=PUBLISHED)
        self.assertGreater(result["models"][0]["samples"], 900)

    def test_reference_is_in_the_command_to_copy(self):
        self.link(ONE, "one.nc")
        self.model(with_a0(0.007))
        text = self.done("compare", "one.nc", "-m", "model.toml", "--reference", "pressure:PS_A", cwd=self.path).stdout
        self.assertIn("--reference pressure:PS_A", self.run_as_printed(text))

    def test_a_reference_without_variance_has_no_r2(self):
        """With the measured static pressure as the reference, delta-p is 0: there is no variance to explain."""
        model = self.compare("--reference", "pressure:PSFD")["models"][0]
        self.assertIsNone(model["r2"])


class Refit(ComparisonTest):
    def assert_true_law(self, result):
        """Tolerance: four standard errors, exceeded by one of three normal coefficients in 1 of 5000 flights. With 120
        seeds of this short flight a0 and a2 scattered by 1.2 standard errors, which gives 1 of 600 flights; the largest
        deviation was 3.4."""
        effects = [effect for effect in result["effects"] if not effect["id"].startswith("reference:")]
        self.assertEqual([effect["id"] for effect in effects], list(LAW))
        for effect in effects:
            name, truth = LAW[effect["id"]]
            error = effect["stderr"][name]
            self.assertGreater(error, 0.0)
            self.assertLess(abs(effect["parameters"][name] - truth), 4.0 * error, effect)

    def test_json_has_its_keys(self):
        result = self.refit()
        self.assertLessEqual({"effects", "rms_hpa", "r2", "samples", "condition_number"}, set(result))
        for effect in result["effects"]:
            self.assertLessEqual({"id", "parameters", "stderr"}, set(effect))

    def test_unknown_rms_before_is_omitted(self):
        """With the initial coefficients the root is not real at some angles of attack."""
        formula = 'formula = "1 - sqrt(1 + k * sin(60 * attack))"\nparameters = { k = 1.02 }\n'
        effect = f'\n[[effect]]\nid = "root"\nwhere = "static"\nunit = "hPa"\nsource = "test"\n{formula}'
        model, output = self.model(lambda toml: toml + effect), self.path / "out.toml"
        for details in ((), ("--verbose",)):
            result = self.run_tool("refit", ONE, "-m", model, "-o", output, "--json", self.path / "out.json", *details)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIsNone(json.loads((self.path / "out.json").read_text())["rms_before_hpa"])
            rms = next(line for line in result.stdout.splitlines() if line.startswith("rms "))
            self.assertNotIn("nan", rms)

    def test_the_table_equals_single_fits(self):
        table = self.path / "flights.csv"
        self.refit("--table", table, "--holdout", STEADY, "--reference", "lams", flights=(ONE, TWO))
        with open(table, newline="") as file:
            rows = {row["flight"]: row for row in csv.DictReader(file)}
        self.assertEqual({name: row["held_out"] for name, row in rows.items()},
                         {"one.nc": "no", "two.nc": "no", "steady.nc": "yes"})
        self.assertEqual(rows["steady.nc"]["static-qp.a2 alone"], "")
        for flight in (ONE, TWO):
            alone = self.refit("--reference", "lams", flights=(flight,))
            for effect in alone["effects"]:
                for name, value in effect["parameters"].items():
                    column = f"{effect['id']}.{name} alone"
                    self.assertEqual(float(rows[flight.name][column]), value)
                    self.assertEqual(float(rows[flight.name][column + ", standard error"]), effect["stderr"][name])

    def test_finds_the_true_law(self):
        self.assert_true_law(self.refit(model=self.model(with_a0(0.01))))

    def test_result_is_independent_of_the_start(self):
        """Every coefficient is linear, so results differ by the tolerance of the fit, far below a standard error. The
        start is at most 0.02 away: from 0.05, 40 hPa, some samples have no airspeed and are masked."""
        far, near = self.refit(model=self.model(with_a0(0.02))), self.refit()
        self.assertEqual(far["samples"], near["samples"])
        for name, error in errors_of(near).items():
            self.assertAlmostEqual(values_of(far)[name], values_of(near)[name], delta=1e-3 * error)

    def test_finds_the_law_from_another_static_system(self):
        self.assert_true_law(self.refit("--reference", f"static:{OTHER_SYSTEM}", model=self.model(with_a0(0.01))))

    def test_the_written_file_restores_the_model(self):
        """Equal except for the order of a sum: samples and formulas are the same."""
        fit = self.refit(model=self.model(with_a0(0.007)))
        model = self.compare(model=self.path / "out.toml")["models"][0]
        self.assertEqual(model["samples"], fit["samples"])
        self.assertAlmostEqual(model["rms_hpa"] / fit["rms_hpa"], 1.0, delta=1e-9)

    def test_the_written_file_has_results_and_sources(self):
        fit = self.refit()
        file = tomllib.loads((self.path / "out.toml").read_text())
        for effect, of_json in zip(file["effect"], fit["effects"], strict=True):
            self.assertEqual(effect["id"], of_json["id"])
            self.assertEqual(effect["parameters"], of_json["parameters"])
            self.assertEqual(effect["stderr"], of_json["stderr"])
        self.assertEqual(file["covariance"]["parameters"],
                         ["static-constant.a0", "static-alpha.a1", "static-qp.a2", *THERMOMETER])
        # The roots of the diagonal are the standard errors, to rounding.
        for row, error in enumerate(errors_of(fit).values()):
            self.assertAlmostEqual(math.sqrt(file["covariance"]["matrix"][row][row]) / error, 1.0, delta=1e-12)
        provenance = file["provenance"]
        self.assertEqual(provenance["flights"], ["one.nc"])
        self.assertEqual(provenance["samples"], fit["samples"])
        self.assertEqual(provenance["samples_not_used"], {k: v for k, v in fit["masks"].items() if v and k != "used"})
        self.assertEqual(provenance["rms_hpa"], fit["rms_hpa"])
        self.assertRegex(provenance["date"], r"^\d{4}-\d\d-\d\dT")
        self.assertRegex(provenance["program"], r"^pcor \d")

    def test_the_command_to_copy_runs(self):
        self.link(ONE, "flight 1.nc")
        self.model()
        text = self.done("refit", "flight 1.nc", "-m", "model.toml", "-o", "my fit.toml", cwd=self.path).stdout
        self.assertIn("diagnose", self.run_as_printed(text))

    def test_the_command_to_copy_for_several_flights_runs(self):
        flights = [self.link(flight, name).name for flight, name in ((ONE, "flight 1.nc"), (TWO, "flight 2.nc"))]
        self.model()
        text = self.done("refit", *flights, "-m", "model.toml", "-o", "out.toml", cwd=self.path).stdout
        self.run_as_printed(text)

    def test_a_fixed_coefficient_is_unchanged(self):
        for name in ("static-qp", "static-qp.a2"):
            fit = self.refit("--fix", name, model=self.model(replace(r"a2 = .* \}", "a2 = 0.05 }")))
            held = fit["effects"][2]
            self.assertEqual((held["parameters"], held["stderr"], held["fixed"]), ({"a2": 0.05}, {"a2": None}, ["a2"]))
            self.assertEqual(fit["covariance"]["parameters"],
                         ["static-constant.a0", "static-alpha.a1", *THERMOMETER])
            file = tomllib.loads((self.path / "out.toml").read_text())
            self.assertEqual(file["effect"][2]["parameters"], {"a2": 0.05})

    def test_a_coefficient_fixed_in_the_file_can_be_freed(self):
        model = self.model(replace(r"^parameters = \{ a2.*$", '\\g<0>\nfixed = ["a2"]'))
        self.assertIsNone(errors_of(self.refit(model=model))["a2"])
        self.assert_true_law(self.refit("--free", "static-qp", model=model))

    def test_a_stage_finds_its_coefficient_in_its_regime(self):
        fit = self.refit("--stage", "pitch manoeuvre: static-alpha")
        self.assert_true_law(fit)
        # A hundred samples constrain less than a thousand.
        self.assertGreater(errors_of(fit)["a1"], errors_of(self.refit())["a1"])

    def test_the_estimator_is_stated(self):
        fit = self.refit()
        self.assertGreater(len(fit["estimator"]), 40)
        # The law is the true one: what it lacks is below the noise, and the fit is as good as least squares. Huber's
        # loss, which counts outliers less, leaves at most 2 % more.
        self.assertLess(fit["left_hpa"], fit["noise_rms_hpa"])
        self.assertLess(fit["rms_hpa"], 1.02 * fit["least_squares_rms_hpa"])
        self.assertGreaterEqual(fit["drift_hpa"], 0.0)

    def test_coefficient_of_a_stage_is_fixed_in_the_next(self):
        """The other coefficients are those of a fit with the coefficient fixed at the result of the stage, except for
        the weights: the noise of a flight of 20 minutes is estimated with one coefficient more, which changes the
        others by less than half of their standard errors."""
        staged = self.refit("--stage", "pitch manoeuvre: static-alpha")
        a1 = values_of(staged)["a1"]
        held = self.refit("--fix", "static-alpha", model=self.model(replace(r"a1 = .* \}", f"a1 = {a1!r} }}")))
        for name in ("a0", "a2"):
            self.assertAlmostEqual(values_of(staged)[name], values_of(held)[name], delta=0.5 * errors_of(held)[name])

    def test_a_held_out_flight_tests_the_fit_and_does_not_change_it(self):
        fit = self.refit("--holdout", TWO)
        self.assertEqual([(flight["name"], flight["holdout"]) for flight in fit["flights"]],
                         [("one.nc", False), ("two.nc", True)])
        self.assertEqual(values_of(fit), values_of(self.refit()))
        # The same noise in both: the rms of each is known to 4.5 %, of the two to 6 %; three times that.
        first, second = (flight["after"]["rms_hpa"] for flight in fit["flights"])
        self.assertAlmostEqual(first / second, 1.0, delta=0.2)

    def test_a_share_of_the_flight_is_held_out(self):
        fit, everything = self.refit("--training-share", "0.6"), self.refit()
        rows = [(flight["holdout"], flight["after"]["samples"]) for flight in fit["flights"]]
        self.assertEqual(rows, [(False, fit["samples"]), (True, everything["samples"] - fit["samples"])])
        self.assertEqual(fit["samples"], round(0.6 * everything["samples"]))

    def test_outliers_move_least_squares_more_than_huber(self):
        """5 % of the laser speeds are 6 m/s too large, about 6 hPa: ten times the noise, and below the 8 m/s from which
        the laser counts as unlocked. The mean error is 0.3 hPa, 3.5e-4 in a0. Huber's loss limits each outlier to four
        of its ten standard deviations, so the change is less than half that of least squares."""
        spoilt = self.path / "spoilt.nc"
        spoilt.write_bytes(ONE.read_bytes())
        with netCDF4.Dataset(spoilt, "a") as flight:
            speed = flight["VLAMS"][:]
            hit = numpy.random.default_rng(1).random(speed.size) < 0.05
            flight["VLAMS"][:] = numpy.ma.where(hit, speed + 6.0, speed)

        def moved(loss):
            clean, bad = (self.refit("--loss", loss, flights=(flight,)) for flight in (ONE, spoilt))
            return abs(values_of(bad)["a0"] - values_of(clean)["a0"])

        self.assertLess(moved("huber"), 0.5 * moved("none"))

    def test_every_loss_finds_the_true_law(self):
        for loss in ("huber", "none"):
            with self.subTest(loss):
                self.assert_true_law(self.refit("--loss", loss))

    def test_several_flights_have_a_row_each(self):
        arguments = ("refit", ONE, TWO, "-m", self.model(), "-o", self.path / "out.toml")
        fit = self.json_of(*arguments)
        self.assertEqual([flight["name"] for flight in fit["flights"]], ["one.nc", "two.nc"])
        self.assertEqual(sum(flight["after"]["samples"] for flight in fit["flights"]), fit["samples"])
        self.assert_true_law(fit)
        text = self.done(*arguments).stdout
        self.assertRegex(text, r"(?m)^one\.nc +\d+ .*\n^two\.nc +\d+ ")

    def test_standard_error_is_empty(self):
        self.assertEqual(self.done("refit", ONE, "-m", self.model(), "-o", self.path / "out.toml").stderr, "")

    def test_standard_error_is_empty_for_several_flights(self):
        result = self.done("refit", ONE, TWO, "-m", self.model(), "-o", self.path / "out.toml")
        self.assertEqual(result.stderr[:500], "")

    def test_duplicate_flight_is_refused(self):
        self.refused("refit", ONE, ONE, "-m", self.model(), "-o", self.path / "out.toml", words=["given twice", str(ONE)])
        self.refused("refit", ONE, "--holdout", ONE, "-m", self.model(), "-o", self.path / "out.toml",
                     words=["given twice"])

    def test_a_copied_flight_gives_the_same_result(self):
        """Twice the sum of squares has the same minimum, except for the weights: the noise is estimated from twice as
        many samples, and 20 minutes hardly determine its slow part. This changes the estimate by less than its standard
        error. The part of the standard errors due to noise decreases by the square root of two, within a fifth for the
        same reason. The part due to the misfit of the law, which two flights determine better than one flight, may
        increase by a third."""
        copy = self.path / "copy.nc"
        shutil.copy(ONE, copy)
        once, twice = self.refit(), self.refit(flights=(ONE, copy))
        for name, error in errors_of(once).items():
            self.assertAlmostEqual(values_of(twice)[name], values_of(once)[name], delta=error)
            self.assertGreater(errors_of(twice)[name] * math.sqrt(2.0) / error, 0.8)
            self.assertLess(errors_of(twice)[name] / error, 1.35)

    def test_the_memory_limit_does_not_change_results(self):
        """Sums and their order are the same; 1e-9 allows for the steps of the minimiser."""
        for more in ((), ("--stage", "pitch manoeuvre: static-alpha")):
            with self.subTest(more):
                with_memory = self.refit(*more, flights=(ONE, TWO))
                without = self.refit("--memory", "0", *more, flights=(ONE, TWO))
                for name, value in values_of(with_memory).items():
                    self.assertAlmostEqual(values_of(without)[name] / value, 1.0, delta=1e-9)

    def test_the_reference_can_be_fitted_too(self):
        self.refit("--reference", f"static:{OTHER_SYSTEM}", "--refit-reference", self.path / "other.toml")
        other = tomllib.loads((self.path / "other.toml").read_text())
        self.assertEqual(other["variables"]["static_pressure"], "PSFRD")
        self.assertIn("provenance", other)

    def test_every_form_of_the_fitted_reference_is_in_the_command_to_copy(self):
        self.link(ONE, "one.nc")
        self.model()
        zero = replace(r"(?s)^\[\[effect\]\].*", '[[effect]]\nid = "qcf-zero"\nparameters = { offset = 0.0 }\n')
        self.write("its law.toml", OTHER_SYSTEM.read_text())
        self.write("zero.toml", zero(OTHER_SYSTEM.read_text()))
        held = [word for effect in LAW for word in ("--fix", effect)]
        for references, more in ((("static:its law.toml", "pressure:PS_A", "total:its law.toml"), ()),
                                 (("total:zero.toml",), held)):
            with self.subTest(references):
                given = [word for reference in references for word in ("--reference", reference)]
                text = self.done("refit", "one.nc", "-m", "model.toml", "-o", "fitted.toml", *given, *more,
                                 "--refit-reference", "both's.toml", "--force", cwd=self.path).stdout
                told = shlex.split(self.run_as_printed(text))
                after = [re.sub(r":(its law|zero)\.toml", ":both's.toml", reference) for reference in references]
                self.assertEqual([told[i + 1] for i, word in enumerate(told) if word == "--reference"], after)

    def test_report_is_one_file(self):
        report = self.path / "out.html"
        self.refit("--report", report)
        self.assertEqual(addresses_in(report.read_text()), set())

    def test_replaces_an_old_output(self):
        self.write("out.toml", "old")
        self.refit()
        self.assertIn("[provenance]", (self.path / "out.toml").read_text())

    def test_a_bound_that_excludes_the_data_is_reported(self):
        model = self.model(with_a0(0.015, "\nbounds = { a0 = [0.01, 0.02] }"))
        fit = self.refit(model=model)
        self.assertEqual(fit["effects"][0]["at_bound"], ["a0"])
        self.assertEqual(fit["effects"][0]["parameters"]["a0"], 0.01)
        self.assertIn("static-constant.a0 is at its bound 0.01", "\n".join(note_texts(fit)))

    def test_an_undetermined_effect_is_reported(self):
        """Without a yaw manoeuvre the coefficient of the squared sideslip is not determined; the others are."""
        model = self.model(with_effect('id = "static-beta-even"\n'))
        fit = self.refit(flights=(STEADY,), model=model)
        note = next(note for note in note_texts(fit) if "static-beta-even.b2" in note)
        for word in ("is not determined", "--fix static-beta-even.b2", "yaw manoeuvre"):
            self.assertIn(word, note)
        self.assertEqual(fit["effects"].pop()["id"], "static-beta-even")
        self.assert_true_law(fit)

    def test_correlated_coefficients_are_reported(self):
        """Steady legs hardly separate q/p and the Mach number. Their correlation exceeds 0.99 for any noise."""
        model = self.model(with_effect('id = "static-mach"\n'))
        text = self.done("refit", STEADY, "-m", model, "-o", self.path / "out.toml", "--trust-reference").stdout
        self.assertRegex(text, r"correlations above 0\.9\n(.*\n)* *static-qp\.a2 and static-mach\.m1: -(0\.99|1\.00)")


POWERS_OF_MACH = "".join(f'\n[[effect]]\nid = "static-{term}"\n' for term in ("mach", "mach2", "mach3"))


class RefitOfTooMuch(ComparisonTest):
    """The terms of equation 20, six coefficients that all are functions of the speed, on steady legs."""

    def fit(self, *arguments):
        return self.refit(*arguments, flights=(STEADY,), model=self.model(lambda model: model + POWERS_OF_MACH))

    def test_notes_name_coefficients_and_a_manoeuvre(self):
        note = next(note for note in note_texts(self.fit()) if note.startswith("static-mach2.m2 is not determined"))
        self.assertRegex(note, r"static-(qp\.a2|mach\.m1|mach3\.m3) \([+-]0\.9")
        self.assertIn("--fix static-mach2.m2", note)
        self.assertIn("speed run", note)

    def test_result_is_not_worse_than_the_start(self):
        """The start lies inside all bounds, so the minimum within the bounds is not larger. One per cent allows for the
        weights: samples are weighted by the local noise, which the rms does not use."""
        fit = self.fit("--loss", "none")
        self.assertLess(fit["rms_hpa"], 1.01 * fit["rms_before_hpa"])

    def test_omitting_an_effect_does_not_improve_the_result(self):
        """A smaller model is a special case of the larger one; one per cent allows for the weights."""
        fit = self.fit("--loss", "none")
        for omission in fit["omissions"]:
            self.assertLess(fit["rms_hpa"], 1.01 * omission["rms_hpa"], omission["effect"])


class BadInput(ComparisonTest):
    def both(self, *arguments, words, flights=(ONE,), model=None):
        """Both `compare` and `refit` refuse the arguments."""
        model = model or self.model()
        for command, output in (("compare", "--residuals"), ("refit", "--output")):
            with self.subTest(command):
                self.refused(command, *flights, "-m", model, output, self.path / "out.toml", *arguments, words=words)

    def test_flights_of_two_aircraft(self):
        self.both(flights=(ONE, GV), words=["N130AR", "N677F", "one.nc", "gv.nc"])

    def test_held_out_flight_of_another_aircraft(self):
        self.refused("refit", ONE, "--holdout", GV, "-m", self.model(), words=["N130AR", "N677F", "one.nc", "gv.nc"])

    def test_total_pressure_does_not_determine_delta_p(self):
        self.refused("refit", ONE, "-m", self.model(), "--reference", "total:PSFRD+QCFR",
                     words=["static-constant.a0", "reference other than total:"])

    def test_no_such_flight(self):
        self.both(flights=(self.path / "none.nc",), words=["none.nc", "no such file"])

    def test_missing_flight_among_others(self):
        self.both(flights=(ONE, self.path / "none.nc"), words=["none.nc", "no such file"])

    def test_file_that_is_not_a_flight(self):
        self.both(flights=(self.write("flight.nc", "no netCDF\n"),), words=["flight.nc", "netCDF"])

    def test_no_such_model(self):
        self.both(model=self.path / "none.toml", words=["none.toml"])

    def test_absent_reference_variable(self):
        self.both("--reference", "pressure:PS_B", words=["one.nc", "PS_B", "PS_A", "--reference"])

    def test_reference_variable_without_a_pressure_unit(self):
        self.both("--reference", "pressure:VLAMS", words=["one.nc", "VLAMS", "m/s"])

    def test_unknown_reference(self):
        self.both("--reference", "radar", words=["radar", "lams", "static:OTHER.toml", "pressure:VARIABLE"])

    def test_absent_reference_model(self):
        self.both("--reference", "static:none.toml", words=["none.toml", "no such file"])

    def test_no_laser_in_the_model(self):
        words = ["lams_airspeed", "[variables]", "--reference", "static:", "pressure:"]
        self.both(model=PUBLISHED, words=words)
        self.both("--reference", "lams", model=PUBLISHED, words=words)

    def test_no_laser_in_the_flight(self):
        model = self.model(replace('"VLAMS"', '"VLAMX"'))
        self.both(model=model, words=["one.nc", "VLAMX", "VLAMS", "lams_airspeed"])

    def test_every_sample_is_masked(self):
        masks = self.compare()["masks"]
        ground, others = masks["ground"], sum(masks.values()) - masks["ground"]
        words = [f"{others} below the minimum airspeed (--min-airspeed)", f"{ground} ground"]
        self.both("--min-airspeed", "500", words=words)

    def test_a_single_flight_without_samples_is_named(self):
        self.both("--min-airspeed", "500", words=["one.nc"])

    def test_fewer_samples_than_coefficients(self):
        intervals = self.write("intervals.toml", 'format = "pcor-intervals/1"\n'
                               '[[exclude]]\nbegin = "20:00:00"\nend = "20:10:00"\nreason = "all but two"\n'
                               '[[exclude]]\nbegin = "20:10:02"\nend = "21:00:00"\nreason = "all but two"\n')
        self.refused("refit", ONE, "-m", self.model(), "--intervals", intervals,
                     words=["2 samples are too few for 3 coefficients", "fix"])

    def test_inseparable_effects(self):
        model = self.model(with_effect('id = "mine"\nwhere = "static"\nformula = "k * static_pressure"\n'
                                       'parameters = { k = 0.0 }\nunit = "hPa"\n'))
        self.refused("refit", ONE, "-m", model, words=["static-constant.a0", "mine.k", "--fix "])
        self.assertIsNone(errors_of(self.refit("--fix", "mine.k", model=model))["k"])

    def test_effect_that_is_always_zero(self):
        model = self.model(with_effect('id = "mine"\nwhere = "static"\nformula = "k * (FLAPS - FLAPS)"\n'
                                       'parameters = { k = 0.0 }\nunit = "hPa"\n'))
        self.refused("refit", ONE, "-m", model, words=["mine.k", "--fix mine.k"])

    def test_fit_to_the_pressure_under_test(self):
        self.refused("refit", ONE, "-m", self.model(), "--reference", "pressure:PSFD", words=["pressure:PSFD", "circular"])
        advice = self.run_tool("compare", ONE, "-m", self.model(), "--reference", "pressure:PSFD").stdout
        self.assertNotRegex(advice, " refit | process ")

    def test_no_free_coefficient(self):
        fixed = [word for name in LAW for word in ("--fix", name)]
        self.refused("refit", ONE, "-m", self.model(), *fixed, words=["no coefficient is free", "--free"])

    def test_unknown_coefficient(self):
        for option in ("--fix", "--free"):
            with self.subTest(option):
                self.refused("refit", ONE, "-m", self.model(), option, "static-qp.a3",
                             words=[f"{option} static-qp.a3", "did you mean static-qp.a2"])

    def test_bounds_in_wrong_order(self):
        model = self.model(with_a0(0.004, "\nbounds = { a0 = [0.02, 0.01] }"))
        self.refused("refit", ONE, "-m", model, words=["model.toml:", "a0", "bounds", "lower"])

    def test_value_outside_its_bounds(self):
        model = self.model(with_a0(0.004, "\nbounds = { a0 = [0.01, 0.02] }"))
        self.refused("refit", ONE, "-m", model, words=["model.toml:", "a0", "0.004", "bounds"])

    def test_misspelt_regime(self):
        self.both("--exclude", "turns", words=["turns", "did you mean turn"])

    def test_unknown_regime(self):
        self.both("--exclude", "banana", words=["banana", "turn", "cloud"])

    def test_unknown_stage(self):
        for stage, words in (("pitch manoeuvre", ["pitch manoeuvre: static-alpha"]),
                             ("pitch: static-alpha", ["did you mean pitch manoeuvre"]),
                             ("pitch manoeuvre: static-alpa", ["static-alpa", "did you mean static-alpha"]),
                             ("circle: static-alpha", ["no circle", "--intervals"])):
            with self.subTest(stage):
                self.refused("refit", ONE, "-m", self.model(), "--stage", stage, words=["--stage", *words])

    def test_invalid_intervals(self):
        self.both("--intervals", self.path / "none.toml", words=["none.toml"])
        self.both("--intervals", self.write("bad.toml", 'format = "pcor-intervals/1"\n[[add]]\nregime = "pitchy"\n'
                                            'begin = "20:00:00"\nend = "20:10:00"\n'), words=["bad.toml:3:", "pitchy"])

    def test_refit_of_the_reference_needs_a_static_system(self):
        self.refused("refit", ONE, "-m", self.model(), "--refit-reference", self.path / "other.toml",
                     words=["--reference static:OTHER.toml"])

    def test_unknown_loss_is_wrong_usage(self):
        self.refused("refit", ONE, "-m", self.model(), "--loss", "square", words=["square", "huber"], status=2)


    def test_invalid_numbers(self):
        model = self.model()
        for option, value in (("--min-airspeed", "nan"), ("--max-flaps", "many"), ("--memory", "-1"),
                              ("--training-share", "0"), ("--training-share", "1.5")):
            with self.subTest(f"{option} {value}"):
                self.refused("refit", ONE, "-m", model, option, value, words=[option], status=2)
                (self.path / "out.toml").unlink(missing_ok=True)


class BadOutput(ComparisonTest):
    def test_output_is_an_input(self):
        model = self.model()
        flight = self.path / "one.nc"
        flight.write_bytes(ONE.read_bytes())
        for output in (flight, model):
            with self.subTest(output.name):
                self.refused("refit", flight, "-m", model, "-o", output, output=output, words=[output.name, "input"])
                for option in ("--residuals", "--json", "--report"):
                    self.refused("compare", flight, "-m", model, option, output, words=[output.name, "input"])

    def test_output_is_the_reference(self):
        other = self.write("other.toml", OTHER_SYSTEM.read_text())
        self.refused("refit", ONE, "-m", self.model(), "--reference", f"static:{other}", "-o", other, output=other,
                     words=["other.toml", "input"])

    def test_output_is_the_held_out_flight(self):
        flight = self.path / "two.nc"
        flight.write_bytes(TWO.read_bytes())
        self.refused("refit", ONE, "--holdout", flight, "-m", self.model(), "-o", flight, output=flight,
                     words=["two.nc", "input"])

    def test_output_is_the_intervals(self):
        intervals = self.write("intervals.toml", 'format = "pcor-intervals/1"\n')
        self.refused("refit", ONE, "-m", self.model(), "--intervals", intervals, "-o", intervals, output=intervals,
                     words=["intervals.toml", "input"])

    def test_two_outputs_in_one_place(self):
        for option in ("--json", "--report", "--refit-reference"):
            with self.subTest(option):
                output = self.path / "out.toml"
                self.refused("refit", ONE, "-m", self.model(), option, output, words=["out.toml", "twice"])

    def test_a_stopped_run_leaves_no_partial_file(self):
        """Stops runs of about 0.1 s at several moments."""
        scenario, model = self.write("scenario.toml", SCENARIO), self.model()
        before = set(contents(self.path))
        outputs = {"out.nc": ("simulate", scenario, "-o"), "out.toml": ("refit", ONE, "-m", model, "-o"),
                   "residuals.nc": ("compare", ONE, "-m", model, "--residuals")}
        for name, arguments in outputs.items():
            for wait in (0.0, 0.02, 0.05, 0.08):
                with self.subTest(name, wait=wait):
                    run = subprocess.Popen([TOOL, *arguments, self.path / name, "--quiet"])
                    time.sleep(wait)
                    run.terminate()
                    run.wait()
                    left = set(contents(self.path)) - before
                    self.assertLessEqual(left, {name})
                    if left:
                        self.assertGreater((self.path / name).stat().st_size, 1000)
                        (self.path / name).unlink()

    def test_failed_report_leaves_no_residual_file(self):
        residuals = self.path / "residuals.nc"
        report = self.path / "none" / "out.html"
        self.refused("compare", ONE, "-m", self.model(), "--residuals", residuals, "--report", report,
                     output=residuals, words=["none"])

    def test_missing_folder(self):
        missing = self.path / "none"
        self.refused("refit", ONE, "-m", self.model(), "-o", missing / "out.toml", words=[missing, "make it"])
        for option in ("--residuals", "--json", "--report"):
            with self.subTest(option):
                self.refused("compare", ONE, "-m", self.model(), option, missing / "out", words=[missing, "make it"])

    def test_unwritable_second_output_leaves_no_first_output(self):
        for option in ("--json", "--report"):
            with self.subTest(option):
                output = self.path / f"out{option}.toml"
                self.refused("refit", ONE, "-m", self.model(), "-o", output, option, self.path / "none" / "out",
                             output=output, words=["none"])


class Simulate(ComparisonTest):
    def simulate(self, change=lambda text: text, *more):
        scenario = self.write("scenario.toml", change(SCENARIO))
        return self.run_tool("simulate", scenario, "-o", self.path / "out.nc", *more)

    def refuse(self, change, *words):
        self.refuse_file(self.write("scenario.toml", change(SCENARIO)), "scenario.toml:", *words)

    def refuse_file(self, scenario, *words, output=None):
        output = output or self.path / "out.nc"
        self.refused("simulate", scenario, "-o", output, output=output, words=words)

    def test_json_lists_the_flown_legs(self):
        result = self.simulate(lambda text: text, "--json", "-")
        summary = json.loads(result.stdout)
        self.assertEqual((summary["name"], summary["aircraft"], summary["seed"]), ("c130-short", "C-130 N130AR", 3))
        self.assertIn("VLAMS", summary["variables"])
        self.assertIn("TRUE_PS", summary["truth"])
        self.assertEqual(summary["legs"][3]["kind"], "turn")
        with netCDF4.Dataset(self.path / "out.nc") as flight:
            self.assertEqual(len(flight.dimensions["Time"]), summary["records"])

    def test_text_ends_with_the_next_command(self):
        text = self.simulate().stdout
        self.assertRegex(text, r": \S*pcor compare \S+ -m MODEL\.toml\n$")

    def test_a_seed_gives_one_flight_and_another_gives_another(self):
        self.simulate()
        again, one, two = (xarray.load_dataset(path) for path in (self.path / "out.nc", ONE, TWO))
        xarray.testing.assert_equal(again, one)
        self.assertFalse(again["VLAMS"].equals(two["VLAMS"]))

    def test_is_quiet(self):
        result = self.simulate(lambda text: text, "--quiet")
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def test_unknown_effect(self):
        self.refuse(with_effect('id = "static-alpa"\na1 = 0.1\n'), "static-alpa", "did you mean static-alpha")

    def test_unknown_parameter(self):
        self.refuse(with_effect('id = "static-alpha"\na7 = 0.1\n'), "a7", "a1")

    def test_negative_duration(self):
        self.refuse(replace("^duration = 120$", "duration = -120"), "duration", "-120", "give a number from")

    def test_unknown_key(self):
        self.refuse(replace("^seed = 3$", "seed = 3\nsede = 4"), "sede", "did you mean seed")

    def test_unknown_leg(self):
        self.refuse(replace('"yaw"', '"yawn"'), "yawn", "did you mean yaw")

    def test_unknown_term_of_the_law(self):
        self.refuse(replace("static-alpha = 0.02", "static-alpa = 0.02"), "static-alpa", "did you mean static-alpha")

    def test_invalid_toml(self):
        self.refuse(lambda text: "name = \"x\n" + text, "scenario.toml:1:")

    def test_speed_that_cannot_be_flown(self):
        self.refuse(replace("^speed = 105$", "speed = 30"), "30")

    def test_no_such_scenario(self):
        self.refuse_file(self.path / "none.toml", "none.toml")

    def test_output_is_the_scenario(self):
        scenario = self.write("scenario.toml", SCENARIO)
        self.refuse_file(scenario, "scenario.toml", "input", output=scenario)

    def test_missing_folder(self):
        scenario = self.write("scenario.toml", SCENARIO)
        missing = self.path / "none"
        self.refuse_file(scenario, missing, "make it", output=missing / "out.nc")

    def test_invalid_seed(self):
        for seed in ("x", "-3", "1.5"):
            with self.subTest(seed):
                result = self.simulate(lambda text: text, "--seed", seed)
                written = (self.path / "out.nc").exists()
                (self.path / "out.nc").unlink(missing_ok=True)
                self.assertEqual((result.returncode, written), (2, False))
                self.assertEqual(result.stderr.count("\n"), 1)
                self.assertIn("--seed", result.stderr)


if __name__ == "__main__":
    if not os.access(TOOL, os.X_OK):
        sys.exit(f"{TOOL} is not a program")
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
