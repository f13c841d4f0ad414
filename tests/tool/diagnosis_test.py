#!/usr/bin/env python3
"""`pcor diagnose`, `pcor add` and `pcor improve` on simulated flights with a known fault.

    diagnosis_test.py TOOL SOURCE_DIRECTORY

The flights are 15 minutes of a C-130; the law is equation 18, as in the model. One flight has no fault, one a lag of
the static line, and one an effect of the engines that is not in the catalogue. Random numbers are fixed, so results are
the same in every run.
"""

import os
import shutil
import sys
import tomllib
import unittest

import netCDF4

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
import comparison_test  # noqa: E402
from comparison_test import FLIGHTS, MODEL, PUBLISHED, SHORT_GV, ComparisonTest, contents, with_effect  # noqa: E402
from scenarios import simulate  # noqa: E402
from tool_test import SOURCE, TOOL, note_texts, replace  # noqa: E402

SCENARIO = comparison_test.SCENARIO
LAG = with_effect('id = "static-lag"\ntau = 1.0\n')(SCENARIO)
THRUST = with_effect('id = "unknown"\nwhere = "static"\nof = "ENGTRQ"\nshape = "linear"\nstrength = 3.0\n'
                     "centre = 50\nscale = 100\n")(SCENARIO)
FLAPPED = with_effect('id = "flaps-gear"\non = "PSFD"\ndefect = 1.5\n')(SCENARIO)
PORT = with_effect('id = "static-constant"\non = "PSFD"\na0 = 0.001\n')(SCENARIO)
ONE, LAGGING, LAGGING_TOO, THRUSTING, GV, FLAPS, BIASED = (
    FLIGHTS / name
    for name in ("one.nc", "lag.nc", "lag-too.nc", "thrust.nc", "gv.nc", "flaps.nc", "biased.nc"))
OWN = ('id = "my-thrust"\nwhere = "static"\nformula = "k * (ENGTRQ - 50) / 100"\nparameters = { k = 0.0 }\n'
       'unit = "hPa"\n')


def setUpModule():
    flights = ((ONE, SCENARIO, 3), (LAGGING, LAG, 5), (LAGGING_TOO, LAG, 6), (THRUSTING, THRUST, 7),
               (GV, SHORT_GV, 20), (FLAPS, FLAPPED, 8), (BIASED, PORT, 9))
    for output, text, seed in flights:
        simulate(TOOL, output, text, seed)


def tearDownModule():
    comparison_test.MADE.cleanup()


class DiagnosisTest(ComparisonTest):
    def diagnose(self, *arguments, flights=(ONE,), model=None):
        return self.json_of("diagnose", *flights, "-m", model or self.model(), *arguments)

    def improve(self, *arguments, flights=(ONE,), model=None):
        model, output = model or self.model(), self.path / "out.toml"
        return self.json_of("improve", *flights, "-m", model, "-o", output, *arguments)

    def add(self, *arguments, model=None, name="out.toml"):
        """The extended model as TOML."""
        output = self.path / name
        self.done("add", *arguments, "-m", model or self.model(), "-o", output, "--quiet")
        return tomllib.loads(output.read_text())


