#!/usr/bin/env python3
"""`pcor temperature` on simulated flights whose thermometer has a known error.

    temperature_test.py TOOL SOURCE_DIRECTORY

The flights are two and a half hours of a C-130 that climbs and descends over a triangle, where isobars rise by 10 m in
100 km. Faults are written into copies of the flights. Random numbers are fixed, so results are the same in every run.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

import netCDF4
import numpy

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
import comparison_test  # noqa: E402
from comparison_test import LASER, PUBLISHED, ComparisonTest, addresses_in, contents, with_a0  # noqa: E402
from scenarios import simulate  # noqa: E402
from tool_test import SOURCE, TOOL, note_texts, replace  # noqa: E402

SCENARIO = (SOURCE / "data/scenarios/c130-climbs.toml").read_text()
GOOD_THERMOMETER = replace("^slope = 0.01$", "slope = 0.0")(replace("^offset = 0.55$", "offset = 0.0")(SCENARIO))
WITH_LASER = replace(r"^attack_differential_pressure.*$", r"\g<0>\n" + LASER)(PUBLISHED.read_text())
OTHER_LAW = SOURCE / "data/models/c130-psfd-eq19.toml"

MADE = tempfile.TemporaryDirectory()
FLIGHTS = Path(MADE.name)
ONE, TWO, THREE = (FLIGHTS / name for name in ("one.nc", "two.nc", "three.nc"))
PROCESSED = FLIGHTS / "processed.nc"

LEVEL = slice(4600, 5100)  # records of ONE: a level leg at 7 km
CLIMB = slice(900, 1200)  # five minutes of the first climb
AND_BACK = slice(0, 5250)  # the first triangle, which ends 30 km from where it began

FLIGHT_KEYS = {"name", "used", "samples", "stretches", "rms_before_m", "rms_after_m"}
SLOPES = ("fitted", "none", "level-legs", "climb-descent", "whole-flight")


def setUpModule():
    for output, seed in ((ONE, 31), (TWO, 32), (THREE, 33)):
        simulate(TOOL, output, SCENARIO, seed)
    subprocess.run([TOOL, "process", ONE, "-m", PUBLISHED, "-o", PROCESSED, "--hydrostatic", "--quiet"], check=True)


def tearDownModule():
    comparison_test.MADE.cleanup()
    MADE.cleanup()


def series(path, name):
    with netCDF4.Dataset(path) as file:
        return numpy.ma.filled(file[name][:].astype(float), numpy.nan)


def changed(name, change):
    """An edit of one variable: `change` gets and returns its values, NaN if missing."""

    def edit(file):
        values = change(numpy.ma.filled(file[name][:].astype(float), numpy.nan))
        file[name][:] = numpy.ma.masked_invalid(values)

    return edit


def without(name):
    return lambda file: file.renameVariable(name, "NOT_" + name)


def in_feet(test):
    """A model that states feet as the unit of GGALT."""
    return test.write("feet.toml", replace(r"^vapor_pressure.*$", '\\g<0>\naltitude = "GGALT"')(
        PUBLISHED.read_text().replace("[temperature]", '[units]\naltitude = "ft"\n\n[temperature]')))


def truth(flight=ONE, processed=PROCESSED):
    """True correction of the measured temperature, a0 (K) and a1, by regression on the simulated air."""
    measured, air = series(processed, "ATX"), series(flight, "TRUE_AT")
    flying = (series(flight, "TRUE_TAS") > 80.0) & ~numpy.isnan(measured)
    slope, constant = numpy.polyfit(measured[flying], (air - measured)[flying], 1)
    return {"a0": constant, "a1": slope}


class TemperatureTest(ComparisonTest):
    def edited(self, *edits, name="flight.nc", flight=ONE):
        path = self.path / name
        shutil.copy(flight, path)
        with netCDF4.Dataset(path, "a") as file:
            for edit in edits:
                edit(file)
        return path

    def part(self, records, name="flight.nc"):
        """Some records of a flight."""
        path = self.path / name
        with netCDF4.Dataset(ONE) as whole, netCDF4.Dataset(path, "w", format=whole.data_model) as file:
            whole.set_auto_maskandscale(False)
            file.set_auto_maskandscale(False)
            file.setncatts(whole.__dict__)
            for dimension in whole.dimensions.values():
                file.createDimension(dimension.name, None if dimension.isunlimited() else len(dimension))
            for variable in whole.variables.values():
                attributes = dict(variable.__dict__)
                copy = file.createVariable(variable.name, variable.dtype, variable.dimensions,
                                           fill_value=attributes.pop("_FillValue", None))
                copy.setncatts(attributes)
                copy[:] = variable[records] if "Time" in variable.dimensions else variable[:]
        return path

    def simulated(self, scenario, name="simulated.nc", seed=41):
        path = self.path / name
        self.done("simulate", self.write("scenario.toml", scenario), "-o", path, "--seed", str(seed), "--quiet")
        return path

    def temperature(self, *arguments, flights=(ONE,), model=PUBLISHED, output=None):
        """--force does not change the numbers if it is not needed."""
        output = output or self.path / "out.toml"
        return self.json_of("temperature", *flights, "-m", model, "-o", output, "--force", *arguments)

    def text_of(self, *arguments, flights=(ONE,), model=PUBLISHED):
        output = self.path / "out.toml"
        return self.done("temperature", *flights, "-m", model, "-o", output, "--force", *arguments).stdout

    def refuse(self, *arguments, words, flights=(ONE,), model=PUBLISHED, status=1, **options):
        output = () if "-o" in arguments else ("-o", self.path / "out.toml")
        return self.refused("temperature", *flights, "-m", model, *arguments, *output, words=words, status=status,
                            **options)

    def process(self, flight, model, *arguments, name="corrected.nc"):
        output = self.path / name
        self.done("process", flight, "-m", model, "-o", output, "--quiet", *arguments)
        return output

    def with_laser(self, change=lambda toml: toml, name="laser.toml"):
        return self.write(name, change(WITH_LASER))

    def assert_is_truth(self, result, errors=3.0):
        """Tolerance: three stated errors, exceeded by chance with 1 of 370 seeds; seeds are fixed."""
        for name, value in truth().items():
            self.assertAlmostEqual(result["coefficients"][name], value, delta=errors * result["stderr"][name])

    def assert_correction_is_truth(self, result, errors=3.0):
        """Like `assert_is_truth` for the correction at each temperature, for any degree."""
        true = truth()
        for at in result["corrections"]:
            value = true["a0"] + true["a1"] * at["temperature_degc"]
            self.assertAlmostEqual(at["correction_k"], value, delta=errors * at["stderr_k"])

    def assert_agree(self, result, other, share):
        """Coefficients agree within a fraction of the stated error."""
        self.assertEqual(result["coefficients"].keys(), other["coefficients"].keys())
        for name, value in result["coefficients"].items():
            self.assertAlmostEqual(other["coefficients"][name], value, delta=share * result["stderr"][name])


class Fit(TemperatureTest):
    def test_json_has_the_keys(self):
        result = self.temperature(flights=(ONE, TWO))
        self.assertLessEqual({"coefficients", "stderr", "sigma_m", "flights", "samples", "covariance",
                              "least_squares", "corrections", "degrees", "per_hpa", "noise", "notes"}, set(result))
        self.assertEqual(result["coefficients"].keys(), result["stderr"].keys())
        self.assertEqual([flight["name"] for flight in result["flights"]], ["one.nc", "two.nc"])
        for flight in result["flights"]:
            self.assertEqual(set(flight), FLIGHT_KEYS)
        self.assertEqual(sum(flight["samples"] for flight in result["flights"]), result["samples"])

    def test_finds_the_error_of_the_thermometer(self):
        for flights in ((ONE,), (TWO,), (ONE, TWO, THREE)):
            with self.subTest(flights=len(flights)):
                result = self.temperature(flights=flights)
                self.assertEqual(set(result["coefficients"]), {"a0", "a1"})
                self.assert_is_truth(result)

    def test_least_squares_is_printed_with_smaller_errors(self):
        result = self.temperature(flights=(ONE, TWO))
        for name, error in result["least_squares"]["stderr"].items():
            self.assertLess(error, 0.5 * result["stderr"][name])

    def test_errors_of_the_correction_follow_from_the_covariance(self):
        result = self.temperature()
        covariance, values = numpy.array(result["covariance"]), list(result["coefficients"].values())
        for at in result["corrections"]:
            powers = at["temperature_degc"] ** numpy.arange(len(values))
            self.assertAlmostEqual(at["correction_k"], powers @ values, delta=1e-9)
            self.assertAlmostEqual(at["stderr_k"], (powers @ covariance @ powers) ** 0.5, delta=1e-9)

    def test_more_flights_make_smaller_errors(self):
        """Errors decrease with the square root of the number of flights, within a quarter, because the noise is
        estimated again."""
        one, three = (self.temperature("--pressure-error", "0", flights=flights)
                      for flights in ((ONE,), (ONE, TWO, THREE)))
        ratio = one["stderr"]["a0"] / three["stderr"]["a0"]
        self.assertAlmostEqual(ratio / 3**0.5, 1.0, delta=0.25)

    def test_noise_of_the_gps_is_that_of_the_scenario(self):
        """0.3 m with a correlation time of 60 s: two and a half hours have 75 independent spans, so the estimate is
        accurate to 1/sqrt(2 x 75), 8 %; the tolerance is three times that."""
        self.assertAlmostEqual(self.temperature()["sigma_m"] / 0.3, 1.0, delta=0.24)

    def test_pressure_error_increases_the_standard_error(self):
        sure, unsure = (self.temperature("--pressure-error", size) for size in ("0", "0.1"))
        expected = (sure["stderr"]["a0"] ** 2 + (0.1 * sure["per_hpa"]["a0"]) ** 2) ** 0.5
        self.assertGreater(unsure["stderr"]["a0"], 1.5 * sure["stderr"]["a0"])
        # An error in proportion to the pressure moves the temperature by a quarter as much, so a fifth is enough.
        self.assertAlmostEqual(unsure["stderr"]["a0"] / expected, 1.0, delta=0.2)

    def test_effect_of_an_error_of_the_pressure(self):
        """Static pressures 0.1 hPa higher change the coefficients by the stated amounts, within a twentieth: the
        pressure also changes the Mach number and the temperature, which the statement excludes."""
        before = self.temperature("--degree", "1")
        flight = self.edited(changed("PSFD", lambda p: p + 0.1))
        after = self.temperature("--degree", "1", flights=(flight,))
        for name, per_hpa in before["per_hpa"].items():
            moved = after["coefficients"][name] - before["coefficients"][name]
            self.assertAlmostEqual(moved / (0.1 * per_hpa), 1.0, delta=0.05)

    def test_text(self):
        text = self.text_of(flights=(ONE, TWO))
        for words in ("one.nc", "two.nc", "likelihood", "std. error", "least squares", "held-out", "too small"):
            self.assertIn(words, text)

    def test_lists_sources_outside_the_stated_error(self):
        """A constant error of the static pressure exceeds the noise many times: 0.3 hPa correspond to about 0.1 K."""
        text = self.text_of("--pressure-error", "0")
        self.assertIn("std. error, noise only", text)
        per_hpa = self.temperature()["per_hpa"]["a0"]
        self.assertRegex(text, f"0.3 hPa .* a0 by {0.3 * abs(per_hpa):.2g} K.* --pressure-error 0.3 ")
        with_it = self.text_of("--pressure-error", "0.3")
        self.assertNotIn("noise only", with_it)
        self.assertIn("constant error of the static pressure of 0.3 hPa", with_it)
        # Without the option: the usual zero of a transducer, and the 0.00045 of the pressure that the law states,
        # at 500 to 900 hPa.
        for arguments, zero, law in (((), 0.1, 0.33),
                                     (("--pressure-error", "0"), 0.0, 0.0), (("--pressure-error", "0.3"), 0.3, 0.3)):
            result = self.temperature(*arguments)
            provenance = tomllib.loads((self.path / "out.toml").read_text())["provenance"]["temperature"]
            for stated in (result, provenance):
                self.assertAlmostEqual(stated["pressure_error_hpa"], zero, delta=1e-12)
                self.assertAlmostEqual(stated["law_error_hpa"], law, delta=0.1 if not arguments else 1e-12)

    def test_a_good_thermometer_needs_no_correction(self):
        flight = self.simulated(GOOD_THERMOMETER)
        text = self.text_of(flights=(flight,))
        self.assertIn("not significant", text)
        self.assertNotIn("To apply it", text)

    def test_a_correction_of_many_usual_errors_is_not_advised(self):
        text = self.text_of(flights=(self.simulated(replace("^offset = 0.55$", "offset = 3.0")(SCENARIO)),))
        self.assertRegex(text, "(?mi)^warning.*times the usual error of a thermometer, 0.3 K")
        self.assertNotIn("To apply it", text)

    def test_harmful_correction_is_not_advised(self):
        """If isobars are assumed level, their slope appears in the correction of a good thermometer."""
        flight = self.simulated(GOOD_THERMOMETER)
        arguments = ("--slope", "none", "--pressure-error", "0")
        one = self.temperature(*arguments, flights=(flight,))["flights"][0]
        self.assertGreater(one["rms_after_m"], one["rms_before_m"])
        self.assertNotIn("To apply it", self.text_of(*arguments, flights=(flight,)))
        self.refuse(*arguments, "--quiet", flights=(flight,), words=["no model was written", "--force"])

    def test_a_lag_is_reported(self):
        lag = '\n[[effect]]\nid = "static-lag"\ntau = 3.0\n\n[[leg]]'
        flight = self.simulated(SCENARIO.replace("\n[[leg]]", lag, 1))
        self.assertIn("a lag of the pressure", " ".join(note_texts(self.temperature(flights=(flight,)))))
        self.assertNotIn("lag", " ".join(note_texts(self.temperature())))

    def test_command_to_copy(self):
        self.write("my model.toml", PUBLISHED.read_text())
        self.link(ONE, "flight 1.nc")
        text = self.done("temperature", "flight 1.nc", "-m", "my model.toml", "-o", "it's fitted.toml",
                         cwd=self.path).stdout
        self.assertIn("pcor process 'flight 1.nc'", self.run_as_printed(text))

    def test_is_quiet(self):
        result = self.done("temperature", ONE, "-m", PUBLISHED, "-o", self.path / "out.toml", "--quiet")
        self.assertEqual((result.stdout, result.stderr), ("", ""))

    def test_standard_error_is_empty(self):
        result = self.done("temperature", ONE, TWO, "-m", PUBLISHED, "-o", self.path / "out.toml")
        self.assertEqual(result.stderr, "")

    def test_report_is_one_file_without_network_access(self):
        report = self.path / "out.html"
        before = set(contents(self.path))
        self.temperature("--report", report, flights=(ONE, TWO))
        self.assertEqual(set(contents(self.path)) - before, {"out.html", "out.toml"})
        text = report.read_text()
        self.assertNotRegex(text, r"""(src|href|srcset|data)\s*=\s*["']?\s*(https?:)?//""")
        self.assertNotRegex(text, r"""url\(\s*["']?(https?:)?//|@import|fetch\(|XMLHttpRequest|import\(""")
        self.assertEqual(addresses_in(text), set())
        for words in ("one.nc", "two.nc", "Coefficients", "std. error", "least squares"):
            self.assertIn(words, text)


