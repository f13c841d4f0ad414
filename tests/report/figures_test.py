#!/usr/bin/env python3
"""Pictures of a report as files, by tools/pcor-figures.

    figures_test.py SAMPLE_REPORT SOURCE_DIRECTORY

Without Chromium the test is skipped (status 77), or fails if PCOR_REQUIRE_CHROMIUM is set.
"""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree
from pathlib import Path

from browser import CHROMIUM, skip_without

SAMPLE_REPORT, SOURCE = (Path(word).resolve() for word in sys.argv[1:3])
PROGRAM = SOURCE / "tools/pcor-figures"
PANELS = 13
SVG = "{http://www.w3.org/2000/svg}"


def coloured(path):
    """Width of a picture, and the number of its clearly coloured pixels in every fourth row."""
    import numpy
    from PIL import Image

    with Image.open(path) as picture:
        pixels = numpy.asarray(picture.convert("RGB"), int)
    return pixels.shape[1], (pixels[::4].max(axis=2) - pixels[::4].min(axis=2) > 40).sum()


def make_folder(add_cleanup):
    made = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)  # a browser that ends still writes
    add_cleanup(made.cleanup)
    folder = Path(made.name)
    subprocess.run([SAMPLE_REPORT, folder / "report.html", "1500"], check=True)
    return folder


def program(path, text):
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return path