class Add(DiagnosisTest):
    def test_an_effect_of_the_catalogue_starts_neutral(self):
        before, after = tomllib.loads(MODEL), self.add("static-lag", "static-beta-even")
        self.assertEqual(after["effect"][:-2], before["effect"])
        self.assertEqual(after["effect"][-2], {"id": "static-lag", "parameters": {"tau": 0.0}})
        self.assertEqual(after["effect"][-1]["id"], "static-beta-even")
        for key in before.keys() - {"effect"}:
            self.assertEqual(after[key], before[key])

    def test_user_defined_effect_is_added(self):
        effect = self.add("my-thrust", "--formula", "k * ENGTRQ / 100", "--where", "static", "--unit", "hPa",
                          "--source", "engine run-up, 2011-11-02")["effect"][-1]
        self.assertEqual(effect, {"id": "my-thrust", "where": "static", "formula": "k * ENGTRQ / 100",
                                  "parameters": {"k": 0.0}, "unit": "hPa", "source": "engine run-up, 2011-11-02"})

    def test_effect_has_the_unit_of_its_location(self):
        self.assertEqual(self.add("mine", "--formula", "k * roll", "--where", "lams")["effect"][-1]["unit"], "m/s")

    def test_required_variables_are_added(self):
        model = self.model(replace(r'^attack = .*\n', ""))
        self.assertEqual(self.add("static-attack", model=model)["variables"]["attack"], "ATTACK")

    def test_variables_of_the_flight_are_used(self):
        flight = self.path / "flight.nc"
        shutil.copy(ONE, flight)
        with netCDF4.Dataset(flight, "a") as file:
            file.renameVariable("ROLL", "ROLL_IRS2")
        added = self.json_of("add", "mine", "--formula", "k * roll", "-m", self.model(), "--flight", flight, "-o",
                             self.path / "out.toml")
        self.assertEqual(added["variables"], {"roll": "ROLL_IRS2"})

    def test_json(self):
        added = self.json_of("add", "static-lag", "-m", self.model(), "-o", self.path / "out.toml")
        self.assertEqual(added, {"added": [{"effect": "static-lag", "parameters": {"tau": 0.0}}], "variables": {},
                                 "model": str(self.path / "out.toml")})

    def test_is_quiet(self):
        result = self.done("add", "static-lag", "-m", self.model(), "-o", self.path / "out.toml", "--quiet")
        self.assertEqual((result.stdout, result.stderr), ("", ""))

    def test_command_to_copy(self):
        self.model(name="my model.toml")
        self.link(LAGGING, "flight 1.nc")
        text = self.done("add", "static-lag", "-m", "my model.toml", "--flight", "flight 1.nc", "-o", "it's new.toml",
                         cwd=self.path).stdout
        self.assertIn("pcor refit 'flight 1.nc'", self.run_as_printed(text))

    def test_adds_an_effect_in_another_shape(self):
        effects = self.add("static-transonic:onset=0.8", "static-beta-odd:static_pressure=-1,dynamic_pressure=1",
                           "ground-effect")["effect"][-3:]
        self.assertEqual((effects[0]["parameters"]["onset"], effects[0]["fixed"]), (0.8, ["onset"]))
        self.assertEqual(effects[1]["scaling"], {"static_pressure": -1, "dynamic_pressure": 1})
        self.assertEqual(effects[2], {"id": "ground-effect", "parameters": {"defect": 0.0}})

    def test_a_scaling_multiplies_the_whole_formula(self):
        text = self.done("add", "psfd-thermal:static_pressure=1", "-m", self.model(), "-o", self.path / "out.toml").stdout
        self.assertIn(" (-per_kelvin * (transducer_temperature - 290) - zero) * (p/700 hPa)^1 ", text)

    def test_adds_a_step_between_flights(self):
        model = self.add("aircraft-step:since=4338.5", "--flight", ONE)
        self.assertEqual(model["variables"]["date"], "Time")
        self.assertEqual(model["effect"][-1]["parameters"], {"step": 0.0, "since": 4338.5})
        dated = self.add("aircraft-step:since=2011-11-17", "--flight", ONE)
        self.assertEqual(dated["effect"][-1]["parameters"]["since"], 4338.0)
        for effect, word in (("aircraft-step", "since=2011-11-17"), ("aircraft-step:static_pressure=1", "since=2011-11-17"),
                             ("aircraft-step:since=2011-02-31", "YYYY-MM-DD"), ("aircraft-step:since=2011-11", "YYYY-MM-DD")):
            with self.subTest(effect):
                self.refused("add", effect, "-m", self.model(), "-o", self.path / "no.toml", words=[word])

    def test_a_calibration_is_fitted_by_temperature(self):
        """A refit of delta-p put its coefficients to their bounds."""
        text = self.done("add", "temp-calibration", "-m", self.model(), "-o", self.path / "out.toml").stdout
        self.assertIn("temperature IN.nc", text)
        self.assertNotIn("refit", text)
        self.assertEqual(tomllib.loads((self.path / "out.toml").read_text())["effect"][-1]["fixed"], ["a0", "a1", "a2"])

    def test_an_added_effect_is_neutral(self):
        """Neutral coefficients change no bit of a residual."""
        self.add("static-lag", "static-attack", "static-mach2")
        first, second = self.compare("-m", self.path / "out.toml")["models"][:2]
        self.assertEqual(first["rms_hpa"], second["rms_hpa"])

    def test_an_added_effect_can_be_fitted(self):
        """Tolerance: four standard errors, exceeded by chance in 1 of 16000 cases."""
        self.add("static-lag", name="lag.toml")
        fit = self.refit(flights=(LAGGING,), model=self.path / "lag.toml")["effects"][-1]
        self.assertAlmostEqual(fit["parameters"]["tau"], 1.0, delta=4.0 * fit["stderr"]["tau"])

    def test_every_catalogue_effect_is_added_or_refused(self):
        """Each effect can be added, or the message names the role whose variable is unknown."""
        for effect in self.json_of("effects")["effects"]:
            with self.subTest(effect["id"]):
                if any(f'id = "{effect["id"]}"' in line for line in MODEL.splitlines()):
                    continue
                output = self.path / "out.toml"
                date = ":since=2011-11-17" if effect["id"] == "aircraft-step" else ""
                result = self.run_tool("add", effect["id"] + date, "-m", self.model(), "--flight", ONE, "-o", output)
                if result.returncode == 0:
                    self.assertIn(effect["id"], [each["id"] for each in tomllib.loads(output.read_text())["effect"]])
                    output.unlink()
                else:
                    self.assertRegex(result.stderr, rf"'{effect['id']}' needs the role '\w+'")
                    self.assertFalse(output.exists())


