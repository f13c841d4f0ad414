#!/usr/bin/env python3
"""The report of every command in browsers: Chromium and, where it is installed, Firefox.

    every_report_test.py TOOL SOURCE_DIRECTORY BUILD_DIRECTORY

Each picture has a text alternative and numbers. The pages of improve and check, or of all commands where
PCOR_EVERY_REPORT is set, test themselves, wide and narrow, and axe-core, which is fetched from npm into the build
directory, finds no violation in them. Without Chromium the test is skipped (status 77), or
fails if PCOR_REQUIRE_CHROMIUM is set; without axe-core or Firefox its part of it is.
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from browser import Browser
from firefox import Firefox

TOOL, SOURCE, BUILD = (Path(word).resolve() for word in sys.argv[1:4])
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FIREFOX = shutil.which("firefox-esr") or shutil.which("firefox")
# Slow checks run on the reports with most kinds of pictures, and on all of them in the long tests.
EVERY_REPORT = os.environ.get("PCOR_EVERY_REPORT")
AXE_VERSION = "4.14.1"
MADE = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)  # a browser that ends still writes
FOLDER = Path(MADE.name)
FITTED = ("one.nc", "two.nc")
COMMANDS = {
    "inspect": ("one.nc",),
    "compare": (*FITTED, "-m", "model.toml"),
    "refit": (*FITTED, "-m", "model.toml", "-o", "fitted.toml"),
    "diagnose": (*FITTED, "-m", "fitted.toml"),
    "improve": (*FITTED, "-m", "model.toml", "--holdout", "three.nc", "--trace-variables", "-o", "best.toml"),
    "check": (*FITTED, "three.nc", "-m", "fitted.toml"),
    "process": ("three.nc", "-m", "fitted.toml", "-o", "corrected.nc"),
    "temperature": ("climbs.nc", "-m", "model.toml", "-o", "calibrated.toml", "--force"),
}
LOOKED_AT = COMMANDS if EVERY_REPORT else ("improve", "check")


def run(*words, **more):
    return subprocess.run([str(word) for word in words], cwd=FOLDER, check=True, capture_output=True, text=True, timeout=280, **more)


def page(command):
    return (FOLDER / f"{command}.html").as_uri()


def setUpModule():
    hidden = SOURCE / "data/scenarios/c130-hidden.toml"
    for name, scenario, seed in (("one", hidden, 101), ("two", hidden, 102), ("three", hidden, 103),
                                 ("climbs", SOURCE / "data/scenarios/c130-climbs.toml", 1)):
        run(TOOL, "simulate", scenario, "--seed", seed, "-o", f"{name}.nc", "--quiet")
    shutil.copy(SOURCE / "data/scenarios/models/c130-psfd-eq18.toml", FOLDER / "model.toml")
    for command, words in COMMANDS.items():
        run(TOOL, command, *words, "--report", f"{command}.html", "--quiet")


def tearDownModule():
    MADE.cleanup()


def axe_core():
    """The text of axe-core; empty if it is not available."""
    folder = BUILD / "axe"
    script = folder / "node_modules/axe-core/axe.min.js"
    if not script.exists() and shutil.which("npm"):
        folder.mkdir(parents=True, exist_ok=True)
        subprocess.run(["npm", "install", "--no-audit", "--no-fund", "--silent", "--no-save", f"axe-core@{AXE_VERSION}"],
                       cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=120)
    return script.read_text() if script.exists() else ""


class EveryReport(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = Browser(CHROMIUM, FOLDER / "profile", 1400)

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def test_every_panel_has_data_wide_and_narrow(self):
        for command in LOOKED_AT:
            for width in (1400, 420):
                with self.subTest(command=command, width=width):
                    self.browser.resize(width)
                    result = self.browser.self_test(page(command))
                    self.assertEqual(result["wrong"], [])
                    self.assertGreater(result["panels"], 1)
                    self.assertEqual(self.browser.errors, [])

    def test_no_text_is_clipped_or_overlaps_wide_and_narrow(self):
        faults_of = (SOURCE / "tests/report/text_boxes.js").read_text()
        for command in COMMANDS:
            for width in (1400, 420):
                with self.subTest(command=command, width=width):
                    self.browser.resize(width)
                    self.browser.open(page(command))
                    self.assertEqual(self.browser.value(f"({faults_of})({str(width < 600).lower()})"), [])

    def test_the_text_test_finds_clipped_and_overlapping_text(self):
        faults_of = (SOURCE / "tests/report/text_boxes.js").read_text()
        self.browser.resize(1400)
        self.browser.open(page("compare"))
        self.browser.value("""document.querySelector('.subtitle').style.marginTop = '-2rem';
          document.querySelector('.next code').style.cssText = 'display: block; width: 3rem; overflow: hidden; white-space: nowrap';
          heights.track = () => 30; 1""")
        faults = "\n".join(self.browser.value(f"({faults_of})(false)"))
        for fault in ("page: .* overlap", "page: .* is clipped", "picture 'Residual on the map': .* is clipped"):
            self.assertRegex(faults, fault)

    def test_an_uncertainty_is_a_band(self):
        self.browser.open(page("process"))
        self.assertIn('stroke-opacity="0.25"', self.browser.value("pcorReport.svg(0)"))

    def test_a_row_far_from_the_others_does_not_set_the_axis(self):
        self.browser.open(page("check"))
        ends = "(values) => endsOfRows(values.map((value) => ({dots: [{value, error: 0.5}]})), [-1, 1])"
        self.assertEqual(self.browser.value(f"Math.min(...({ends})([1, 2, 0, -20]))"), -0.5)
        self.assertEqual(self.browser.value(f"Math.min(...({ends})([1, 2, 0, -5]))"), -5.5)

    def test_what_if_is_within_one_screen_of_the_top(self):
        self.browser.resize(1400, 1000)
        for command in ("diagnose", "improve"):
            with self.subTest(command=command):
                self.browser.open(page(command))
                self.assertLess(self.browser.value("document.querySelector('.what-if').getBoundingClientRect().top"), 1000)

    def test_the_first_screen_has_a_picture_and_the_next_command(self):
        self.browser.resize(1400, 1000)
        for command in COMMANDS:
            with self.subTest(command=command):
                self.browser.open(page(command))
                self.assertLess(self.browser.value("document.querySelector('.item canvas').getBoundingClientRect().top"), 600)
                self.assertLess(self.browser.value("document.querySelector('.next').getBoundingClientRect().bottom"), 400)

    def test_axe_finds_no_violation(self):
        axe = axe_core()
        if not axe:
            self.skipTest("axe-core cannot be had from npm")
        self.browser.resize(1400)
        for command in LOOKED_AT:
            for theme in ("light", "dark"):
                with self.subTest(command=command, theme=theme):
                    self.browser.open(f"{page(command)}#{theme}")
                    self.browser.value("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
                    self.browser.value(f"{axe}; 1")
                    found = self.browser.value("""axe.run(document, {resultTypes: ['violations']}).then(({violations}) =>
                      violations.map(({id, nodes}) => `${id}: ${nodes[0].html.slice(0, 200)}`))""")
                    self.assertEqual(found, [])

    def test_each_picture_tells_its_numbers(self):
        for command in COMMANDS:
            with self.subTest(command=command):
                self.browser.open(page(command))
                for label, rows in self.browser.value("pcorReport.panels.map(({canvas, numbers}) => [canvas.getAttribute('aria-label'), numbers.tBodies[0].rows.length])"):
                    self.assertRegex(label, r"\w+.*\. .*\w+.*\. [\d\u202f]+ points?\.$")
                    self.assertGreater(rows, 0, label)
                    self.assertNotIn("NaN", label)
                    self.assertNotIn("undefined", label)


@unittest.skipUnless(FIREFOX, "Firefox is not installed")
class InFirefox(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = Firefox(FIREFOX, FOLDER / "firefox", 1400)

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def test_every_panel_has_data(self):
        for command in LOOKED_AT:
            with self.subTest(command=command):
                self.browser.open(page(command) + "#selftest")
                result = json.loads(self.browser.value("document.getElementById('selftest').textContent"))
                self.assertEqual(result["wrong"], [])

    def test_a_drag_selects(self):
        self.browser.open(page("compare"))
        left, top, width, height = self.browser.value("""(() => {
          const {canvas, drawn: {plot}} = pcorReport.panels[0];
          canvas.scrollIntoView({block: 'center'});
          const box = canvas.getBoundingClientRect();
          return [box.left + plot.x, box.top + plot.y, plot.width, plot.height];
        })()""")
        before = self.browser.value("pcorReport.selection.count")
        self.browser.drag(left + 0.25 * width, top + 0.5 * height, left + 0.75 * width, top + 0.5 * height)
        view = self.browser.value("pcorReport.samples.view.map((position) => position / pcorReport.samples.length)")
        for found, wanted in zip(view, (0.25, 0.75)):
            self.assertAlmostEqual(found, wanted, delta=0.01)  # some pixels
        self.assertLess(self.browser.value("pcorReport.selection.count"), before)


class Figures(unittest.TestCase):
    def test_a_command_writes_them(self):
        result = run(TOOL, "compare", *COMMANDS["compare"], "--figures", "figures", "--figures-for", "column")
        self.assertIn("wrote figures\n", result.stdout)
        names = sorted(each.name for each in (FOLDER / "figures").iterdir())
        self.assertIn("captions.txt", names)
        self.assertEqual(len([name for name in names if name.endswith(".svg")]), len([name for name in names if name.endswith(".png")]))
        text = (FOLDER / "figures" / "captions.txt").read_text()
        self.assertIn("Command: pcor compare one.nc two.nc -m model.toml", text)

    def test_what_cannot_be_drawn_is_said_before_the_work(self):
        words = [str(TOOL), "refit", *FITTED, "-m", "model.toml", "-o", "none.toml", "--figures"]
        for folder, browser, said in (("figures2", "/nowhere", "CHROMIUM names"), ("model.toml", CHROMIUM, "model.toml is also an input"),
                                      ("one.nc/figures", CHROMIUM, "cannot be a folder")):
            found = subprocess.run([*words, folder], cwd=FOLDER, env={**os.environ, "CHROMIUM": browser}, capture_output=True, text=True)
            self.assertEqual((found.returncode, found.stdout), (1, ""))
            self.assertIn(said, found.stderr)
            self.assertEqual(found.stderr.count("\n"), 1)
            self.assertFalse((FOLDER / "none.toml").exists() or (FOLDER / "figures2").exists())

    def test_a_run_that_fails_later_leaves_what_was_there(self):
        run(TOOL, "inspect", "one.nc", "--figures", "kept")
        before = {each.name: each.read_bytes() for each in (FOLDER / "kept").iterdir()}
        # The folder of the table goes while figures are drawn, so that it cannot be written.
        gone = FOLDER / "gone"
        slow = FOLDER / "removes"
        slow.write_text(f"#!/bin/sh\nrm -rf '{gone}'\nexec '{CHROMIUM}' \"$@\"\n")
        slow.chmod(0o755)
        for folder in ("kept", "new/of/new"):
            gone.mkdir()
            words = [TOOL, "inspect", "one.nc", "--quiet", "--json", "gone/out.json", "--figures", folder]
            found = subprocess.run(words, cwd=FOLDER, env={**os.environ, "CHROMIUM": str(slow)}, capture_output=True, text=True)
            self.assertEqual(found.returncode, 1, found.stderr)
        self.assertEqual({each.name: each.read_bytes() for each in (FOLDER / "kept").iterdir()}, before)
        self.assertFalse((FOLDER / "new").exists())

    def test_the_folder_of_temporary_files_may_be_called_anything(self):
        temporary = FOLDER / "it's my $HOME"
        beside = FOLDER / "it's"
        temporary.mkdir()
        beside.mkdir()
        found = subprocess.run([TOOL, "inspect", "one.nc", "--figures", "quoted", "--quiet"], cwd=FOLDER,
                               env={**os.environ, "TMPDIR": str(temporary)}, capture_output=True, text=True)
        self.assertEqual(found.returncode, 0, found.stderr)
        self.assertEqual(list(temporary.iterdir()), [])
        self.assertTrue(beside.exists())

    def test_a_stopped_run_leaves_nothing(self):
        temporary = FOLDER / "temporary"
        temporary.mkdir()
        slow = FOLDER / "slow"
        slow.write_text("#!/bin/sh\nsleep 2\n")
        slow.chmod(0o755)
        child = subprocess.Popen([TOOL, "inspect", "one.nc", "--figures", "stopped", "--quiet"], cwd=FOLDER,
                                 env={**os.environ, "CHROMIUM": str(slow), "TMPDIR": str(temporary)})
        end = 120
        while not list(temporary.iterdir()) and end:
            end -= 1
            subprocess.run(["sleep", "0.1"], check=True)
        self.assertGreater(end, 0, "the browser was not started")
        child.terminate()
        self.assertEqual(child.wait(), -signal.SIGTERM)
        subprocess.run(["sleep", "3"], check=True)
        self.assertEqual(list(temporary.iterdir()), [])
        self.assertFalse((FOLDER / "stopped").exists())


if __name__ == "__main__":
    if CHROMIUM is None:
        print("chromium is not installed; reports were not looked at", file=sys.stderr)
        sys.exit(1 if os.environ.get("PCOR_REQUIRE_CHROMIUM") else 77)
    unittest.main(argv=sys.argv[:1])