class Figures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        """Pictures of one run, and a program that repeats what the browser wrote there."""
        folder = make_folder(cls.addClassCleanup)
        cls.pictures = folder / "pictures"
        recorder = program(folder / "recorder", f"'{CHROMIUM}' \"$@\" | tee '{folder}/recorded'")
        subprocess.run([PROGRAM, folder / "report.html", cls.pictures], check=True, timeout=120,
                       env={**os.environ, "CHROMIUM": str(recorder)})
        cls.repeat = program(folder / "repeat", f"cat '{folder}/recorded'")

    def setUp(self):
        self.folder = make_folder(self.addCleanup)

    def command(self, folder, *size):
        return [PROGRAM, self.folder / "report.html", folder, *size]

    def figures(self, folder, *size, **environment):
        subprocess.run(self.command(folder, *size), check=True, env={**os.environ, **environment}, timeout=120)
        return sorted(folder.glob("*.svg")), sorted(folder.glob("*.png"))

    def test_pictures_for_a_paper(self):
        folder = self.pictures
        vectors, rasters = sorted(folder.glob("*.svg")), sorted(folder.glob("*.png"))
        self.assertEqual((len(vectors), len(rasters)), (PANELS, PANELS))
        self.assertEqual(len(list(folder.iterdir())), 2 * PANELS + 1)
        self.assertEqual(vectors[0].name, "01-residual-over-the-flight.svg")
        captions = [line.split(": ", 1)[1] for line in (folder / "captions.txt").read_text().splitlines() if line]
        self.assertEqual(len(captions), PANELS)
        for vector, caption in zip(vectors, captions):
            svg = xml.etree.ElementTree.parse(vector).getroot()
            self.assertEqual(svg.tag, SVG + "svg")
            self.assertTrue(caption.startswith(svg.find(SVG + "title").text))
            self.assertIn(svg.find(SVG + "desc").text, caption)
            self.assertNotRegex(caption, r"\bDrag\b|\bchoose\b")
            words = list(svg.iter(SVG + "text"))
            self.assertGreater(len(words), 4)
            # In print 8 points at least; the width is in the 96 dots of an inch.
            for each in words:
                points = float(each.get("font-size")) * float(svg.get("width")) / float(svg.get("viewBox").split()[2]) * 0.75
                self.assertGreaterEqual(points, 8, each.text)
        for raster in rasters:
            width, colour = coloured(raster)
            self.assertGreaterEqual(width, 1600)
            self.assertGreater(colour, 200, raster.name)

    def assert_width(self, vectors, width):
        self.assertEqual(len(vectors), PANELS)
        for vector in vectors:
            self.assertEqual(float(xml.etree.ElementTree.parse(vector).getroot().get("width")), width, vector.name)

    def test_pictures_for_a_slide(self):
        self.assert_width(self.figures(self.folder / "slide", "slide")[0], 1280)

    def test_old_pictures_are_removed_and_other_files_remain(self):
        folder = self.folder / "again"
        folder.mkdir()
        (folder / "captions.txt").write_text("07-of-another-run: A title. A caption.\n../08-outside: A title.\n")
        for name in ("07-of-another-run.svg", "07-of-another-run.png", "09-mine.png", "notes.txt"):
            (folder / name).write_text("")
        (self.folder / "08-outside.svg").write_text("")
        self.figures(folder, CHROMIUM=str(self.repeat))
        self.assertTrue((self.folder / "08-outside.svg").exists())
        self.assertFalse(list(folder.glob("07-of-another-run.*")))
        self.assertTrue((folder / "09-mine.png").exists() and (folder / "notes.txt").exists())
        self.assertEqual(len(list(folder.iterdir())), 2 * PANELS + 3)

    def test_without_pictures_nothing_is_written(self):
        folder = self.folder / "none"
        (self.folder / "no_report.html").write_text("<!DOCTYPE html><title>Other</title><p>Text")
        for browser, report, words in (("/nowhere/chromium", "report.html", "/nowhere/chromium"),
                                       (shutil.which("false"), "report.html", "failed"), (shutil.which("true"), "report.html", "no pictures"),
                                       (CHROMIUM, "no_report.html", "not a report"), (CHROMIUM, "absent.html", "absent.html")):
            with self.subTest(browser=browser, report=report):
                found = subprocess.run([PROGRAM, self.folder / report, folder], env={**os.environ, "CHROMIUM": str(browser)},
                                       capture_output=True, text=True)
                self.assertEqual(found.returncode, 1)
                self.assertIn(words, found.stderr)
                self.assertEqual(found.stderr.count("\n"), 1)
                self.assertFalse(folder.exists())

    def test_a_failed_run_keeps_earlier_pictures(self):
        folder = self.folder / "kept"
        self.figures(folder, CHROMIUM=str(self.repeat))
        for each in folder.glob("*.svg"):
            each.write_text("earlier")
        before = {each.name: each.read_bytes() for each in folder.iterdir()}
        programs = self.folder / "programs"
        programs.mkdir()
        # A copy that fails half-way, as on a full disk.
        program(programs / "cp", 'case $* in *.pcor-figures-*) exit 1 ;; esac\nexec /bin/cp "$@"')
        found = subprocess.run(self.command(folder), capture_output=True, text=True, env={
            **os.environ, "CHROMIUM": str(self.repeat), "PATH": f"{programs}:{os.environ['PATH']}"})
        self.assertEqual(found.returncode, 1)
        self.assertIn(str(folder), found.stderr)
        self.assertEqual({each.name: each.read_bytes() for each in folder.iterdir()}, before)

    def test_browser_is_started_by_the_name_of_its_link(self):
        # The Chromium of a snap is a link to a program that starts others by the name that it is called by.
        dispatcher = program(self.folder / "dispatcher", f"[ \"${{0##*/}}\" = my-browser ] && exec '{self.repeat}' \"$@\"\nexit 64")
        (self.folder / "my-browser").symlink_to(dispatcher)
        vectors, _ = self.figures(self.folder / "linked", CHROMIUM=str(self.folder / "my-browser"))
        self.assertEqual(len(vectors), PANELS)

    def test_pictures_for_a_column_with_a_temporary_folder_of_any_name(self):
        # Chromium makes a socket, whose path may have at most 107 characters, in the folder of temporary files.
        temporary = self.folder / ("it's my $HOME" + 120 * "x")
        beside = self.folder / "it's"
        temporary.mkdir()
        beside.mkdir()
        self.assert_width(self.figures(self.folder / "quoted", "column", TMPDIR=str(temporary))[0], 325)
        self.assertEqual(list(temporary.iterdir()), [])
        self.assertTrue(beside.exists())

    def test_a_stopped_run_writes_no_file(self):
        temporary = self.folder / "temporary"
        temporary.mkdir()
        slow = program(self.folder / "slow", "exec sleep 100")
        # The run is stopped as soon as its temporary folder appears, and a little later.
        for delay in (0, 0.005, 0.5):
            child = subprocess.Popen(self.command(self.folder / "stopped"),
                                     env={**os.environ, "CHROMIUM": str(slow), "TMPDIR": str(temporary)})
            while not os.listdir(temporary):
                self.assertIsNone(child.poll(), "no temporary folder was made")
            time.sleep(delay)
            child.send_signal(signal.SIGTERM)
            self.assertNotEqual(child.wait(timeout=60), 0)
            self.assertEqual(os.listdir(temporary), [])
            self.assertFalse((self.folder / "stopped").exists())


if __name__ == "__main__":
    skip_without(CHROMIUM, "chromium")
    unittest.main(argv=sys.argv[:1])
