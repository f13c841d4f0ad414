#!/usr/bin/env python3
""""What if" in the reports of `pcor diagnose` and `pcor improve`, in headless chromium: the results of the page equal
those of the tool with the command from the page.

    what_if_test.py TOOL SOURCE_DIRECTORY

Without chromium it is skipped (status 77), or fails if PCOR_REQUIRE_CHROMIUM is set.
"""

import json
import os
import subprocess
import sys
import tomllib
import unittest

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
import comparison_test  # noqa: E402
from comparison_test import FLIGHTS, ComparisonTest, with_effect  # noqa: E402
from long_tests import in_long_tests  # noqa: E402
from scenarios import simulate  # noqa: E402
from tool_test import SOURCE, TOOL  # noqa: E402

sys.path.insert(0, str(SOURCE / "tests/report"))
from browser import CHROMIUM, Browser  # noqa: E402

LAG = with_effect('id = "static-lag"\ntau = 1.0\n')(comparison_test.SCENARIO)
SIDESLIP = with_effect('id = "static-beta-even"\non = "PSFD"\nb2 = 0.0002\n')(LAG)
DIAGNOSED = {}
FIRST, SECOND, BOTH, BOTH_TOO = (FLIGHTS / name for name in ("lag-one.nc", "lag-two.nc", "both.nc", "both-too.nc"))


def setUpModule():
    for output, text, seed in ((FIRST, LAG, 31), (SECOND, LAG, 32), (BOTH, SIDESLIP, 33),
                               (BOTH_TOO, SIDESLIP, 34)):
        simulate(TOOL, output, text, seed)
    WhatIfTest.browser = Browser(CHROMIUM, FLIGHTS / "profile", width=1400)


def tearDownModule():
    WhatIfTest.browser.close()
    comparison_test.MADE.cleanup()


class WhatIfTest(ComparisonTest):
    def setUp(self):
        super().setUp()
        self.browser.errors.clear()

    def tearDown(self):
        self.assertEqual(self.browser.errors, [])

    def value(self, expression):
        return self.browser.value(expression)

    def diagnosed(self, *flights):
        """The page of a diagnosis with a model that was fitted to the flights; tests of the same flights share it."""
        if flights not in DIAGNOSED:
            fitted, report = (FLIGHTS / f"{len(DIAGNOSED)}-{name}" for name in ("fitted.toml", "report.html"))
            self.refit(flights=flights, output=fitted)
            DIAGNOSED[flights] = fitted, report, self.json_of("diagnose", *flights, "-m", fitted, "--report", report)
        self.fitted, self.report, self.diagnosis = DIAGNOSED[flights]
        self.open()

    def open(self, wish=""):
        self.browser.open(self.report.as_uri() + wish)

    def middle(self, element):
        self.value(f"{element}.scrollIntoView({{block: 'center'}})")
        self.browser.settle()
        return self.value(f"(({{left, top, width, height}}) => [left + width / 2, top + height / 2])({element}.getBoundingClientRect())")

    def click(self, element):
        self.browser.click(*self.middle(element))
        self.browser.settle()

    def number(self, effect):
        return self.value("pcorReport.whatIf.item.effects.map(({id}) => id)").index(effect)

    def row(self, effect):
        return f"pcorReport.whatIf.rows[{self.number(effect)}]"

    def switch(self, effect):
        self.click(f"{self.row(effect)}.box")

    def button(self, words):
        return f"[...document.querySelectorAll('button')].find((each) => each.textContent.trim() === {json.dumps(words)})"

    def told(self):
        """Results of the page: every coefficient by name with its error, the rms, and the rms of the held-out part."""
        return self.value("""(() => {
          const {item, now, fit} = pcorReport.whatIf;
          const told = {rms: now.rms, heldOut: fit.heldOutRms(now), coefficients: {}};
          item.coefficients.forEach(({name, start}, c) => {
            const owner = item.effects.find(({first, count}) => c >= first && c < first + count);
            told.coefficients[owner ? `${owner.id}.${name}` : name] = [start + now.values[c], now.errors[c]];
          });
          return told;
        })()""")

    def as_copied(self):
        """Results of the tool with the command from the page."""
        command = self.value("pcorReport.whatIf.commandText") + " --json refit.json --quiet"
        environment = os.environ | {"PATH": f"{TOOL.parent}:{os.environ['PATH']}"}
        done = subprocess.run(command, shell=True, cwd=self.path, env=environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, command + "\n" + done.stderr)
        return json.loads((self.path / "refit.json").read_text())

    def assert_same(self, page, refit, added):
        """Added coefficients to 1 %; the others, which may be near zero, to 0.15 of their errors: the page has columns
        from predicted pressures, the refit from recorded pressures."""
        self.assertAlmostEqual(page["rms"], refit["rms_hpa"], delta=0.01 * refit["rms_hpa"])
        for effect in refit["effects"]:
            for name, expected in effect["parameters"].items():
                found, error = page["coefficients"][f"{effect['id']}.{name}"]
                tolerance = 0.01 * abs(expected) if effect["id"] in added else 0.15 * effect["stderr"][name]
                self.assertAlmostEqual(found, expected, delta=tolerance, msg=f"{effect['id']}.{name} +- {error}")
                # The page has the errors by the noise. The tool takes the misfit of the law off before it finds the
                # noise, and knows what held coefficients may err by: a quarter.
                noise = effect["stderr_noise"][name]
                self.assertAlmostEqual(error, noise, delta=0.25 * noise)


