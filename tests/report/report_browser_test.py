#!/usr/bin/env python3
"""Reports in a browser, headless chromium: each page passes self_test.js, is looked at, printed and exported.

    report_browser_test.py SAMPLE_REPORT SOURCE_DIRECTORY

Without chromium it is skipped (status 77), or fails if PCOR_REQUIRE_CHROMIUM is set.
"""

import base64
import io
import json
import re
import subprocess
import sys
import tempfile
import unittest
import urllib.parse
from pathlib import Path

from browser import CHROMIUM, Browser, PageTest, skip_without

SAMPLE_REPORT = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()
PANELS = 13


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=120)


def pixels(path):
    """A picture as numbers: rows, columns, and red, green and blue."""
    import numpy
    from PIL import Image

    with Image.open(path) as picture:
        return numpy.asarray(picture.convert("RGB"), int)


def coloured(picture):
    """Number of clearly coloured pixels in every fourth row."""
    return (picture[::4].max(axis=2) - picture[::4].min(axis=2) > 40).sum()


def setUpModule():
    """One browser for all classes."""
    folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)  # a browser that ends still writes
    unittest.addModuleCleanup(folder.cleanup)
    PageTest.browser = Browser(CHROMIUM, folder.name, words=("--hide-scrollbars",))
    unittest.addModuleCleanup(PageTest.browser.close)


