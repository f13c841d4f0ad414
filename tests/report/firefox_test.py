#!/usr/bin/env python3
"""Reports in Firefox.

    firefox_test.py TOOL SOURCE_DIRECTORY FOLDER      FOLDER: where reports.py made them

Without Firefox the test is skipped (status 77), or fails if PCOR_REQUIRE_FIREFOX is set.
"""

import shutil
import sys
import unittest

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
from browser import SELF_TEST, PageTest, skip_without  # noqa: E402
from firefox import Firefox  # noqa: E402
from reports import looked_at, page  # noqa: E402

FIREFOX = shutil.which("firefox-esr") or shutil.which("firefox")


class InFirefox(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.start(Firefox, FIREFOX, cls.make_folder(), 1400)

    def test_every_panel_has_data(self):
        for command, _ in looked_at([None]):
            with self.subTest(command=command):
                self.browser.open(page(command))
                self.assertEqual(self.browser.value(SELF_TEST)["wrong"], [])

    def test_drag_selects_a_range(self):
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


if __name__ == "__main__":
    skip_without(FIREFOX, "firefox")
    unittest.main(argv=sys.argv[:1])