class Diagnose(DiagnosisTest):
    def assert_has_the_keys(self, result):
        keys = {"verdict", "findings", "unexplained", "residual_rms_hpa", "noise_rms_hpa", "samples", "absorbed",
                "limits", "not_testable", "notes", "threshold"}
        self.assertLessEqual(keys, set(result))
        self.assertLessEqual({"significant", "rms_hpa", "variables"}, set(result["unexplained"]))
        for finding in result["findings"]:
            self.assertLessEqual({"effect", "aliases", "alias_details", "p_value", "rms_before_hpa", "rms_after_hpa",
                                  "parameters", "stderr", "advice", "evidence", "events"}, set(finding))
            self.assertEqual(finding["aliases"], [alias["effect"] for alias in finding["alias_details"]])
            advice = finding["advice_details"]
            self.assertEqual(finding["advice"] == "", finding["aliases"] == [])
            self.assertEqual(advice["power"] > 0, advice["manoeuvre"] != "")
            self.assertLessEqual(advice["power"], 1)

    def test_complete_model_gives_no_finding(self):
        result = self.diagnose()
        self.assert_has_the_keys(result)
        self.assertEqual((result["verdict"], result["findings"]), ("silent", []))
        self.assertGreater(len(result["limits"]), 5)

    def test_text_and_command_without_a_missing_effect(self):
        self.model(name="my model.toml")
        self.link(ONE, "flight 1.nc")
        text = self.done("diagnose", "flight 1.nc", "-m", "my model.toml", cwd=self.path).stdout
        self.assertTrue(text.startswith("silent: No missing effect"), text)
        self.assertIn("pcor process", self.run_as_printed(text))
        for reference in ("height", "wind"):
            self.assertIn(f"\nnot used as a reference: {reference}: compare shows it", text)

    def test_a_missing_effect_is_found(self):
        result = self.diagnose(flights=(LAGGING, LAGGING_TOO))
        self.assert_has_the_keys(result)
        finding = result["findings"][0]
        self.assertIn("static-lag", [finding["effect"], *finding["aliases"]])
        self.assertLess(finding["rms_after_hpa"], finding["rms_before_hpa"])
        self.assertIn("lag", finding["evidence"][0]["flight"])

    def test_text_and_command_with_a_missing_effect(self):
        self.model(name="my model.toml")
        self.link(LAGGING, "flight 1.nc")
        text = self.done("diagnose", "flight 1.nc", "-m", "my model.toml", cwd=self.path).stdout
        self.assertRegex(text, r"^(identified|cannot be told apart|partial): An effect is missing")
        command = self.run_as_printed(text)
        self.assertRegex(command, r"pcor add .* && \S*pcor refit")
        self.assertTrue((self.path / "fitted.toml").exists())

    def test_command_with_a_missing_effect_keeps_the_model(self):
        for name in ("extended.toml", "fitted.toml"):
            given = self.model(name=name)
            before = given.read_bytes()
            self.run_as_printed(self.done("diagnose", LAGGING, "-m", name, cwd=self.path).stdout)
            self.assertEqual(given.read_bytes(), before)

    def test_a_shape_outside_the_model_format_is_reported(self):
        """Both total lines lag behind."""
        scenario = self.write("scenario.toml", with_effect('id = "total-lag"\ntau = 1.9\n')(SCENARIO))
        self.done("simulate", scenario, "-o", self.path / "flight.nc", "--quiet")
        self.model()
        text = self.done("diagnose", "flight.nc", "-m", "model.toml", "--no-file-variables", cwd=self.path).stdout
        self.assertIn("\ntotal-lag was found alike on the other system, which a model file cannot represent: it is added without "
                      "this part.\nTo add it and fit: " + str(TOOL) + " add total-lag ", text)
        self.run_as_printed(text)

    def test_a_formula_is_a_candidate(self):
        """Sign of the correction: the pressure error of the engines is added back."""
        result = self.diagnose("--try", "k * (ENGTRQ - 50) / 100", flights=(THRUSTING,))
        self.assertIn("try-1", [name for each in result["findings"] for name in (each["effect"], *each["aliases"])])

    def test_a_formula_of_a_file_is_a_candidate(self):
        result = self.diagnose("--candidates", self.model(with_effect(OWN), "own.toml"), flights=(THRUSTING,))
        named = [name for each in result["findings"] for name in (each["effect"], *each["aliases"])]
        self.assertIn("my-thrust", named)

    def test_untestable_candidates_do_not_stop_the_run(self):
        flight = self.path / "flight.nc"
        shutil.copy(ONE, flight)
        with netCDF4.Dataset(flight, "a") as file:
            file.createVariable("EMPTY", "f4", ("Time",), fill_value=-32767.0).units = "1"
        result = self.diagnose("--no-file-variables", "--try", "k * EMPTY", "--try",
                               "k * log(-static_pressure)", "--try", "k * lams_static_defect", flights=(flight,))
        reasons = {each["effect"]: each["reason"] for each in result["not_testable"]}
        for number in range(1, 4):
            self.assertTrue(reasons[f"try-{number}"])

    def test_every_run_gives_the_same_bytes(self):
        words = ("diagnose", ONE, "-m", self.model(), "--no-file-variables", "--json", "-")
        self.assertEqual(self.done(*words).stdout, self.done(*words).stdout)

    def test_is_quiet(self):
        result = self.done("diagnose", ONE, "-m", self.model(), "--no-file-variables", "--quiet")
        self.assertEqual((result.stdout, result.stderr), ("", ""))

    def test_report_is_one_file_without_network_access(self):
        report = self.path / "out.html"
        self.done("diagnose", LAGGING, "-m", self.model(), "--no-file-variables", "--report", report, "--quiet")
        self.assertEqual(comparison_test.addresses_in(report.read_text()), set())