class Refusal(TemperatureTest):
    """A calibration that is not significant is not written."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.good = Path(cls.folder.name) / "good.nc"
        simulate(TOOL, cls.good, GOOD_THERMOMETER, 5)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def law(self, name, coefficient, hpa, per_hpa):
        """The law of the flights with an error of the given hPa in one term."""
        value = float(re.search(rf"{coefficient} = (\S+) ", PUBLISHED.read_text()).group(1)) + hpa * per_hpa
        return self.write(f"{name}.toml",
                          replace(rf"{coefficient} = \S+ ", f"{coefficient} = {value} ")(PUBLISHED.read_text()))

    def test_a_wrong_law_is_not_mistaken_for_a_thermometer_error(self):
        """Errors of the constant, of the attack term and of the q term, 0.3 and 1 hPa at 700 hPa, q = 80 hPa and a
        range of the radome ratio of 0.12, with a correct thermometer. The command may refuse or write a correct
        result."""
        terms = {"a0": 1.0 / 700.0, "a1": 1.0 / (700.0 * 0.12), "a2": 1.0 / 80.0}
        for term, hpa in [("a0", 0.0)] + [(term, hpa) for term in terms for hpa in (0.3, -0.3, 1.0, -1.0)]:
            with self.subTest(f"{term} {hpa:+}"):
                model = self.law("wrong", term, hpa, terms[term])
                output, numbers = self.path / "out.toml", self.path / "out.json"
                result = self.run_tool("temperature", self.good, "-m", model, "-o", output, "--json", numbers, "--quiet")
                written = output.exists()
                self.assertEqual(result.returncode, 0 if written else 1)
                self.assertEqual(json.loads(numbers.read_text())["worse"] == "", written)
                for at in json.loads(numbers.read_text())["corrections"]:
                    if written:
                        self.assertLess(abs(at["correction_k"]), max(0.1, 2.0 * at["stderr_k"]))
                    # The joint fit separates an error with q or the attack from the thermometer's error; an
                    # error proportional to the pressure changes the temperature, by 0.11 K for 1 hPa.
                    self.assertLess(abs(at["correction_k"]), 0.15)
                output.unlink(missing_ok=True)

    def test_a_wrong_law_is_named(self):
        model = self.law("wrong", "a2", 1.0, 1.0 / 80.0)
        result = self.temperature(flights=(self.good,), model=model)
        error = next(each for each in result["law_errors"] if each["effect"] == "static-qp")
        self.assertAlmostEqual(error["change"], -1.0 / 80.0, delta=3.0 * error["stderr"])
        self.assertIn("a2 of static-qp is too small by ", " ".join(result["warnings"]))
        # 1 hPa is within three times the 0.3 hPa that the law states, 3 hPa are not: then as much may last.
        usual = self.temperature(flights=(self.good,))["law_error_hpa"]
        self.assertAlmostEqual(result["law_error_hpa"], usual, delta=0.01)
        beyond = self.temperature(flights=(self.good,), model=self.law("beyond", "a2", 3.0, 1.0 / 80.0))
        self.assertGreater(beyond["law_error_hpa"], 1.0)
        text = self.text_of(flights=(self.good,), model=model)
        self.assertRegex(text, r"(?m)^Warning: a2 of static-qp is too small by ")

    def test_an_error_without_its_effect_in_the_law_names_no_coefficient_of_the_law(self):
        model = self.law("without", "a2", 1.0, 1.0 / 80.0)
        toml = model.read_text()
        lacking = self.write("lacking.toml", re.sub(r'\[\[effect\]\]\nid = "static-qp"\n[^\[]*', "", toml))
        self.assertNotEqual(lacking.read_text(), toml)
        result = self.temperature(flights=(self.good,), model=lacking)
        self.assertTrue(any(each["effect"] == "static-qp" for each in result["law_errors"]))
        warnings = " ".join(result["warnings"])
        self.assertIn("varies like static-qp (a2 = ", warnings)
        self.assertNotIn("a2 of static-qp", warnings)

    def test_a_law_that_lacks_an_effect(self):
        """Delta-p increases with the engine torque, which is not in the law."""
        flights = []
        for seed in ("101", "102"):
            flights.append(self.path / f"torque{seed}.nc")
            self.done("simulate", SOURCE / "data/scenarios/c130-hidden.toml", "-o", flights[-1], "--seed", seed, "--quiet")
        self.refuse("--quiet", flights=flights, words=["no model was written", "--force"])
        result = self.temperature(flights=flights)
        for at in result["corrections"]:
            self.assertLess(abs(at["correction_k"]), 2.0 * at["stderr_k"])

    def test_force_is_recorded_only_if_needed(self):
        output = self.path / "out.toml"
        self.temperature(flights=(self.good,))
        self.assertIn("not significant",
                      tomllib.loads(output.read_text())["provenance"]["forced"])
        self.temperature()
        forced = output.read_bytes()
        self.assertNotIn("forced", tomllib.loads(forced.decode())["provenance"])
        self.done("temperature", ONE, "-m", PUBLISHED, "-o", output, "--quiet")
        self.assertEqual(output.read_bytes(), forced)

    def test_refused_result_prints_its_numbers(self):
        report = self.path / "out.html"
        result = self.run_tool("temperature", self.good, "-m", PUBLISHED, "-o", self.path / "out.toml", "--report", report)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 1)
        self.assertRegex(result.stdout, r"C +[+-]\d\.\d+ \+- \d\.\d+ K\n")
        self.assertNotRegex(result.stdout, r"wrote .*toml")
        self.assertTrue(report.exists())
        self.assertFalse((self.path / "out.toml").exists())

    def test_different_thermometers_are_refused(self):
        """One thermometer reads 0.55 K and 1 % too high, the other is correct: the correction of one degrades the
        other."""
        self.refuse("--quiet", flights=(ONE, self.good), words=["no model was written"])
        result = self.temperature(flights=(ONE, self.good))
        parts = {part["part"]: part["correction_k"] for part in result["parts"]["flights"]}
        self.assertAlmostEqual(parts["good.nc"] - parts["one.nc"], 0.5, delta=0.1)  # 0.55 K less 1 % of some -5 C
        self.assertGreater(result["parts"]["spread_of_flights_k"], 0.2)
        self.assertGreater(result["stderr"]["a0"], self.temperature()["stderr"]["a0"])
        text = self.text_of(flights=(ONE, self.good))
        self.assertRegex(text, r"thermometers of the flights differ by 0\.\d+ K, p = [^;]*\(threshold 0\.01\);"
                               r"[^;]*: one\.nc [^;]*, good\.nc ")

    def test_consistent_thermometers_are_accepted(self):
        result = self.temperature(flights=(ONE, TWO, THREE))
        self.assertEqual(result["parts"]["spread_of_flights_k"], 0.0)
        self.assertEqual(result["warnings"], [])
        self.assertEqual(result["worse"], "")
        self.assert_is_truth(result)


class Model(TemperatureTest):
    def test_process_moves_the_temperature_by_the_correction(self):
        """Temperatures are stored as floats of up to 32 degC, to 1e-6 K each; airspeeds of up to 256 m/s to 8e-6."""
        a = self.temperature()["coefficients"]
        after = self.process(ONE, self.path / "out.toml")
        good = (series(PROCESSED, "PCORFLAG") == 0) & (series(after, "PCORFLAG") == 0)
        t, t_after = series(PROCESSED, "ATX")[good], series(after, "ATX")[good]
        self.assertGreater(numpy.count_nonzero(good), 8000)
        numpy.testing.assert_allclose(t_after, t + a["a0"] + a["a1"] * t, rtol=0.0, atol=4e-6)
        numpy.testing.assert_allclose((t_after - a["a0"]) / (1.0 + a["a1"]), t, rtol=0.0, atol=4e-6)
        v, v_after = series(PROCESSED, "TASX")[good], series(after, "TASX")[good]
        numpy.testing.assert_allclose(v_after, v * numpy.sqrt((t_after + 273.15) / (t + 273.15)), rtol=0.0, atol=3e-5)
        for name in ("PCOR", "PSXC", "QCXC", "MACHX"):
            numpy.testing.assert_array_equal(series(after, name)[good], series(PROCESSED, name)[good], name)

    def test_process_reduces_the_temperature_error(self):
        self.temperature()
        after = self.process(ONE, self.path / "out.toml")
        flying = series(ONE, "TRUE_TAS") > 80.0
        error = numpy.abs(series(after, "ATX") - series(ONE, "TRUE_AT"))[flying]
        before = numpy.abs(series(PROCESSED, "ATX") - series(ONE, "TRUE_AT"))[flying]
        self.assertLess(numpy.nanmedian(error), 0.2 * numpy.nanmedian(before))

    def test_only_the_correction_is_added(self):
        result = self.temperature()
        before, after = tomllib.loads(PUBLISHED.read_text()), tomllib.loads((self.path / "out.toml").read_text())
        self.assertEqual(after["effect"][:-1], before["effect"])
        correction = after["effect"][-1]
        self.assertEqual(correction["id"], "temp-calibration")
        self.assertEqual(correction["parameters"], result["coefficients"] | {"a2": 0.0})
        self.assertEqual(correction["stderr"], result["stderr"])
        self.assertEqual(correction["fixed"], ["a0", "a1", "a2"])
        self.assertEqual(after["covariance"]["parameters"], ["temp-calibration.a0", "temp-calibration.a1"])
        self.assertEqual(after["covariance"]["matrix"], result["covariance"])
        self.assertEqual(after["provenance"]["temperature"]["flights"], ["one.nc"])
        for key in before.keys() - {"effect"}:
            self.assertEqual(after[key], before[key])

    def test_a_second_run_replaces_the_correction(self):
        first = self.temperature()
        second = self.temperature(model=self.path / "out.toml", output=self.path / "again.toml")
        self.assertEqual(second["coefficients"], first["coefficients"])
        self.assertEqual((self.path / "again.toml").read_text(), (self.path / "out.toml").read_text())

    def test_refit_keeps_the_correction(self):
        self.temperature(model=self.with_laser())
        before = tomllib.loads((self.path / "out.toml").read_text())["effect"][-1]
        self.refit(flights=(ONE,), model=self.path / "out.toml", output=self.path / "refitted.toml")
        after = tomllib.loads((self.path / "refitted.toml").read_text())
        self.assertEqual(after["effect"][-1]["parameters"], before["parameters"])
        self.assertNotEqual(after["effect"][0]["parameters"], tomllib.loads(WITH_LASER)["effect"][0]["parameters"])

    def test_a_correction_after_a_refit_keeps_the_refit(self):
        self.refit(flights=(ONE,), model=self.with_laser(), output=self.path / "refitted.toml")
        self.temperature(model=self.path / "refitted.toml")
        before, after = (tomllib.loads((self.path / name).read_text()) for name in ("refitted.toml", "out.toml"))
        self.assertEqual(after["effect"][:-1], before["effect"])
        count = len(before["covariance"]["parameters"])
        self.assertEqual(after["covariance"]["parameters"][:count], before["covariance"]["parameters"])
        self.assertEqual([row[:count] for row in after["covariance"]["matrix"][:count]],
                         before["covariance"]["matrix"])


class Iterate(TemperatureTest):
    def test_converges_to_the_truth_and_reports_changes(self):
        """Tolerance of the law: four standard errors, exceeded by chance in 1 of 16000 cases. Tolerance of the
        temperature: three times its standard error and the effect of a pressure error of 0.1 hPa, the rms error of the
        law."""
        result = self.temperature("--iterate", flights=(ONE, TWO), model=self.with_laser())
        self.assertTrue(result["converged"])
        rounds = result["rounds"]
        self.assertGreater(len(rounds), 1)
        self.assertEqual(rounds[-1]["coefficients"], result["coefficients"])
        self.assertLess(rounds[-1]["defect_change_hpa"], 1e-3)
        self.assertLess(rounds[-1]["temperature_change_k"], 1e-3)
        self.assertGreater(rounds[0]["temperature_change_k"], rounds[-1]["temperature_change_k"])
        a, b = (numpy.array(list(each["coefficients"].values())) for each in rounds[-2:])
        moved = [abs((b - a) @ at["temperature_degc"] ** numpy.arange(len(a))) for at in result["corrections"]]
        self.assertAlmostEqual(rounds[-1]["temperature_change_k"], max(moved), delta=1e-9)
        effects = tomllib.loads((self.path / "out.toml").read_text())["effect"]
        for effect in effects[:3]:
            name, value = comparison_test.LAW[effect["id"]]
            self.assertAlmostEqual(effect["parameters"][name], value, delta=4.0 * effect["stderr"][name])
        error = (result["stderr"]["a0"] ** 2 + (0.1 * result["per_hpa"]["a0"]) ** 2) ** 0.5
        self.assertAlmostEqual(result["coefficients"]["a0"], truth()["a0"], delta=3.0 * error)

    def test_result_is_independent_of_the_start(self):
        """Both stop if a round changes the temperature by less than 0.001 K; each round changes it ten times less than
        the one before."""
        near = self.temperature("--iterate", model=self.with_laser())
        far = self.temperature("--iterate", model=self.with_laser(with_a0(0.006), "far.toml"))
        self.assertAlmostEqual(far["coefficients"]["a0"], near["coefficients"]["a0"], delta=3e-3)
        self.assertAlmostEqual(far["coefficients"]["a1"], near["coefficients"]["a1"], delta=3e-4)

    def test_text_has_the_rounds(self):
        text = self.text_of("--iterate", model=self.with_laser())
        self.assertRegex(text, r"round .*change of delta-p, hPa.*change of temperature, K")
        self.assertIn("converged", text)
        self.assertIn("--degree", text)

    def test_another_reference(self):
        result = self.temperature("--iterate", "--reference", "pressure:PS_A")
        self.assertTrue(result["converged"])

    def test_needs_a_laser_or_a_reference(self):
        self.refuse("--iterate", words=["lams_airspeed", "--reference", "pressure:"])

    def test_a_reference_needs_iterate(self):
        self.refuse("--reference", "lams", words=["--reference", "--iterate"])

    def test_archived_flights_are_refused(self):
        self.refuse("--iterate", "--archived", flights=(PROCESSED,), words=["--iterate", "--archived"])


class Archived(TemperatureTest):
    """Archived flights contain the same numbers as floats: steps of about 0.02 m/K to 1e-9, whose errors sum to less
    than a millimetre over a flight, and ATX to 1e-6 K. The remaining difference is due to the end of the search for the
    noise, 0.001 of -2 ln L, and to records at the ends without output: a tenth of the stated error covers both."""

    def test_archived_flight_gives_the_same_result(self):
        self.assert_agree(self.temperature(), self.temperature("--archived", flights=(PROCESSED,)), share=0.1)

    def test_archived_flight_with_a_correction_gives_the_same_result(self):
        raw = self.temperature()
        corrected = self.process(ONE, self.path / "out.toml", "--hydrostatic")
        self.assert_agree(raw, self.temperature("--archived", flights=(corrected,)), share=0.1)

    def test_archived_flight_with_a_curved_correction_gives_the_same_result(self):
        raw = self.temperature()
        self.temperature("--degree", "2")
        corrected = self.process(ONE, self.path / "out.toml", "--hydrostatic")
        self.assert_agree(raw, self.temperature("--archived", flights=(corrected,)), share=0.1)

    def test_several_archived_flights_give_the_same_result(self):
        flights = [self.process(flight, PUBLISHED, "--hydrostatic", name=flight.name) for flight in (ONE, TWO, THREE)]
        raw = self.temperature(flights=(ONE, TWO, THREE))
        # They have no angle of attack, so an error of the law with it is not removed: errors of the noise are
        # 4 % smaller, and coefficients change by sqrt(1.04^2 - 1), 0.3 of them.
        self.assert_agree(raw, self.temperature("--archived", flights=flights), share=0.3)

    def test_ground_velocity_in_components(self):
        """If a flight has no ground speed and track, its archive contains the components of the ground velocity."""
        speed, track = series(ONE, "GGSPD"), numpy.radians(series(ONE, "GGTRK"))

        def components(file):
            for name, values in (("GGVEW", speed * numpy.sin(track)), ("GGVNS", speed * numpy.cos(track))):
                file.createVariable(name, "f4", ("Time",), fill_value=-32767.0)[:] = numpy.ma.masked_invalid(values)
                file[name].units = "m/s"
            for name in ("GGSPD", "GGTRK"):
                file.renameVariable(name, "NOT_" + name)

        flight = self.edited(components)
        raw = self.temperature(flights=(flight,))
        self.assert_agree(self.temperature(), raw, share=0.1)
        archive = self.process(flight, PUBLISHED, "--hydrostatic")
        archived = self.temperature("--archived", flights=(archive,))
        self.assert_agree(raw, archived, share=0.1)
        self.assertNotIn("ground", " ".join(note_texts(archived)))

    def test_every_slope_gives_the_same_result(self):
        for slope in SLOPES:
            with self.subTest(slope):
                raw = self.temperature("--slope", slope, "--degree", "1")
                archived = self.temperature("--slope", slope, "--degree", "1", "--archived", flights=(PROCESSED,))
                self.assert_agree(raw, archived, share=0.1)

    def test_another_model_is_refused(self):
        model = self.write("other.toml", replace(r"a0 = 0\.004127875", "a0 = 0.005")(PUBLISHED.read_text()))
        self.refuse("--archived", flights=(PROCESSED,), model=model,
                    words=["processed.nc", "a0 = 0.004127875", "a0 = 0.005", "--hydrostatic"])
        self.refuse("--archived", flights=(PROCESSED,), model=OTHER_LAW, words=["processed.nc", "--hydrostatic"])

    def test_another_thermometer_is_refused(self):
        model = self.write("other.toml", replace('"TTRR"', '"TTRL"')(PUBLISHED.read_text()))
        self.refuse("--archived", flights=(PROCESSED,), model=model, words=["processed.nc", "TTRR", "TTRL"])

    def test_pressures_by_the_laser_are_refused(self):
        flight = self.process(ONE, self.with_laser(), "--hydrostatic", "--correct-with", "lams")
        self.refuse("--archived", flights=(flight,), model=self.with_laser(), words=["corrected.nc", "LAMS"])

    def test_models_may_differ_outside_the_pressures(self):
        model = self.write("same.toml", replace("^name = .*$", 'name = "another name"')(
            replace(r"^parameters = { a0 = .*$", r"\g<0>\nstderr = { a0 = 1e-5 }")(
                replace("^note = .*$", 'note = "another"')(PUBLISHED.read_text()))))
        self.assert_agree(self.temperature(model=model),
                          self.temperature("--archived", flights=(PROCESSED,), model=model), share=0.1)
        laser = self.with_laser()
        self.assert_agree(self.temperature(model=laser),
                          self.temperature("--archived", flights=(self.process(ONE, laser, "--hydrostatic"),),
                                           model=laser), share=0.1)

    def test_a_height_in_feet(self):
        flight = self.edited(changed("GGALT", lambda height: height / 0.3048),
                             lambda file: file["GGALT"].delncattr("units"))
        archive = self.process(flight, in_feet(self), "--hydrostatic")
        self.assert_agree(self.temperature(),
                          self.temperature("--archived", flights=(archive,), model=in_feet(self)), share=0.1)

    def test_missing_model_attribute_is_refused(self):
        flight = self.edited(lambda file: file["HYDSTEP"].delncattr("model"), flight=PROCESSED)
        self.refuse("--archived", flights=(flight,), words=["flight.nc", "HYDSTEP", "attribute model"])

    def test_missing_hydrostatic_steps_are_refused(self):
        self.refuse("--archived", flights=(self.process(ONE, PUBLISHED),),
                    words=["corrected.nc", "HYDSTEP", "--hydrostatic"])

    def test_needs_a_processed_flight(self):
        self.refuse("--archived", words=["one.nc", "--archived", "pcor process"])

    def test_missing_correction_attribute_is_refused(self):
        flight = self.edited(lambda file: file["HYDSTEP"].delncattr("temperature_calibration"), flight=PROCESSED)
        self.refuse("--archived", flights=(flight,), words=["flight.nc", "HYDSTEP", "temperature_calibration"])


class Options(TemperatureTest):
    def test_every_slope(self):
        """All but `none` subtract the slope of 10 m in 100 km, within three stated errors."""
        for slope in SLOPES:
            with self.subTest(slope):
                result = self.temperature("--slope", slope, "--degree", "1", "--pressure-error", "0")
                if slope == "none":
                    self.assertGreater(abs(result["coefficients"]["a0"] - truth()["a0"]), 0.1)
                    self.assertIn("--slope fitted", " ".join(note_texts(result)))
                else:
                    self.assert_is_truth(result)
                    self.assertLess(result["stderr"]["a0"], 0.035)  # K: 0.026 on this flight, 0.23 with level isobars

    def test_a_zero_slope_size_equals_slope_none(self):
        none = self.temperature("--slope", "none", "--degree", "1")
        zero = self.temperature("--slope-size", "0", "--degree", "1")
        self.assert_agree(none, zero, share=1e-6)
        self.assertIn("--slope fitted", " ".join(note_texts(zero)))

    def test_every_degree(self):
        """A constant is correct at the mean temperature of the climbs; a quadratic is correct at any temperature within
        its errors."""
        for degree in (0, 1, 2):
            with self.subTest(degree):
                result = self.temperature("--degree", str(degree))
                self.assertEqual(list(result["coefficients"]), [f"a{k}" for k in range(degree + 1)])
                if degree > 0:
                    self.assert_correction_is_truth(result)

    def test_degree_is_chosen_by_held_out_flights(self):
        degrees = self.temperature(flights=(ONE, TWO, THREE))["degrees"]
        held_out = {each["degree"]: each["held_out"] for each in degrees}
        self.assertEqual(min(held_out, key=held_out.get), 1)

    def test_climb_rate(self):
        everything, climbs = self.temperature(), self.temperature("--min-climb-rate", "2")
        self.assertLess(climbs["samples"], everything["samples"])
        self.assertGreater(climbs["flights"][0]["stretches"], everything["flights"][0]["stretches"])
        self.assert_is_truth(climbs)

    def test_climb_rate_above_all_climbs_is_refused(self):
        self.refuse("--min-climb-rate", "20", words=["one.nc", "climbs and descents span", "20 m/s"])

    def test_returning_flights_are_excluded(self):
        back = self.part(AND_BACK, "back.nc")
        result = self.temperature("--skip-returning", flights=(ONE, back))
        self.assertEqual([flight["used"] for flight in result["flights"]], [True, False])
        self.assertIn("--skip-returning", result["flights"][1]["left_out"])
        self.assertEqual(result["coefficients"], self.temperature()["coefficients"])
        self.refuse("--skip-returning", flights=(back,), words=["--skip-returning"])

    def test_excluded_interval_is_not_used(self):
        intervals = self.write("intervals.toml", 'format = "pcor-intervals/1"\n[[exclude]]\nbegin = "20:30:00"\n'
                               'end = "20:40:00"\nreason = "a test"\n')
        result, everything = self.temperature("--intervals", intervals), self.temperature()
        self.assertEqual(everything["samples"] - result["samples"], 600)
        self.assertEqual(result["flights"][0]["stretches"], 2)
        self.assert_is_truth(result)


class BadHeight(TemperatureTest):
    def test_steps(self):
        def steps(height):
            height[4000:] += 40.0
            height[6000:] -= 55.0
            return height

        result = self.temperature(flights=(self.edited(changed("GGALT", steps)),))
        self.assertEqual(result["flights"][0]["stretches"], 3)
        self.assertIn("2 step(s)", " ".join(note_texts(result)))
        self.assert_is_truth(result)

    def test_spikes(self):
        def spikes(height):
            height[3000:3010] += 200.0
            height[7000] -= 5000.0
            return height

        result = self.temperature(flights=(self.edited(changed("GGALT", spikes)),))
        self.assertEqual(result["samples"], self.temperature()["samples"] - 11)
        self.assertIn("11 samples", " ".join(note_texts(result)))
        self.assert_is_truth(result)

    def test_dropouts(self):
        def dropouts(height):
            for gap in (slice(2000, 2400), slice(3000, 3060), slice(7000, 7001)):
                height[gap] = numpy.nan
            return height

        result = self.temperature(flights=(self.edited(changed("GGALT", dropouts)),))
        self.assertEqual(result["samples"], self.temperature()["samples"] - 461)
        self.assertIn("461 samples have no GPS height", " ".join(note_texts(result)))
        self.assert_is_truth(result)

    def test_feet_labelled_as_metres(self):
        flight = self.edited(changed("GGALT", lambda height: height / 0.3048))
        self.refuse(flights=(flight,), words=["flight.nc", "GGALT", "in feet", '[units] altitude = "ft"'])
        self.assert_agree(self.temperature(), self.temperature(flights=(flight,), model=in_feet(self)), share=0.1)

    def test_without_a_unit(self):
        flight = self.edited(changed("GGALT", lambda height: height / 0.3048),
                             lambda file: file["GGALT"].delncattr("units"))
        self.refuse(flights=(flight,), words=["flight.nc", "GGALT has no unit", "[units] altitude"])
        self.assert_agree(self.temperature(), self.temperature(flights=(flight,), model=in_feet(self)), share=0.1)

    def test_height_in_feet_gives_the_same_result(self):
        """Values are floats of up to 32768 ft, rounded to 1e-3 ft, far below the noise of 0.3 m."""
        flight = self.edited(changed("GGALT", lambda height: height / 0.3048),
                             lambda file: file["GGALT"].setncattr("units", "ft"))
        self.assert_agree(self.temperature(), self.temperature(flights=(flight,)), share=0.1)

    def test_missing_height_is_refused(self):
        self.refuse(flights=(self.edited(without("GGALT")),), words=["flight.nc", "GGALT", "[variables] altitude"])

    def test_height_without_values_is_refused(self):
        flight = self.edited(changed("GGALT", lambda height: numpy.nan * height))
        self.refuse(flights=(flight,), words=["flight.nc", "GGALT"])

    def test_constant_height(self):
        flight = self.edited(changed("GGALT", lambda height: 0.0 * height + 3000.0))
        self.refuse(flights=(flight,), words=["flight.nc", "GGALT", "pressure altitude"])


class BadInput(TemperatureTest):
    def test_no_climb(self):
        self.refuse(flights=(self.part(LEVEL),), words=["flight.nc", "climbs and descents span", "needs 300 m"])

    def test_pressure_that_rises_with_height(self):
        flight = self.edited(changed("PSFD", lambda p: numpy.nanmin(p) + numpy.nanmax(p) - p))
        self.refuse(flights=(flight,), words=["flight.nc", "GGALT", "pressure altitude"])

    def test_no_latitude(self):
        self.refuse(flights=(self.edited(without("GGLAT")),), words=["flight.nc", "latitude", "GGLAT", "gravity"])

    def test_another_latitude(self):
        def rename(file):
            file.renameVariable("GGLAT", "LAT_IRS2")

        flight = self.edited(rename)
        model = self.write("model.toml", replace(r"^vapor_pressure.*$", '\\g<0>\nlatitude = "LAT_IRS2"')(
            PUBLISHED.read_text()))
        self.assert_agree(self.temperature(), self.temperature(flights=(flight,), model=model), share=1e-6)

    def test_no_heading(self):
        """The ground velocity is sufficient."""
        flight = self.edited(without("THDG"))
        self.assert_agree(self.temperature(), self.temperature(flights=(flight,)), share=1e-6)

    def test_missing_ground_speed_is_reported(self):
        for slope in ("fitted", "whole-flight"):
            with self.subTest(slope):
                result = self.temperature("--slope", slope, flights=(self.edited(without("GGSPD")),))
                self.assertIn("ground", " ".join(note_texts(result)))
                self.assert_is_truth(result)

    def test_missing_ground_speed_and_heading_increase_errors(self):
        flight = self.edited(without("GGSPD"), without("THDG"))
        result, whole = (self.temperature("--pressure-error", "0", flights=(each,)) for each in (flight, ONE))
        self.assertIn("turns", " ".join(note_texts(result)))
        # 0.09 K, where the doubt of humidity and law leaves 0.03 K.
        self.assertGreater(result["stderr"]["a0"], 3.0 * whole["stderr"]["a0"])

    def test_no_humidity(self):
        """Dry air below 5 km resembles a thermometer error of 0.9 K, which must not be written."""
        dry = replace("^moist = true", "moist = false")(replace("^vapor_pressure.*\n", "")(PUBLISHED.read_text()))
        model = self.write("dry.toml", dry)
        self.refuse(model=model, words=["one.nc", "dry", 'vapor_pressure = "EDPC"', "--force"])
        self.refuse(flights=(self.edited(without("EDPC")),), model=model, words=['vapor_pressure = "EWX"'])
        output = self.path / "forced.toml"
        forced = self.run_tool("temperature", ONE, "-m", model, "-o", output, "--force", "--quiet")
        self.assertEqual(forced.returncode, 0)
        self.assertIn("dry", tomllib.loads(output.read_text())["provenance"]["forced"])

    def test_no_thermometer_in_the_model(self):
        model = self.write("model.toml", replace("^recovery_temperature.*\n", "")(PUBLISHED.read_text()))
        self.refuse(model=model, words=["one.nc", "thermometer", "recovery_temperature", "[variables]"])

    def test_no_thermometer_in_the_flight(self):
        model = self.write("model.toml", replace('"TTRR"', '"TTRX"')(PUBLISHED.read_text()))
        self.refuse(model=model, words=["one.nc", "TTRX", "TTRR", "recovery_temperature"])

    def test_a_thermometer_without_a_value(self):
        self.refuse(flights=(self.edited(changed("TTRR", lambda t: numpy.nan * t)),), words=["flight.nc", "TTRR"])

    def test_a_flight_without_records(self):
        self.refuse(flights=(self.part(slice(0, 0)),), words=["flight.nc", "no records"])

    def test_five_minutes(self):
        """A climb of five minutes hardly determines the correction, and the stated errors show it: the slope of isobars
        alone, 10 m in 100 km, is equivalent to 1 K."""
        for degree in ("0", "auto"):
            with self.subTest(degree):
                result = self.temperature("--degree", degree, flights=(self.part(CLIMB),))
                self.assertEqual(result["flights"][0]["samples"], 300)
                middle = result["corrections"][2]
                self.assertGreater(middle["stderr_k"], 0.3)
                true = truth()
                self.assertAlmostEqual(middle["correction_k"], true["a0"] + true["a1"] * middle["temperature_degc"],
                                       delta=3.0 * middle["stderr_k"])

    def test_correction_beyond_its_bounds_is_refused(self):
        """Five minutes do not determine a curve: the result exceeds the bounds of the catalogue."""
        self.refuse("--degree", "2", flights=(self.part(CLIMB),), words=["a2", "--degree"])

    def test_bad_flight_is_excluded_and_listed(self):
        bad = self.edited(changed("GGALT", lambda height: height / 0.3048), name="feet.nc")
        result = self.temperature(flights=(bad, ONE))
        self.assertEqual([flight["used"] for flight in result["flights"]], [False, True])
        self.assertIn("in feet", result["flights"][0]["left_out"])
        self.assertEqual(result["coefficients"], self.temperature()["coefficients"])
        self.assertEqual(tomllib.loads((self.path / "out.toml").read_text())["provenance"]["temperature"]["flights"],
                         ["one.nc"])

    def test_advised_command_uses_a_good_flight(self):
        bad = self.edited(changed("GGALT", lambda height: height / 0.3048), name="feet.nc")
        text = self.text_of(flights=(bad, ONE))
        self.assertRegex(text, r"feet.nc +skipped: .*in feet")
        self.assertIn("pcor process " + str(ONE), text)

    def test_all_flights_unusable(self):
        flights = (self.edited(without("GGLAT"), name="first.nc"), self.edited(without("GGALT"), name="second.nc"))
        self.refuse(flights=flights, words=["2 flights", "first.nc", "latitude"])

    def test_duplicate_flight(self):
        self.refuse(flights=(ONE, ONE), words=["one.nc", "twice"])

    def test_flights_of_two_aircraft(self):
        other = self.edited(lambda file: file.setncattr("platform", "N677F"), name="other.nc")
        self.refuse(flights=(ONE, other), words=["one.nc", "other.nc", "N130AR", "N677F"])

    def test_no_such_files(self):
        none = self.path / "none"
        self.refuse(flights=(ONE, none), words=[none, "no such file"])
        self.refuse(model=none, words=[none, "no such file"])

    def test_a_file_that_is_not_a_flight(self):
        self.refuse(flights=(self.write("flight.nc", "not a flight"),), words=["flight.nc"])

    def test_wrong_usage(self):
        for option, value in (("--degree", "3"), ("--slope", "steep"), ("--min-climb-rate", "-1"),
                              ("--pressure-error", "nan"), ("--slope-size", "many")):
            with self.subTest(option):
                self.refuse(option, value, words=[option], status=2)
                (self.path / "out.toml").unlink(missing_ok=True)
        self.refused("temperature", ONE, "-o", self.path / "out.toml", words=["--model"], status=2)
        (self.path / "out.toml").unlink(missing_ok=True)
        self.refused("temperature", ONE, "-m", PUBLISHED, words=["--output"], status=2)


class Output(TemperatureTest):
    def test_old_output_is_replaced(self):
        self.write("out.toml", "old")
        self.temperature()
        self.assertIn("temp-calibration", (self.path / "out.toml").read_text())

    def test_output_is_an_input(self):
        model = self.write("model.toml", PUBLISHED.read_text())
        flight = self.edited()
        for output in (model, flight):
            with self.subTest(output.name):
                self.refuse("-o", output, flights=(flight,), model=model, output=output,
                            words=[output.name, "input"])
                for option in ("--json", "--report"):
                    self.refuse(option, output, flights=(flight,), model=model, words=[output.name, "input"])

    def test_two_outputs_in_one_place(self):
        for option in ("--json", "--report"):
            with self.subTest(option):
                self.refuse(option, self.path / "out.toml", words=["out.toml", "twice"])

    def test_missing_folder(self):
        missing = self.path / "none"
        self.refuse("-o", missing / "out.toml", words=[missing, "make it"], output=missing / "out.toml")
        for option in ("--json", "--report"):
            with self.subTest(option):
                self.refuse(option, missing / "out", words=[missing, "make it"])


if __name__ == "__main__":
    if not os.access(TOOL, os.X_OK):
        sys.exit(f"{TOOL} is not a program")
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
