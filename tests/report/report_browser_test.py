#!/usr/bin/env python3
"""Reports in a browser, headless chromium: each page tests itself, is looked at, printed and exported.

    report_browser_test.py SAMPLE_REPORT SOURCE_DIRECTORY

Without chromium it is skipped (status 77), or fails if PCOR_REQUIRE_CHROMIUM is set.
"""

import html
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree
import zlib
from pathlib import Path

SAMPLE_REPORT = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
PANELS = 7


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=120)


def chromium(profile, *words):
    return run(CHROMIUM, "--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--enable-logging=stderr",
               f"--user-data-dir={profile}", *words)


def decode_png(path):
    """Width, height and the rows of an 8-bit RGB or RGBA picture, each row as bytes of RGB."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", path
    width, height, depth, kind = struct.unpack(">IIBB", data[16:26])
    assert depth == 8 and kind in (2, 6), (depth, kind)
    channels = 3 if kind == 2 else 4
    packed, at = b"", 8
    while at < len(data):
        length, name = struct.unpack(">I4s", data[at:at + 8])
        if name == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    raw, stride = zlib.decompress(packed), width * channels
    rows, above = [], bytes(stride)
    for y in range(height):
        begin = y * (stride + 1)
        method, line = raw[begin], bytearray(raw[begin + 1:begin + 1 + stride])
        unfilter(method, line, above, channels)
        above = bytes(line)
        rows.append(above if channels == 3 else bytes(byte for i, byte in enumerate(above) if i % 4 != 3))
    return width, height, rows


def unfilter(method, line, above, channels):
    if method == 2:
        line[:] = bytes((a + b) & 255 for a, b in zip(line, above))
    elif method:
        for i, byte in enumerate(line):
            left = line[i - channels] if i >= channels else 0
            corner = above[i - channels] if i >= channels else 0
            up = above[i]
            if method == 1:
                line[i] = (byte + left) & 255
            elif method == 3:
                line[i] = (byte + (left + up) // 2) & 255
            else:
                nearest = min((abs(up - corner), 0, left), (abs(left - corner), 1, up),
                              (abs(left + up - 2 * corner), 2, corner))
                line[i] = (byte + nearest[2]) & 255


def coloured(rows):
    """How many pixels are clearly not grey, in every fourth row."""
    return sum(max(row[i:i + 3]) - min(row[i:i + 3]) > 40 for row in rows[::4] for i in range(0, len(row), 3))


class ReportInBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.directory.name)
        cls.report = cls.folder / "report.html"
        run(SAMPLE_REPORT, cls.report)

    @classmethod
    def tearDownClass(cls):
        cls.directory.cleanup()

    def browse(self, report, wish, *words):
        return chromium(self.folder / "profile", *words, f"{report.as_uri()}#{wish}")

    def self_test(self, report, *wishes, width=1280):
        shown = self.browse(report, "+".join(("selftest", *wishes)), f"--window-size={width},900", "--dump-dom")
        self.assertEqual([line for line in shown.stderr.splitlines() if "CONSOLE" in line], [])
        found = re.search(r'<pre id="selftest">(.*?)</pre>', shown.stdout, re.DOTALL)
        self.assertIsNotNone(found, "the page did not test itself")
        result = json.loads(html.unescape(found.group(1)))
        self.assertEqual(result["wrong"], [])
        self.assertEqual(result["panels"], PANELS)
        return result

    def screenshot(self, wish, width):
        picture = self.folder / f"{wish}-{width}.png"
        self.browse(self.report, wish, f"--window-size={width},2400", f"--screenshot={picture}")
        return decode_png(picture)

    def test_page_tests_itself(self):
        result = self.self_test(self.report, "light")
        self.assertEqual(result["points"][1], 7080)
        self.assertFalse(result["dark"])

    def test_dark_page_tests_itself(self):
        self.assertTrue(self.self_test(self.report, "dark")["dark"])

    def test_narrow_page_tests_itself(self):
        self.self_test(self.report, width=600)

    def test_long_flight(self):
        report = self.folder / "long.html"
        run(SAMPLE_REPORT, report, "18000")
        self.assertLess(report.stat().st_size, 1_500_000)
        result = self.self_test(report)
        self.assertLess(result["redraw"], 2000)

    def test_several_flights(self):
        report = self.folder / "flights.html"
        run(SAMPLE_REPORT, report, "9000", "4")
        self.self_test(report)

    def test_screenshots(self):
        for wish, bright in (("light", True), ("dark", False)):
            for width in (700, 1600):
                with self.subTest(wish=wish, width=width):
                    _, height, rows = self.screenshot(wish, width)
                    self.assertEqual(height, 2400)
                    corner = sum(rows[0][:3]) / 3
                    self.assertEqual(corner > 128, bright)
                    self.assertGreater(coloured(rows), 3000)

    def test_print(self):
        pages = self.folder / "report.pdf"
        self.browse(self.report, "dark", f"--print-to-pdf={pages}")
        self.assertGreater(pages.stat().st_size, 50_000)

    def test_pictures_for_a_paper(self):
        folder = self.folder / "pictures"
        run(SOURCE / "tools/report_pictures", self.report, folder)
        vectors, rasters = sorted(folder.glob("*.svg")), sorted(folder.glob("*.png"))
        self.assertEqual((len(vectors), len(rasters)), (PANELS, PANELS))
        self.assertEqual(vectors[0].name, "01-residual-over-the-flight.svg")
        for vector in vectors:
            svg = xml.etree.ElementTree.parse(vector).getroot()
            self.assertEqual(svg.tag, "{http://www.w3.org/2000/svg}svg")
            self.assertGreater(sum(1 for _ in svg.iter("{http://www.w3.org/2000/svg}text")), 3)
        for raster in rasters:
            width, _, rows = decode_png(raster)
            self.assertGreaterEqual(width, 1600)
            self.assertGreater(coloured(rows), 200, raster.name)


if __name__ == "__main__":
    if CHROMIUM is None:
        print("chromium is not installed; reports were not looked at", file=sys.stderr)
        sys.exit(1 if os.environ.get("PCOR_REQUIRE_CHROMIUM") else 77)
    unittest.main(argv=sys.argv[:1])
