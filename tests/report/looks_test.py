#!/usr/bin/env python3
"""The looks of a report, wide and narrow, light and dark and in print, against those that were accepted.

    looks_test.py SAMPLE_REPORT SOURCE_DIRECTORY             compares
    looks_test.py SAMPLE_REPORT SOURCE_DIRECTORY --accept    accepts how it looks now: look at the pictures before

Fonts differ between machines, and with them where lines break: the page is drawn with DejaVu Sans alone, without
hinting. Where there is no Chromium or no such font the test is skipped (status 77), or fails if
PCOR_REQUIRE_CHROMIUM is set.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.argv, ACCEPT = [word for word in sys.argv if word != "--accept"], "--accept" in sys.argv
from browser import CHROMIUM, Browser, PageTest  # noqa: E402

SAMPLE_REPORT, SOURCE = (Path(word).resolve() for word in sys.argv[1:3])
ACCEPTED = SOURCE / "tests/report/accepted"
FONT = Path("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf")
# Name, width in pixels, fragment of the address after #, print mode, and scale of the stored picture.
LOOKS = (("wide", 1400, "light", False, 0.25), ("narrow", 420, "light", False, 0.35), ("dark", 1400, "dark", False, 0.25),
         ("print", 700, "light", True, 0.35))
BLOCK = 10  # pixels: what is compared are means of squares of such sides

FONTS = """<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "fonts.dtd">
<fontconfig>
  <dir>{folder}</dir>
  <cachedir>{cache}</cachedir>
  <match target="pattern"><edit name="family" mode="assign" binding="strong"><string>DejaVu Sans</string></edit></match>
  <match target="font"><edit name="hinting" mode="assign"><bool>false</bool></edit></match>
</fontconfig>
"""


def blocks(path):
    """The height of a picture, and the mean red, green and blue of each square of it."""
    import numpy
    from PIL import Image

    with Image.open(path) as picture:
        width, height = (side - side % BLOCK for side in picture.size)
        return picture.height, numpy.asarray(picture.convert("RGB").crop((0, 0, width, height)).reduce(BLOCK), int)


class Looks(PageTest):
    @classmethod
    def setUpClass(cls):
        folder = cls.make_folder()
        fonts = folder / "fonts"
        fonts.mkdir()
        shutil.copy(FONT, fonts)
        shutil.copy(FONT.with_name("DejaVuSans-Bold.ttf"), fonts)
        (folder / "fonts.conf").write_text(FONTS.format(folder=fonts, cache=folder / "cache"))
        cls.report = folder / "report.html"
        subprocess.run([SAMPLE_REPORT, cls.report], check=True)
        cls.start(Browser, CHROMIUM, folder / "profile", words=("--hide-scrollbars", "--font-render-hinting=none", "--disable-lcd-text", "--force-color-profile=srgb"),
                  environment={**os.environ, "FONTCONFIG_FILE": str(folder / "fonts.conf")})

    def picture(self, width, wish, is_print, part):
        self.browser.resize(width)
        self.browser.ask("Emulation.setEmulatedMedia", media="print" if is_print else "screen")
        self.browser.open(f"{self.report.as_uri()}#{wish}")
        if is_print:
            self.browser.value("dispatchEvent(new Event('beforeprint'))")
        else:  # when the page knows its width it draws once more
            self.browser.wait("pcorReport.panels.every(({picture, width}) => Math.round(picture.clientWidth) === width)")
        self.browser.settle()
        height = self.browser.value("document.documentElement.scrollHeight")
        clip = {"x": 0, "y": 0, "width": width, "height": height, "scale": part}
        return self.browser.screenshot(captureBeyondViewport=True, clip=clip)

    def test_pages_match_the_accepted_pictures(self):
        for name, width, wish, is_print, part in LOOKS:
            with self.subTest(look=name):
                found = self.folder / f"{name}.png"
                found.write_bytes(self.picture(width, wish, is_print, part))
                accepted = ACCEPTED / f"{name}.png"
                if ACCEPT:
                    ACCEPTED.mkdir(exist_ok=True)
                    shutil.copy(found, accepted)
                    continue
                (height, now), (height_before, before) = blocks(found), blocks(accepted)
                # A pixel or two, by how heights of lines are rounded.
                self.assertAlmostEqual(height, height_before, delta=2, msg="the page has another height")
                rows = min(len(now), len(before))
                differ = abs(now[:rows] - before[:rows]).max(axis=2)
                # Another version of the browser smooths edges in another way: that moves the mean of a square by a few of
                # 255, a curve that is gone or a word elsewhere by more than 12.
                beyond = int((differ > 12).sum())
                if beyond > 0.003 * differ.size:
                    kept = Path(tempfile.gettempdir()) / f"pcor-report-{name}.png"
                    shutil.copy(found, kept)
                    self.fail(f"{beyond} of {differ.size} squares differ; see {kept}, and accept it with --accept if it is right")


if __name__ == "__main__":
    if CHROMIUM is None or not FONT.exists():
        print("chromium or DejaVu Sans is not installed; reports were not looked at", file=sys.stderr)
        sys.exit(1 if os.environ.get("PCOR_REQUIRE_CHROMIUM") else 77)
    unittest.main(argv=sys.argv[:1])
