#!/usr/bin/env python3
"""The report of every command in Chromium.

    every_report_test.py TOOL SOURCE_DIRECTORY FOLDER BUILD_DIRECTORY      FOLDER: where reports.py made them

Each picture has a text alternative and numbers. The pages of check, wide and light, and of improve, narrow and dark, or all
pages in all of these ways where PCOR_EVERY_CASE is set, pass self_test.js, and axe-core, which is fetched from npm into the
build directory, finds no violation in them. Without Chromium the test is skipped (status 77), or
fails if PCOR_REQUIRE_CHROMIUM is set; without axe-core its part of it is.
"""

import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
from browser import CHROMIUM, Browser, PageTest, skip_without  # noqa: E402
from reports import COMMANDS, SOURCE, looked_at, page  # noqa: E402

BUILD = Path(sys.argv[4]).resolve()
AXE_VERSION = "4.14.1"


def axe_core():
    """The text of axe-core; empty if it is not available."""
    folder = BUILD / "axe"
    script = folder / "node_modules/axe-core/axe.min.js"
    if not script.exists() and shutil.which("npm"):
        folder.mkdir(parents=True, exist_ok=True)
        subprocess.run(["npm", "install", "--no-audit", "--no-fund", "--silent", "--no-save", f"axe-core@{AXE_VERSION}"],
                       cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=120)
    return script.read_text() if script.exists() else ""


class EveryReport(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.start(Browser, CHROMIUM, cls.make_folder(), 1400)

    def test_every_panel_has_data_wide_and_narrow(self):
        for command, width in looked_at((1400, 420)):
            with self.subTest(command=command, width=width):
                self.browser.resize(width)
                result = self.browser.self_test(page(command))
                self.assertEqual(result["wrong"], [])
                self.assertGreater(result["panels"], 1)
                self.assertEqual(self.browser.errors, [])

    def test_every_report_has_readable_text_and_complete_pictures(self):
        """No text is clipped or overlaps, each picture has its numbers, and the first screen is useful."""
        faults_of = (SOURCE / "tests/report/text_boxes.js").read_text()
        for command, width in dict.fromkeys([*((command, 1400) for command in COMMANDS), *looked_at((1400, 420))]):
            with self.subTest(command=command, width=width):
                self.browser.resize(width, 1000)
                self.browser.open(page(command))
                self.check_first_screen(width)
                if width == 1400:
                    self.check_numbers()
                self.assertEqual(self.browser.value(f"({faults_of})({str(width < 600).lower()})"), [])

    def check_first_screen(self, width):
        """A picture and the next command are at the top; switches of effects begin at most 100 pixels below the first screen, in a
        narrow window lower."""
        places = self.browser.value("""['.item canvas', '.next', '.what-if'].map((name) => {
          const box = document.querySelector(name)?.getBoundingClientRect();
          return name === '.next' ? box.bottom : box?.top ?? 0;
        })""")
        for place, limit in zip(places, (660, 400, 1100) if width == 1400 else (1200, 800, 1300)):
            self.assertLess(place, limit)

    def check_numbers(self):
        """Each picture has a text alternative, and its numbers as a table."""
        pictures = self.browser.value(
            "pcorReport.panels.map(({canvas, numbers}) => [canvas.getAttribute('aria-label'), numbers.tBodies[0].rows.length])")
        for label, rows in pictures:
            self.assertRegex(label, r"\w+.*\. .*\w+.*\. [\d\u202f]+ points?\.$")
            self.assertGreater(rows, 0, label)
            self.assertNotIn("NaN", label)
            self.assertNotIn("undefined", label)

    def test_the_text_test_finds_clipped_and_overlapping_text(self):
        faults_of = (SOURCE / "tests/report/text_boxes.js").read_text()
        self.browser.resize(1400)
        self.browser.open(page("compare"))
        self.browser.value("""document.querySelector('.subtitle').style.marginTop = '-2rem';
          document.querySelector('.next code').style.cssText = 'display: block; width: 3rem; overflow: hidden; white-space: nowrap';
          heights.track = () => 30;
          pcorReport.panels[0].item.axis = 'long '.repeat(99);
          const {track} = pictures;
          pictures.track = (pen, ...more) => {
            const drawn = track(pen, ...more), {x, y} = drawn.place(100);
            pen.text(x, y, 'here', {});
            return drawn;
          }; 1""")
        faults = "\n".join(self.browser.value(f"({faults_of})(false)"))
        for fault in ("page: .* overlap", "page: .* is clipped", "picture 'Residual on the map': .* is clipped",
                      "picture 'Residual in time': .* is shortened", "picture 'Residual on the map': 'here' is on the track"):
            self.assertRegex(faults, fault)

    def test_a_time_at_the_end_of_the_axis_is_not_clipped(self):
        """A label with seconds is wider than the margin at the right of the axis."""
        faults_of = (SOURCE / "tests/report/text_boxes.js").read_text()
        self.browser.resize(1400)
        self.browser.open(page("inspect"))
        self.browser.value("""const [{start, offset}] = pcorReport.samples.flights;
          pcorReport.choose([offset, offset + 60 * Math.ceil(start / 60 + 1) - start], new Set(), false); 1""")
        self.assertEqual(self.browser.value(f"({faults_of})(false)"), [])

    def test_uncertainty_is_drawn_as_a_band(self):
        self.browser.open(page("process"))
        self.assertIn('stroke-opacity="0.25"', self.browser.value("pcorReport.panels[0].svg()"))

    def test_a_row_far_from_the_others_does_not_set_the_axis(self):
        self.browser.open(page("check"))
        ends = "(values) => endsOfRows(values.map((value) => ({dots: [{value, error: 0.5}]})), [-1, 1])"
        self.assertEqual(self.browser.value(f"Math.min(...({ends})([1, 2, 0, -20]))"), -0.5)
        self.assertEqual(self.browser.value(f"Math.min(...({ends})([1, 2, 0, -5]))"), -5.5)

    def test_axe_finds_no_violation(self):
        axe = axe_core()
        if not axe:
            self.skipTest("axe-core cannot be had from npm")
        self.browser.resize(1400)
        for command, theme in looked_at(("light", "dark")):
            with self.subTest(command=command, theme=theme):
                self.browser.open(f"{page(command)}#{theme}")
                self.browser.value("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
                self.browser.value(f"{axe}; 1")
                found = self.browser.value("""axe.run(document, {resultTypes: ['violations']}).then(({violations}) =>
                  violations.map(({id, nodes}) => `${id}: ${nodes[0].html.slice(0, 200)}`))""")
                self.assertEqual(found, [])


if __name__ == "__main__":
    skip_without(CHROMIUM, "chromium")
    unittest.main(argv=sys.argv[:1])