class Improve(DiagnosisTest):
    def test_result_lists_the_steps(self):
        result = self.improve("--holdout", LAGGING_TOO, flights=(LAGGING,))
        self.assertIsNone(result["steps"][0]["added"])
        for step in result["steps"]:
            self.assertLessEqual({"added", "rms_train_hpa", "rms_holdout_hpa", "noise_rms_hpa", "terms", "learnt"},
                                 set(step))
        self.assertGreater(len(result["steps"]), 1)
        self.assertLess(result["steps"][-1]["rms_holdout_hpa"], result["steps"][0]["rms_holdout_hpa"])
        self.assertEqual(result["model"], str(self.path / "out.toml"))
        effects = [effect["id"] for effect in tomllib.loads((self.path / "out.toml").read_text())["effect"]]
        added = [step["added"] for step in result["steps"][1:]]
        self.assertEqual(effects[-len(added):], added)
        self.assertTrue(result["why_stopped"])
        self.assertIn("significant", result["unexplained"])

    def test_text_and_command(self):
        self.model(name="my model.toml")
        self.link(ONE, "flight 1.nc")
        text = self.done("improve", "flight 1.nc", "-m", "my model.toml", "-o", "it's best.toml", cwd=self.path).stdout
        self.assertIn("stopped: no missing effect", text)
        self.assertIn("\nnot used as a reference: wind: compare shows it", text)
        self.assertIn("pcor process", self.run_as_printed(text))

    def test_report_is_one_file_without_network_access(self):
        report = self.path / "out.html"
        self.improve("--report", report)
        self.assertEqual(comparison_test.addresses_in(report.read_text()), set())