class ReportInBrowser(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.report = cls.make_folder() / "report.html"
        run(SAMPLE_REPORT, cls.report)

    def self_test(self, report, wish="light", width=1280):
        self.browser.resize(width)
        result = self.browser.self_test(f"{report.as_uri()}#{wish}")
        self.assertEqual(self.browser.errors, [])
        self.assertEqual(result["wrong"], [])
        self.assertEqual(result["panels"], PANELS)
        return result

    def test_self_test_of_the_page(self):
        result = self.self_test(self.report, "light")
        self.assertEqual(result["points"][1], 7080)
        self.assertFalse(result["dark"])

    def test_self_test_of_the_narrow_dark_page(self):
        self.assertTrue(self.self_test(self.report, "dark", width=600)["dark"])

    def test_a_short_axis_has_two_numbers(self):
        self.browser.open(self.report.as_uri())
        for start, end, length in ((-1.5, 1.5, 113), (-0.9, 0.9, 60), (0.11, 0.19, 52), (-19, 19, 52), (-0.04, 0.31, 70)):
            with self.subTest(start=start, end=end, length=length):
                labels = self.browser.value(f"numberTicks({start}, {end}, {length}, 52).map(({{label}}) => label)")
                self.assertGreater(len(labels), 1)
                self.assertEqual(len(set(labels)), len(labels))
        self.assertEqual(self.browser.value("numberTicks(0, 10, 520, 52).length"), 11)

    def test_rounding_errors_do_not_set_the_range_of_pressures(self):
        self.browser.open(self.report.as_uri())
        least = "leastRange([{unit: 'hPa'}])"
        self.assertEqual(self.browser.value("leastRange([{unit: 'hPa'}, {unit: 'K'}])"), 0)
        for values, always, expected in ("[-6e-5, 0]", "[]", 0.1), ("[]", "[-6e-5, 0]", 0.1), ("[0, 1]", "[]", 1.08):
            width = self.browser.value(
                f"(({{from, to}}) => to - from)(limits({values}, {always}, {least}))")
            self.assertAlmostEqual(width, expected)

    def test_long_flight(self):
        report = self.folder / "long.html"
        run(SAMPLE_REPORT, report, "18000")
        self.assertLess(report.stat().st_size, 1_500_000)
        self.browser.errors.clear()
        self.browser.open(report.as_uri())
        self.assertTrue(self.browser.value("pcorReport.points.every((count) => count > 0)"))
        self.assertEqual(self.browser.errors, [])
        self.assertLess(self.browser.value("(() => { const begin = performance.now(); pcorReport.draw(); return performance.now() - begin; })()"), 2000)

    def test_several_flights(self):
        report = self.folder / "flights.html"
        run(SAMPLE_REPORT, report, "3000", "4")
        self.self_test(report)

    def test_screenshots(self):
        for wish, bright, width in (("light", True, 700), ("dark", False, 1600)):
            with self.subTest(wish=wish, width=width):
                self.browser.resize(width, 2400)
                self.browser.open(f"{self.report.as_uri()}#{wish}")
                self.browser.settle()
                picture = pixels(io.BytesIO(self.browser.screenshot()))
                self.assertEqual(len(picture), 2400)
                self.assertEqual(picture[0, 0].mean() > 128, bright)
                self.assertGreater(coloured(picture), 3000)

    def test_print(self):
        self.browser.open(f"{self.report.as_uri()}#dark")
        pages = base64.b64decode(self.browser.ask("Page.printToPDF", printBackground=True)["data"])
        self.assertTrue(pages.startswith(b"%PDF"))
        self.assertGreater(len(pages), 50_000)


class ReportUnderTheHand(PageTest):
    """Actions of a reader with mouse and keyboard, and the response of the page, compared with its data."""

    @classmethod
    def setUpClass(cls):
        cls.report = cls.make_folder() / "report.html"
        run(SAMPLE_REPORT, cls.report, "2000", "2")
        cls.browser.resize(1280)

    def setUp(self):
        self.browser.errors.clear()
        self.browser.open(self.report.as_uri())
        self.count = self.selection["count"]

    def tearDown(self):
        self.assertEqual(self.browser.errors, [])

    def value(self, expression):
        return self.browser.value(expression)

    @property
    def selection(self):
        return self.value("pcorReport.selection")

    def panels(self, *kinds):
        return [i for i, kind in enumerate(self.value("pcorReport.panels.map((panel) => panel.item.kind)")) if kind in kinds]

    def corner(self, element):
        """The left and the top of an element of the page, in view."""
        self.value(f"{element}.scrollIntoView({{block: 'center'}})")
        self.browser.settle()
        return self.value(f"(({{left, top}}) => [left, top])({element}.getBoundingClientRect())")

    def middle(self, element):
        left, top = self.corner(element)
        width, height = self.value(f"(({{width, height}}) => [width, height])({element}.getBoundingClientRect())")
        return left + width / 2, top + height / 2

    def place(self, panel, across, up=0.5):
        """Where a part of the plot of a panel is in the window, with the panel in view."""
        left, top = self.corner(f"pcorReport.panels[{panel}].canvas")
        plot = self.value(f"pcorReport.panels[{panel}].drawn.plot")
        return left + plot["x"] + across * plot["width"], top + plot["y"] + up * plot["height"]

    def readouts(self):
        return self.value("pcorReport.panels.map((panel) => panel.readout.textContent)")

    def button(self, words):
        return self.middle(f"[...document.querySelectorAll('button')].find((each) => each.textContent.trim() === {json.dumps(words)})")

    def test_pointing_shows_the_sample_in_every_picture(self):
        time, other = self.panels("time"), self.panels("binned", "plane", "pair")
        self.browser.point(*self.place(time[0], 0.3))
        sample = self.value("pcorReport.cursor")
        # Three tenths along the axis; a pixel is about a thousandth of the axis.
        self.assertAlmostEqual(self.value(f"pcorReport.samples.position[{sample}] / pcorReport.samples.length"), 0.3, delta=0.005)
        told = self.readouts()
        for panel in time + other:
            for name in self.value(f"pcorReport.panels[{panel}].told"):
                title, number = self.value(f"""(() => {{
                  const {{title, values}} = pcorReport.samples.columns.get({json.dumps(name)});
                  return [title, Number.isNaN(values[{sample}]) ? null : values[{sample}]];
                }})()""")
                found = re.search(re.escape(title) + r" ([−\d.]+|–)", told[panel])
                self.assertIsNotNone(found, f"{title} in '{told[panel]}'")
                if number is None:
                    self.assertEqual(found.group(1), "–")
                else:  # three digits are shown
                    self.assertAlmostEqual(float(found.group(1).replace("−", "-")), number, delta=max(0.006 * abs(number), 1e-4))
        self.browser.point(1, 1)
        self.assertEqual(set(self.readouts()), {""})

    def test_pointing_at_a_dot_shows_it_in_time(self):
        plane = f"pcorReport.panels[{self.panels('plane')[0]}]"
        left, top = self.corner(f"{plane}.canvas")
        dot = self.value(f"{plane}.drawn.place(pcorReport.samples.indices(columnsOf(pcorReport.samples, {plane}.told))[1000])")
        self.browser.point(left + dot["x"], top + dot["y"])
        found = self.value(f"{plane}.drawn.place(pcorReport.cursor)")
        self.assertLess(max(abs(found[axis] - dot[axis]) for axis in "xy"), 2)  # pixels; others may lie on it
        self.assertFalse(self.value(f"pcorReport.panels[{self.panels('time')[0]}].cross.hidden"))

    def test_drag_selects_and_keys_move_and_undo(self):
        panel = self.panels("time")[0]
        lasts = "(pcorReport.samples.view[1] - pcorReport.samples.view[0]) / pcorReport.samples.length"
        self.browser.drag(*self.place(panel, 0.25), *self.place(panel, 0.75))
        self.assertAlmostEqual(self.value(lasts), 0.5, delta=0.01)
        self.browser.click(*self.place(panel, 0.5))
        self.browser.key("+")
        self.assertAlmostEqual(self.value(lasts), 0.25, delta=0.01)
        before = self.value("pcorReport.samples.view[0]")
        self.browser.key("ArrowRight")
        self.assertGreater(self.value("pcorReport.samples.view[0]"), before)
        self.browser.key("ArrowLeft", shift=True)
        first = self.value("pcorReport.cursor")
        self.browser.key("ArrowRight", shift=True)
        self.assertEqual(self.value("pcorReport.cursor"), first + 1)
        for expected in (0.25, 0.5):
            self.browser.click(*self.button("Undo"))
            self.browser.wait(f"Math.abs({lasts} - {expected}) < 0.01 && {before} - pcorReport.samples.view[0] > -1e-3")
        self.browser.click(*self.place(panel, 0.5))
        self.browser.key("Escape")
        self.assertEqual(self.selection["count"], self.count)

    def test_a_drag_upwards_enlarges_one_picture_only(self):
        panel, other = self.panels("time")
        axis = "pcorReport.panels[{}].drawn.up(pcorReport.panels[{}].drawn.plot.y)"
        rest = self.value(axis.format(other, other))
        middle = self.value(f"(({{drawn}}) => [drawn.up(drawn.plot.y + 0.25 * drawn.plot.height), drawn.up(drawn.plot.y + 0.75 * drawn.plot.height)])(pcorReport.panels[{panel}])")
        self.browser.drag(*self.place(panel, 0.5, 0.25), *self.place(panel, 0.5, 0.75))
        shown = self.value(f"pcorReport.panels[{panel}].item.vertical")
        for found, wanted in zip((shown["to"], shown["from"]), middle):
            self.assertAlmostEqual(found, wanted, delta=0.02 * abs(middle[0] - middle[1]))  # a pixel
        self.assertEqual(self.selection["count"], self.count)
        self.assertEqual(self.value(axis.format(other, other)), rest)
        vertical = f"pcorReport.panels[{panel}].item.vertical ?? null"
        self.browser.click(*self.button("Undo"))
        self.browser.wait(f"({vertical}) === null")
        self.assertTrue(self.value("pcorReport.bar.undo.hidden"))
        self.value("history.forward()")
        self.browser.wait(f"({vertical}) !== null")
        self.assertFalse(self.value("pcorReport.bar.undo.hidden"))
        self.browser.click(*self.button("Show all"))
        self.assertIsNone(self.value(vertical))
        height = f"(({{drawn: {{up, plot}}}}) => up(plot.y) - up(plot.y + plot.height))(pcorReport.panels[{panel}])"
        whole = self.value(height)
        self.browser.click(*self.place(panel, 0.5))
        self.browser.key("ArrowUp", shift=True)
        self.assertAlmostEqual(self.value(height), whole / 2)
        self.browser.key("ArrowDown", shift=True)
        self.assertAlmostEqual(self.value(height), whole)

    def test_the_wheel_scrolls_and_with_control_zooms_at_the_pointer(self):
        panel = self.panels("time")[0]
        x, y = self.place(panel, 0.3)
        at = "pcorReport.samples.view[0] + 0.3 * (pcorReport.samples.view[1] - pcorReport.samples.view[0])"
        under = self.value(at)
        self.browser.wheel(x, y, -120, control=True)
        self.browser.wait("pcorReport.samples.range !== null")
        self.assertAlmostEqual(self.value(at), under, delta=0.005 * self.value("pcorReport.samples.length"))
        before = self.value("scrollY")
        self.browser.wheel(x, y, 120)
        self.browser.wait(f"scrollY !== {before}")
        self.assertAlmostEqual(self.value("(pcorReport.samples.view[1] - pcorReport.samples.view[0]) / pcorReport.samples.length"), 0.8, delta=0.01)

    def test_last_curve_cannot_be_switched_off(self):
        panel = self.panels("time")[0]
        names = self.value(f"pcorReport.panels[{panel}].item.columns")
        points = self.value("pcorReport.points")[panel]
        switches = [f"pcorReport.panels[{panel}].switches[{i}]" for i in range(len(names))]

        def press(switch):
            self.browser.click(*self.middle(switch))

        press(switches[0])
        self.assertLess(self.value("pcorReport.points")[panel], points)
        self.assertEqual(self.value(f"{switches[0]}.getAttribute('aria-pressed')"), "false")
        for switch in switches[1:]:
            press(switch)
        self.assertGreater(self.value("pcorReport.points")[panel], 0)
        press(switches[0])
        self.assertEqual(self.value(f"{switches[0]}.getAttribute('aria-pressed')"), "true")

    def test_an_empty_selection_is_reported_and_scales_are_kept(self):
        panel, plane = self.panels("time")[0], self.panels("plane")[0]
        regime, begin, end = self.value("""(() => {
          const {samples} = pcorReport;
          for (const [name, inside] of samples.regimes) {
            const first = inside.indexOf(1);
            if (first > 0.1 * samples.count) return [name, 0, samples.position[first - 50] / samples.length];
          }
        })()""")
        top = f"pcorReport.panels[{panel}].drawn.up(pcorReport.panels[{panel}].drawn.plot.y)"
        before, corner = self.value(top), self.value(f"pcorReport.panels[{plane}].drawn.place(0)")
        self.browser.drag(*self.place(panel, begin + 0.002), *self.place(panel, end))
        self.browser.click(*self.button(regime))
        self.assertEqual(self.selection["count"], 0)
        self.assertIn(f"{regime} has no samples in this time range", self.value("document.querySelector('.selected').textContent"))
        self.assertEqual(self.value(f"pcorReport.panels[{panel}].empty.textContent"), "No sample is selected")
        self.assertFalse(self.value(f"pcorReport.panels[{panel}].empty.hidden"))
        self.assertEqual(self.value(top), before)
        self.assertEqual(self.value(f"pcorReport.panels[{plane}].drawn.place(0)"), corner)
        self.browser.click(*self.button(regime))
        self.assertNotIn("has no samples in this time range", self.value("document.querySelector('.selected').textContent"))
        self.browser.click(*self.button("Show all"))
        self.assertEqual(self.selection["count"], self.count)

    def test_pictures_without_any_value_state_so(self):
        self.value("""pcorReport.samples.columns.forEach(({values}) => values.fill(NaN));
          for (const {item} of pcorReport.panels) {
            item.places = undefined;
            for (const {dots} of item.rows ?? []) dots.forEach((dot) => { dot.value = null; });
            for (const bar of item.bars ?? []) bar.value = null;
            for (const {y} of item.curves ?? []) y.fill(null);
          }
          pcorReport.draw()""")
        stated = self.value("pcorReport.panels.map(({empty}) => empty.hidden ? '' : empty.textContent)")
        self.assertEqual(stated, ["No selected sample has a value here"] * PANELS)

    def test_address_restores_the_view(self):
        panel = self.panels("time")[0]
        self.browser.drag(*self.place(panel, 0.2), *self.place(panel, 0.6))
        self.browser.click(*self.button(self.value("[...pcorReport.samples.regimes.keys()][0]")))
        seen, address = self.selection, self.value("location.href")
        self.browser.open(address)
        for bound in ("from", "to"):  # in milliseconds, in the address
            self.assertAlmostEqual(self.selection.pop(bound), seen.pop(bound), delta=1e-3)
        self.assertEqual({**self.selection, "from": 0, "to": 0}, {**seen, "from": 0, "to": 0})
        between_numbers = "view=" + urllib.parse.quote('{"panels":{"%d":{"vertical":[700,700.0000000000001]}}}' % panel)
        for nonsense in (between_numbers, "view=" + urllib.parse.quote('{"range":[9e9,9.1e9]}'), "view=%7B", "view=%E0%A4%A", "view=7", "view=null", "view=%7B%22range%22%3A%5B9%2C1%5D%2C%22panels%22%3A4%7D"):
            self.browser.open(f"{self.report.as_uri()}#{nonsense}")
            self.assertEqual(self.selection["count"], self.count, nonsense)

    def test_few_samples_of_a_regime_are_counted_and_do_not_set_the_axis(self):
        panel = self.panels("byregime")[0]
        texts = f"[...new DOMParser().parseFromString(pcorReport.panels[{panel}].svg(), 'image/svg+xml')" \
            ".querySelectorAll('text')].map(({textContent}) => textContent)"
        before = self.value(texts)
        counts = self.value(f"""(() => {{
          const {{samples, panels}} = pcorReport, columns = columnsOf(samples, panels[{panel}].item.columns);
          return [...samples.regimes, ['All', samples.every]].map(([name, inside]) => [name, inside.filter((one, i) =>
            one && columns.every(({{values}}) => Number.isFinite(values[i]))).length]);
        }})()""")
        for name, count in counts:
            self.assertIn(f"{name} ({count})", before)
        self.value(f"""(() => {{
          const {{samples, panels}} = pcorReport, short = new Uint8Array(samples.count).fill(1, 0, 5);
          for (const {{values}} of columnsOf(samples, panels[{panel}].item.columns)) values.fill(1000, 0, 5);
          samples.regimes.forEach((inside) => inside.fill(0, 0, 5));
          samples.every.fill(0, 0, 5);
          samples.regimes.set('short', short);
          pcorReport.draw();
        }})()""")
        after = self.value(texts)
        self.assertIn("short (5)", after)
        ends = [max(float(text.replace("−", "-")) for text in each if re.fullmatch(r"[−-]?[\d.]+", text)) for each in (before, after)]
        self.assertLess(ends[1], 2.0 * ends[0])

    def test_each_regime_has_its_own_mark(self):
        marks = self.value("""['climb', 'descent', 'level', 'turn', 'take-off', 'ground', 'circle', 'cloud',
          'pitch manoeuvre', 'yaw manoeuvre', 'speed run', 'reverse heading', 'one more', 'another'].map((name, i, all) =>
            JSON.stringify([regimeMark(name, all, palettes.light), regimeMark(name, ['one more', 'another', name], palettes.light)]))""")
        self.assertEqual(len(set(marks)), len(marks))
        for mark in marks:
            alone, among_others = json.loads(mark)
            self.assertEqual(alone, among_others)


if __name__ == "__main__":
    skip_without(CHROMIUM, "chromium")
    unittest.main(argv=sys.argv[:1])
