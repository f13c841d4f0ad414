#!/usr/bin/env python3
"""Pictures of a report as files, by the option --figures.

    figures_test.py TOOL SOURCE_DIRECTORY FOLDER      FOLDER: where reports.py made flights and reports

Without Chromium the test is skipped (status 77), or fails if PCOR_REQUIRE_CHROMIUM is set.
"""

import os
import signal
import subprocess
import sys
import time
import unittest

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
from browser import CHROMIUM, skip_without  # noqa: E402
from reports import COMMANDS, FITTED, FOLDER, TOOL, run  # noqa: E402


class Figures(unittest.TestCase):
    def test_command_writes_figures(self):
        result = run(TOOL, "compare", *COMMANDS["compare"], "--figures", "figures", "--figures-for", "column")
        self.assertIn("wrote figures\n", result.stdout)
        names = sorted(each.name for each in (FOLDER / "figures").iterdir())
        self.assertIn("captions.txt", names)
        self.assertEqual(len([name for name in names if name.endswith(".svg")]), len([name for name in names if name.endswith(".png")]))
        text = (FOLDER / "figures" / "captions.txt").read_text()
        *captions, origin = [line for line in text.splitlines() if line]
        self.assertTrue(origin.startswith("Command: pcor compare one.nc two.nc -m model.toml"), origin)
        self.assertEqual(len(captions), len([name for name in names if name.endswith(".svg")]))
        for caption in captions:
            self.assertNotRegex(caption, r"Command:|\bDrag\b|\bchoose\b")
        self.assertIn("Command: pcor compare", next((FOLDER / "figures").glob("*.svg")).read_text())

    def test_impossible_figures_are_an_error_before_the_run(self):
        words = [str(TOOL), "refit", *FITTED, "-m", "model.toml", "-o", "none.toml", "--figures"]
        for folder, browser, said in (("figures2", "/nowhere", "CHROMIUM names"), ("model.toml", CHROMIUM, "model.toml is also an input"),
                                      ("one.nc/figures", CHROMIUM, "cannot be a folder")):
            found = subprocess.run([*words, folder], cwd=FOLDER, env={**os.environ, "CHROMIUM": browser}, capture_output=True, text=True)
            self.assertEqual((found.returncode, found.stdout), (1, ""))
            self.assertIn(said, found.stderr)
            self.assertEqual(found.stderr.count("\n"), 1)
            self.assertFalse((FOLDER / "none.toml").exists() or (FOLDER / "figures2").exists())

    def test_a_failed_run_keeps_earlier_figures(self):
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

    def test_temporary_folder_may_have_any_name(self):
        # Chromium makes a socket, whose path may have at most 107 characters, in the folder of temporary files.
        temporary = FOLDER / ("it's my $HOME" + 120 * "x")
        beside = FOLDER / "it's"
        temporary.mkdir()
        beside.mkdir()
        found = subprocess.run([TOOL, "inspect", "one.nc", "--figures", "quoted", "--quiet"], cwd=FOLDER,
                               env={**os.environ, "TMPDIR": str(temporary)}, capture_output=True, text=True)
        self.assertEqual(found.returncode, 0, found.stderr)
        self.assertEqual(list(temporary.iterdir()), [])
        self.assertTrue(beside.exists())

    def test_a_stopped_run_writes_no_file(self):
        temporary = FOLDER / "temporary"
        temporary.mkdir()
        slow = FOLDER / "slow"
        stopped = FOLDER / "was stopped"
        slow.write_text(f"#!/bin/sh\nuntil [ -e '{stopped}' ]; do sleep 0.05; done\n")
        slow.chmod(0o755)
        # The run is stopped as soon as its temporary folder appears, and a little later.
        for delay in (0, 0.005, 0.5):
            child = subprocess.Popen([TOOL, "inspect", "one.nc", "--figures", "stopped", "--quiet"], cwd=FOLDER,
                                     env={**os.environ, "CHROMIUM": str(slow), "TMPDIR": str(temporary)})
            while not os.listdir(temporary):
                self.assertIsNone(child.poll(), "the browser was not started")
            time.sleep(delay)
            child.terminate()
            self.assertEqual(child.wait(), -signal.SIGTERM)
            stopped.touch()
            end = time.monotonic() + 60  # a loaded machine takes seconds to end the browser
            while os.listdir(temporary) and time.monotonic() < end:
                time.sleep(0.1)
            self.assertEqual(os.listdir(temporary), [])
            self.assertFalse((FOLDER / "stopped").exists())
            stopped.unlink()


if __name__ == "__main__":
    skip_without(CHROMIUM, "chromium")
    unittest.main(argv=sys.argv[:1])