class BadInput(DiagnosisTest):
    def both(self, *arguments, words, flights=(ONE,), model=None, status=1):
        """Both `diagnose` and `improve` refuse the arguments."""
        model = model or self.model()
        for command in (("diagnose",), ("improve", "-o", self.path / "out.toml")):
            with self.subTest(command[0]):
                self.refused(command[0], *flights, "-m", model, *command[1:], *arguments, words=words, status=status)

    def refuse_add(self, *arguments, words, model=None, status=1):
        output = () if "-o" in arguments else ("-o", self.path / "out.toml")
        self.refused("add", *arguments, "-m", model or self.model(), *output, words=words, status=status)

    def test_no_model(self):
        self.refused("diagnose", ONE, words=["--model"], status=2)
        self.refused("improve", ONE, "-o", self.path / "out.toml", words=["--model"], status=2)
        self.refused("add", "static-lag", "-o", self.path / "out.toml", words=["--model"], status=2)

    def test_no_output(self):
        self.refused("improve", ONE, "-m", self.model(), words=["--output"], status=2)
        self.refused("add", "static-lag", "-m", self.model(), words=["--output"], status=2)

    def test_no_such_model(self):
        self.both(model=self.path / "none.toml", words=["none.toml", "no such file"])
        self.refuse_add("static-lag", model=self.path / "none.toml", words=["none.toml", "no such file"])

    def test_no_such_flight(self):
        self.both(flights=(self.path / "none.nc",), words=["none.nc", "no such file"])
        self.refuse_add("static-lag", "--flight", self.path / "none.nc", words=["none.nc", "no such file"])

    def test_empty_file(self):
        self.both(flights=(self.write("flight.nc", ""),), words=["flight.nc"])

    def test_missing_variable(self):
        self.both(model=self.model(replace('"QCF"', '"QCFX"')), words=["one.nc", "QCFX", "QCFR", "dynamic_pressure"])

    def test_flights_of_two_aircraft(self):
        self.both(flights=(ONE, GV), words=["N130AR", "N677F", "one.nc", "gv.nc"])

    def test_no_laser_in_the_model(self):
        self.both(model=PUBLISHED, words=["lams_airspeed", "--reference", "static:"])

    def test_no_laser_in_the_flight(self):
        self.both(model=self.model(replace('"VLAMS"', '"VLAMX"')), words=["one.nc", "VLAMX", "lams_airspeed"])

    def test_every_sample_is_masked(self):
        self.both("--min-airspeed", "500", words=["(--min-airspeed)"])

    def test_formula_that_cannot_be_read(self):
        for formula, words in (("k * (ENGTRQ", ["column"]), ("k ** ENGTRQ", ["column 4"]),
                               ("ENGTRQ / 100", ["no coefficient k"])):
            with self.subTest(formula):
                self.both("--try", formula, words=[f"--try '{formula}'", *words])
                self.refuse_add("mine", "--formula", formula, words=[f"--formula '{formula}'", *words])

    def test_formula_with_a_variable_missing_from_all_flights(self):
        self.both("--try", "k * ENGTQR", words=["--try 'k * ENGTQR'", "one.nc", "did you mean ENGTRQ"])
        self.both("--try", "k * roll", "--try", "k * NOTHING", flights=(ONE, LAGGING),
                  words=["--try 'k * NOTHING'", "any of the flights"])

    def test_formula_with_a_variable_of_only_one_flight(self):
        flight = self.path / "flight.nc"
        shutil.copy(LAGGING, flight)
        with netCDF4.Dataset(flight, "a") as file:
            file.renameVariable("ENGTRQ", "ENGTRQ_2")
        self.done("diagnose", ONE, flight, "-m", self.model(), "--try", "k * ENGTRQ_2", "--no-file-variables", "--quiet")

    def test_candidates_that_cannot_be_read(self):
        self.both("--candidates", self.path / "none.toml", words=["none.toml", "no such file"])
        self.both("--candidates", "c130-psfd-eq18", words=["c130-psfd-eq18", "no effect with a formula"])

    def test_excluded_variable_that_no_flight_has(self):
        self.refused("diagnose", ONE, "-m", self.model(), "--not-variable", "ENGTQR",
                     words=["--not-variable ENGTQR", "did you mean ENGTRQ"])

    def test_formula_with_a_variable_missing_from_the_flight(self):
        self.refuse_add("mine", "--formula", "k * ENGTQR", "--flight", ONE,
                        words=["one.nc", "ENGTQR", "did you mean ENGTRQ"])

    def test_formula_with_an_id_of_the_catalogue(self):
        self.refuse_add("static-lag", "--formula", "k * roll", words=["'static-lag'", "another id"])

    def test_one_formula_for_two_effects_is_refused(self):
        self.refuse_add("mine", "thine", "--formula", "k * roll", words=["mine, thine", "one"])

    def test_wrong_unit(self):
        self.refuse_add("mine", "--formula", "k * roll", "--unit", "Pa", words=["--unit Pa", "hPa"])

    def test_wrong_place(self):
        self.refuse_add("mine", "--formula", "k * roll", "--where", "wing", words=["wing", "static"], status=2)

    def test_place_without_formula(self):
        self.refuse_add("static-lag", "--where", "static", words=["--where", "--formula"], status=2)

    def test_unknown_shape(self):
        self.refuse_add("static-transonic:0.8", words=["'0.8'", "static-transonic:NAME=NUMBER"])
        self.refuse_add("static-transonic:onset=x", words=["'x'", "NUMBER"])
        self.refuse_add("static-transonic:strength=1", words=["'strength'", "onset, static_pressure"])
        self.refuse_add("static-transonic:onset=2", words=["onset", "[0.7, 0.95]"])
        self.refuse_add("static-lag:static_pressure=0.5", words=["whole number from -3 to 3"])

    def test_unknown_effect(self):
        self.refuse_add("static-lg", words=["'static-lg'", "did you mean static-lag"])

    def test_effect_that_the_model_has(self):
        self.refuse_add("static-qp", words=["'static-qp'", "already"])
        self.refuse_add("static-lag", "static-lag", words=["'static-lag'", "already"])
        self.refuse_add("my-thrust", "--formula", "k * roll", model=self.model(with_effect(OWN)),
                        words=["'my-thrust'", "already"])

    def test_role_without_a_usual_variable(self):
        self.refuse_add("mine", "--formula", "k * mach * cabin_pressure * dew_point",
                        words=["'mine'", "'dew_point'", 'dew_point = "..."'])

    def test_role_missing_from_the_flight(self):
        flight = self.path / "flight.nc"
        shutil.copy(ONE, flight)
        with netCDF4.Dataset(flight, "a") as file:
            file.renameVariable("PCAB", "P3")
            file["P3"].delncattr("long_name")
        self.refuse_add("mine", "--formula", "k * cabin_pressure", "--flight", flight,
                        words=["'mine'", "'cabin_pressure'", "PCAB"])

    def test_no_effect_to_add(self):
        self.refuse_add(words=["effects"], status=2)

    def test_invalid_numbers(self):
        for option, value in (("--min-airspeed", "nan"), ("--training-share", "0"), ("--training-share", "1.5")):
            with self.subTest(f"{option} {value}"):
                self.both(option, value, words=[option], status=2)