class OneEffect(WhatIfTest):
    def test_coefficients_equal_those_of_refit(self):
        self.diagnosed(FIRST, SECOND)
        self.switch("static-lag")
        page = self.told()
        self.assert_same(page, self.as_copied(), {"static-lag"})
        shown = self.value(f"{self.row('static-lag')}.sliders[0].number.valueAsNumber")
        self.assertAlmostEqual(shown, page["coefficients"]["static-lag.tau"][0], delta=1e-3)  # four digits
        self.assertIn("static-lag", self.value("pcorReport.whatIf.steps.bars.map(({label}) => label).join()"))

    def test_the_text_of_the_page_agrees_with_its_numbers(self):
        self.diagnosed(FIRST, SECOND)
        statistics = "statistics(pcorReport.samples.columns.get({!r}).values, pcorReport.samples.indices([pcorReport.samples.columns.get({!r})])).rms"
        self.assertAlmostEqual(self.value(statistics.format("before", "before")), self.diagnosis["residual_rms_hpa"], delta=1e-3)
        self.assertEqual(self.value(statistics.format("what-if", "what-if")), None)  # nothing is switched on
        self.switch("static-lag")
        told = self.told()["rms"]
        self.assertAlmostEqual(self.value(statistics.format("what-if", "what-if")), told, delta=0.005 * told)
        table = self.value("pcorReport.whatIf.regimes.table.tBodies[0].lastChild.lastChild.textContent")
        self.assertAlmostEqual(float(table), told, delta=0.005 * told)
        figures = self.value("pcorReport.whatIf.figures.tBodies[0].rows[0].lastChild.textContent")
        self.assertAlmostEqual(float(figures), told, delta=1e-4)

    def test_a_fitted_model_has_no_rms_on_parts_outside_its_fit(self):
        self.diagnosed(FIRST, SECOND)

        def held_out():
            return self.value("[...pcorReport.whatIf.figures.tBodies[0].rows[1].cells].map(({textContent}) => textContent)")

        labels = "pcorReport.whatIf.steps.bars.map(({label}) => label)"
        _, given, again, _ = held_out()
        self.assertEqual(given, "–")
        self.assertGreater(float(again), 0)
        self.assertNotIn("input model", self.value(labels))
        published = self.path / "published.html"
        self.json_of("diagnose", FIRST, SECOND, "-m", self.model(), "--report", published)
        self.browser.open(published.as_uri())
        self.assertGreater(float(held_out()[1]), 0)
        self.assertIn("input model", self.value(labels))

    def test_effects_that_were_not_found_are_listed_apart(self):
        self.diagnosed(FIRST, SECOND)
        lists = self.value("[...document.querySelectorAll('.what-if-effects')].map((each) => [...each.children].map((row) => row.querySelector('b').textContent))")
        reasons = self.value("pcorReport.whatIf.item.effects.map(({id, why}) => [id, why])")
        self.assertEqual(lists, [[effect for effect, why in reasons if (why == "not found") is apart] for apart in (False, True)])
        gains = self.value("[...document.querySelectorAll('.what-if-effects .gain')].map(({textContent}) => textContent)")
        for gain in gains:
            self.assertRegex(gain, r"^χ² (decreases|increases) by [\d.]+$")

    def test_the_fall_of_chi2_is_the_square_of_a_coefficient_over_its_error(self):
        self.diagnosed(FIRST, SECOND)
        found = self.value("""(() => {
          const {fit, item} = pcorReport.whatIf;
          return item.effects.map((_, e) => [e, fit.coefficientsOf(e)]).filter(([, all]) => all.length === 1).map(([e, [c]]) => {
            const {values, errors} = fit.fit([e]);
            return [values[c] + item.coefficients[c].start - item.coefficients[c].given, errors[c], fit.fall([], [e], new Map(), true)];
          });
        })()""")
        fitted = [each for each in found if each[1] > 0]  # not at a bound
        self.assertGreater(len(fitted), 0)
        for change, error, fall in fitted:
            self.assertAlmostEqual(fall, (change / error) ** 2, delta=1e-3 * fall + 1e-6)

    def test_number_boxes_show_all_digits(self):
        self.diagnosed(FIRST)
        for value, text in ((0.00001146, "1.146e-5"), (-0.00049251, "-4.925e-4"), (0.0016814, "0.001681"), (12.3456, "12.35"), (0, "0")):
            self.assertEqual(self.value(f"boxText({value})"), text)
        clipped = self.value("pcorReport.whatIf.rows.flatMap(({sliders}) => sliders.map(({number}) => number.scrollWidth - number.clientWidth))")
        self.assertLessEqual(max(clipped), 0)

    @in_long_tests
    def test_keys_move_a_slider_and_undo_restores_it(self):
        self.diagnosed(FIRST, SECOND)
        self.switch("static-lag")
        slider = f"{self.row('static-lag')}.sliders[0]"
        free, before = self.told(), self.value(f"{slider}.range.value")
        self.value(f"{slider}.range.focus()")
        for _ in range(40):
            self.browser.key("ArrowLeft")
        self.browser.settle()
        held = self.told()
        step = self.value(f"({slider}.to - {slider}.from) / sliderSteps")
        expected = free["coefficients"]["static-lag.tau"][0] - 40 * step
        # The slider has 1,000 places, and begins at the one nearest to the estimate.
        self.assertAlmostEqual(held["coefficients"]["static-lag.tau"][0], expected, delta=step)
        self.assertEqual(held["coefficients"]["static-lag.tau"][1], 0)
        self.assertGreater(held["rms"], free["rms"])
        self.assertNotEqual(held["coefficients"]["static-constant.a0"], free["coefficients"]["static-constant.a0"])
        address = self.value("location.href")
        for _ in range(40):
            self.click(self.button("Undo"))
            self.browser.settle()
            if self.value(f"{slider}.range.value") == before:
                break
        self.assertAlmostEqual(self.told()["rms"], free["rms"], delta=1e-9)
        self.browser.open(address)  # as a colleague does
        self.assertAlmostEqual(self.told()["rms"], held["rms"], delta=1e-6)
        self.click(f"{slider}.fitted")
        self.assertAlmostEqual(self.told()["rms"], free["rms"], delta=1e-9)
        self.click("pcorReport.whatIf.reset")
        self.assertNotIn("whatIf", self.value("location.href"))
        self.assertFalse(self.value(f"{self.row('static-lag')}.box.checked"))

    def test_moving_a_slider_switches_its_effect_on(self):
        self.diagnosed(FIRST)
        row = self.row("static-lag")
        x, y = self.middle(f"{row}.sliders[0].range")
        self.browser.drag(x, y, x + 60, y)
        self.browser.settle()
        self.assertTrue(self.value(f"{row}.box.checked"))
        self.assertEqual(self.value("[...pcorReport.whatIf.byHand.values()].length"), 1)

    def test_the_models_own_coefficients_can_be_held(self):
        self.diagnosed(FIRST)
        self.switch("static-lag")
        self.click("pcorReport.whatIf.ownSwitch")
        told = self.told()["coefficients"]
        for effect in tomllib.loads(self.fitted.read_text())["effect"]:
            for name, value in effect["parameters"].items():
                self.assertAlmostEqual(told[f"{effect['id']}.{name}"][0], value, delta=1e-9)

    def test_the_command_is_copied(self):
        self.diagnosed(FIRST)
        self.browser.ask("Browser.grantPermissions", permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
        self.switch("static-lag")
        self.click("pcorReport.whatIf.copy")
        self.browser.wait("pcorReport.whatIf.copy.textContent === 'Copied'")
        self.assertEqual(self.value("navigator.clipboard.readText()"), self.value("pcorReport.whatIf.commandText"))

    def test_two_effects_are_compared(self):
        self.diagnosed(FIRST, SECOND)
        self.assertEqual(self.value("pcorReport.whatIf.item.effects[0].id"), "static-lag")
        words = self.value("pcorReport.whatIf.pairWords.textContent")
        self.assertRegex(words, r"correlation of (−?0\.\d{3})")
        of_all = self.value("pcorReport.whatIf.pairTable.tBodies[0].lastChild.lastChild.textContent")
        self.assertIn(f"correlation of {of_all}, after", words)
        rows = self.value("pcorReport.whatIf.pairTable.tBodies[0].rows.length")
        self.assertEqual(rows, self.value("pcorReport.samples.regimes.size") + 1)
        # Contribution of static-lag: the residual with all effects off minus the residual with static-lag.
        self.switch("static-lag")
        differs = self.value("""(() => {
          const {live, residual, sides, nothing, takenOff} = pcorReport.whatIf;
          const none = new Float64Array(live.values.length);
          pcorReport.whatIf.takenOff(nothing.values, none);
          return Math.max(...live.values.map((value, i) => Math.abs(residual.values[i] - none[i] - value - sides[0].values[i])));
        })()""")
        self.assertLess(differs, 1e-9)

    def test_self_test_of_the_page(self):
        self.diagnosed(FIRST, SECOND)
        self.assertEqual(self.browser.self_test(self.report.as_uri())["wrong"], [])
        self.open("#view=%7B%22whatIf%22%3A%7B%22on%22%3A%5B%22static-lag%22%2C%22absent%22%2C7%5D%2C%22by%22%3A3%2C%22pair%22%3A%22x%22%7D%7D")
        self.assertEqual(self.value("[...pcorReport.whatIf.on].length"), 1)
        for nonsense in ("7", "%5B%5D", "%22on%22", "%7B%22on%22%3A7%7D", "%7B%22pair%22%3A%5B%5D%7D"):
            self.open(f"#view=%7B%22whatIf%22%3A{nonsense}%7D")
            self.assertEqual(self.value("[...pcorReport.whatIf.on].length"), 0)


class TwoEffects(WhatIfTest):
    def test_each_and_both_equal_refit(self):
        self.diagnosed(BOTH, BOTH_TOO)
        found = [finding["effect"] for finding in self.diagnosis["findings"]]
        self.assertEqual(len(found), 2, found)
        for effect in found:
            self.switch(effect)
            self.assert_same(self.told(), self.as_copied(), {effect})
            self.switch(effect)
        for effect in found:
            self.switch(effect)
        self.assert_same(self.told(), self.as_copied(), set(found))


class Steps(WhatIfTest):
    def test_steps_in_the_browser_equal_those_of_improve(self):
        self.report = self.path / "report.html"
        steps = self.json_of("improve", FIRST, "-m", self.model(), "-o", self.path / "best.toml", "--holdout", SECOND,
                             "--report", self.report)["steps"]
        self.open()
        told = self.told()
        self.assertAlmostEqual(told["rms"], steps[0]["rms_train_hpa"], delta=0.01 * steps[0]["rms_train_hpa"])
        self.assertGreater(len(steps), 1)
        for step in steps[1:]:
            self.switch(step["added"])
            told = self.told()
            self.assertAlmostEqual(told["rms"], step["rms_train_hpa"], delta=0.01 * step["rms_train_hpa"])
            self.assertAlmostEqual(told["heldOut"], step["rms_holdout_hpa"], delta=0.01 * step["rms_holdout_hpa"])
        self.assert_same(self.told(), self.as_copied(), {step["added"] for step in steps[1:]})


if __name__ == "__main__":
    if CHROMIUM is None:
        print("chromium is not installed; the what-if was not tried", file=sys.stderr)
        sys.exit(1 if os.environ.get("PCOR_REQUIRE_CHROMIUM") else 77)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
