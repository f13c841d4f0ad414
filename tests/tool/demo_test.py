#!/usr/bin/env python3
"""tools/demo, without a flight and on flights of PCOR_FLIGHTS.

    demo_test.py TOOL SOURCE_DIRECTORY
"""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
from long_tests import in_long_tests  # noqa: E402

TOOL = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()
FLIGHTS = sorted(Path(os.environ["PCOR_FLIGHTS"]).glob("*.nc"), key=os.path.getsize) if os.environ.get("PCOR_FLIGHTS") else []
if not os.environ.get("PCOR_EVERY_CASE"):  # set in the long tests
    del FLIGHTS[:-1]


class Demo(unittest.TestCase):
    def run_demo(self, flight):
        with tempfile.TemporaryDirectory() as folder:
            result = subprocess.run([SOURCE / "tools/demo", flight, folder], env={**os.environ, "PCOR": str(TOOL)},
                                    capture_output=True, text=True)
            self.assertEqual(result.returncode, "pressures unchanged" in result.stdout, result.stdout + result.stderr)
            made = {path.name for path in Path(folder).iterdir()}
        self.assertLessEqual({"corrected.nc", "model.toml", "inspect.html", "process.html"}, made)
        # One screen for each command and the summary.
        self.assertLess(result.stdout.count("\n"), 65)
        return result.stdout

    @in_long_tests  # continuous integration runs this demo as its first step
    def test_without_a_flight_the_first_line_announces_a_simulation(self):
        output = self.run_demo("")
        self.assertIn("simulated", output.splitlines()[0])
        self.assertIn("the flight corrected with best.toml", output)

    def test_help_is_not_a_flight(self):
        result = subprocess.run([SOURCE / "tools/demo", "--help"], capture_output=True, text=True)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("tools/demo [FLIGHT.nc [FOLDER]]", result.stdout)

    def test_files_of_the_user_stay(self):
        with tempfile.TemporaryDirectory() as folder:
            model = Path(folder) / "model.toml"
            model.write_text("mine")
            result = subprocess.run([SOURCE / "tools/demo", "", folder], env={**os.environ, "PCOR": str(TOOL)},
                                    capture_output=True, text=True)
            self.assertEqual(result.returncode, 2)
            self.assertIn(folder, result.stderr)
            self.assertEqual(model.read_text(), "mine")

    def test_a_second_demo_deletes_only_results(self):
        with tempfile.TemporaryDirectory() as folder:
            mine, old = Path(folder) / "mine.toml", Path(folder) / "improve.html"
            for path in (Path(folder) / ".pcor-demo", mine, old):
                path.touch()
            result = subprocess.run([SOURCE / "tools/demo", mine, folder], capture_output=True, text=True)
            self.assertEqual(result.returncode, 2)  # the flight is in the folder of the results
            self.assertTrue(mine.exists())
            # A program that proposes no reference.
            result = subprocess.run([SOURCE / "tools/demo", "", folder], env={**os.environ, "PCOR": "/bin/true"}, capture_output=True, text=True)
            self.assertTrue(mine.exists())
            self.assertFalse(old.exists())
            self.assertEqual(result.returncode, 1)
            self.assertNotIn("pcor refit", result.stdout)

    @unittest.skipUnless(FLIGHTS, "PCOR_FLIGHTS is not set")
    def test_real_flights_are_corrected(self):
        for flight in FLIGHTS:
            with self.subTest(flight=flight.name):
                self.assertNotIn("simulated", self.run_demo(flight))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