class BadOutput(DiagnosisTest):
    def test_output_is_an_input(self):
        model, own = self.model(), self.model(with_effect(OWN), "own.toml")
        flight, other = self.path / "one.nc", self.path / "two.nc"
        shutil.copy(ONE, flight)
        shutil.copy(ONE, other)
        for output in (model, own, flight, other):
            with self.subTest(output.name):
                words = [output.name, "input"]
                self.refused("improve", flight, "--holdout", other, "--candidates", own, "-m", model, "-o", output,
                             output=output, words=words)
                if output == other:
                    continue
                self.refused("diagnose", flight, "--candidates", own, "-m", model, "--json", output, output=output,
                             words=words)
                if output != own:
                    self.refused("add", "static-lag", "-m", model, "--flight", flight, "-o", output, output=output,
                                 words=words)

    def test_two_outputs_in_one_place(self):
        output = self.path / "out.toml"
        self.refused("improve", ONE, "-m", self.model(), "-o", output, "--report", output, words=["out.toml", "twice"])
        self.refused("add", "static-lag", "-m", self.model(), "-o", output, "--json", output,
                     words=["out.toml", "twice"])

    def test_missing_folder(self):
        missing, model = self.path / "none", self.model()
        for arguments in (("diagnose", ONE, "--json"), ("diagnose", ONE, "--report"), ("improve", ONE, "-o"),
                          ("add", "static-lag", "-o")):
            with self.subTest(arguments):
                self.refused(*arguments, missing / "out", "-m", model, words=[missing, "make it"])

    def test_refused_effect_keeps_the_old_output(self):
        output = self.write("out.toml", "old")
        before = contents(self.path)
        self.run_tool("add", "static-lg", "-m", SOURCE / "data/models/c130-psfd-eq18.toml", "-o", output)
        self.assertEqual(contents(self.path), before)


class WhatTakesPart(DiagnosisTest):
    """The same samples with the same numbers in every command, and the number of excluded samples with them."""

    def test_all_commands_report_the_same_rms_and_noise(self):
        fitted = self.path / "fitted.toml"
        refit = self.refit("--quiet", output=fitted)
        compared = self.compare(model=fitted)["models"][0]
        diagnosed = self.diagnose("--no-file-variables", model=fitted)
        again = self.refit(model=fitted, output=self.path / "again.toml")
        improved = self.improve(model=fitted)["steps"][0]
        told = {"compare": (compared["rms_hpa"], compared["noise_rms_hpa"], compared["samples"]),
                "diagnose": (diagnosed["rms_given_hpa"], diagnosed["noise_rms_hpa"], diagnosed["samples"]),
                "flight": tuple(refit["flights"][0]["after"][key]
                                        for key in ("rms_hpa", "noise_rms_hpa", "samples"))}
        for command, (rms, noise, samples) in told.items():
            with self.subTest(command):
                self.assertAlmostEqual(rms, refit["rms_hpa"], delta=1e-9)  # coefficients are written to 12 digits
                self.assertAlmostEqual(noise, refit["noise_rms_hpa"], delta=1e-9)
                self.assertEqual(samples, refit["samples"])
        # Fitted again, coefficients move within the tolerance of the fit.
        self.assertAlmostEqual(again["rms_before_hpa"], refit["rms_hpa"], delta=1e-9)
        self.assertAlmostEqual(improved["rms_train_hpa"], again["rms_hpa"], delta=1e-9)
        self.assertAlmostEqual(improved["noise_rms_hpa"], again["noise_rms_hpa"], delta=1e-9)

    def test_flap_samples_are_excluded_from_the_fit_and_reported(self):
        fit = self.refit(flights=(FLAPS,))
        self.assertEqual(fit["masks"]["flaps"], fit["flaps_out"]["samples"])
        # 1.5 hPa at 50 %, which the flaps have most of the time.
        self.assertAlmostEqual(fit["flaps_out"]["bias_hpa"], 1.4, delta=0.3)
        text = self.done("refit", FLAPS, "-m", self.model(), "-o", self.path / "out.toml").stdout
        self.assertRegex(text, r"excluded from the fit: \d+ samples with flaps extended, residual \+1\.\d\d \+- 0\.\d\d hPa \(standard error\), "
                               r"scatter \d\.\d\d hPa")

    def test_diagnose_tests_flap_samples(self):
        found = self.diagnose("--no-file-variables", flights=(FLAPS,), model=self.fitted_to(FLAPS))
        self.assertEqual([finding["effect"] for finding in found["findings"]], ["flaps-gear"])
        self.assertAlmostEqual(found["findings"][0]["parameters"]["defect"], 1.5,
                               delta=4.0 * found["findings"][0]["stderr"]["defect"])
        nothing = self.diagnose("--no-file-variables", model=self.fitted_to(ONE))
        self.assertEqual(nothing["findings"], [])
        self.assertIn("flaps-gear", [limit["effect"] for limit in nothing["limits"]])

    def test_model_with_flap_effect_fits_flap_samples(self):
        self.add("flaps-gear", name="flaps.toml")
        fit = self.refit(flights=(FLAPS,), model=self.path / "flaps.toml")
        self.assertEqual((fit["masks"]["flaps"], fit["flaps_out"]["samples"]), (0, 0))
        limited = self.refit("--max-flaps", "5", flights=(FLAPS,), model=self.path / "flaps.toml",
                             output=self.path / "limited.toml")
        self.assertGreater(limited["masks"]["flaps"], 0)

    def test_a_frozen_sensor_is_excluded_and_reported(self):
        flight = self.path / "frozen.nc"
        shutil.copy(ONE, flight)
        with netCDF4.Dataset(flight, "a") as file:
            for name, first, count in (("VLAMS", 700, 100), ("QCF", 900, 60)):
                file[name][first:first + count] = file[name][first]
        result = self.compare(flights=(flight,))
        self.assertEqual(result["masks"]["frozen"], 160)
        for words in (r"VLAMS is frozen at .* m/s from .* \(100 records\)", r"QCF is frozen .* \(60 records\)"):
            self.assertRegex(" ".join(note_texts(result)), words)
        self.assertEqual(self.compare()["masks"]["frozen"], 0)

    def test_neutral_model_keeps_the_samples_of_its_flight(self):
        """An error of 1.4 % of the static pressure changes the airspeed by 7 to 11 m/s."""
        flight = self.path / "off.nc"
        shutil.copy(ONE, flight)
        with netCDF4.Dataset(flight, "a") as file:
            off = 0.014 * file["PSFD"][:]
            file["PSFD"][:], file["QCF"][:] = file["PSFD"][:] - off, file["QCF"][:] + off
        neutral = self.model(replace(r"^parameters = .*$", ""))
        used = self.compare(flights=(flight,), model=neutral)["masks"]["used"]
        self.assertGreater(used, 0.99 * self.compare()["masks"]["used"])

    def fitted_to(self, flight):
        self.refit(flights=(flight,), output=self.path / f"fitted-{flight.stem}.toml")
        return self.path / f"fitted-{flight.stem}.toml"


class DoesNoHarm(DiagnosisTest):
    def test_improve_refuses_a_model_that_is_worse_on_held_out_flights(self):
        """A model fitted to a flight with an error of the port is wrong on the flight without the error."""
        arguments = ("improve", BIASED, "-m", self.model(), "--holdout", ONE, "-o", self.path / "out.toml")
        self.refused(*arguments, words=(" times the rms ", "--force"))
        self.done(*arguments, "--force", "--quiet")
        model = tomllib.loads((self.path / "out.toml").read_text())
        self.assertIn(" times the rms ", model["provenance"]["forced"])
        self.assertIn("covariance", model)

    def test_unnecessary_force_changes_no_output(self):
        improved = self.improve("--force")
        self.assertEqual(improved["worse"], "")
        self.assertNotIn("forced", tomllib.loads((self.path / "out.toml").read_text())["provenance"])

    def test_a_biased_held_out_flight_is_reported(self):
        improved = self.improve("--holdout", BIASED, "--force")
        last = improved["steps"][-1]["diagnosis"]
        self.assertNotEqual(last["verdict"], "silent")
        self.assertTrue(last["held_out"][0]["is_off"])
        self.assertRegex(improved["why_stopped"], r"[Hh]eld-out .*\+\d\.\d+ hPa")


if __name__ == "__main__":
    if not os.access(TOOL, os.X_OK):
        sys.exit(f"{TOOL} is not a program")
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
