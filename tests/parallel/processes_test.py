#!/usr/bin/env python3
"""With several MPI processes the output and the files of the tool are unchanged, and a failure of one process ends all.

    processes_test.py TOOL SOURCE_DIRECTORY TOOL_WITH_MPI LAUNCHER
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

OPTIONS = [word for word in sys.argv[1:] if word.startswith("-")]  # for unittest
TOOL, SOURCE, TOOL_ON_PROCESSES, LAUNCHER = (Path(word).absolute() for word in sys.argv[1:] if not word.startswith("-"))
MODEL = SOURCE / "data/scenarios/models/c130-psfd-eq18.toml"
SCENARIO = SOURCE / "data/scenarios/c130-short.toml"
FLIGHTS = 5
# Open MPI alone reads these: more processes than processors, and as root where tests are run in containers.
ENVIRONMENT = dict(
    os.environ,
    OMPI_ALLOW_RUN_AS_ROOT="1",
    OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
    OMPI_MCA_rmaps_base_oversubscribe="1",
    OMPI_MCA_hwloc_base_binding_policy="none",
    OMPI_MCA_mpi_yield_when_idle="1",
    MPIR_CVAR_POLLS_BEFORE_YIELD="1",  # MPICH: waiting processes yield the processor
    ASAN_OPTIONS="detect_leaks=0",  # MPI leaks memory in plug-ins that it has unloaded at the end
)
SECONDS = 1200 if os.environ.get("PCOR_SANITIZED") else 120


def command(count, *words):
    return [LAUNCHER, "-n", str(count), TOOL_ON_PROCESSES, *words]


def on_processes(count, *words, **options):
    return subprocess.run(command(count, *words), capture_output=True, text=True, env=ENVIRONMENT, timeout=SECONDS, **options)


def with_one_name(text):
    """The text to copy begins with the program as it was called."""
    return text.replace(str(TOOL_ON_PROCESSES), "pcor").replace(str(TOOL), "pcor")


class Processes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.flights_folder = Path(folder.name)
        for number in range(FLIGHTS):
            flight = cls.flights_folder / f"flight{number}.nc"
            subprocess.run([TOOL, "simulate", SCENARIO, "--seed", str(number + 1), "-o", flight, "--quiet"],
                           check=True)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)
        self.flights = [f"flight{number}.nc" for number in range(FLIGHTS)]
        for flight in self.flights:
            shutil.copy(self.flights_folder / flight, self.path)

    def outputs(self, run, words, outputs):
        """Output and written files of a run."""
        for output in outputs:
            (self.path / output).unlink(missing_ok=True)
        result = run(*words)
        self.assertEqual(result.returncode, 0, result.stderr)
        written = {}
        for output in outputs:
            text = (self.path / output).read_text()
            # When it was made.
            text = re.sub(r'^date = "[^"]*"|\d{4}-\d\d-\d\d \d\d:\d\d UTC by', "", text, flags=re.MULTILINE)
            written[output] = with_one_name(text)
        return {"text": with_one_name(result.stdout), **written}

    def assert_alike(self, words, outputs, counts):
        alone = self.outputs(lambda *all: subprocess.run([TOOL, *all], capture_output=True, text=True, cwd=self.path),
                             words, outputs)
        self.assertTrue(alone["text"])
        for count in counts:
            together = self.outputs(lambda *all: on_processes(count, *all, cwd=self.path), words, outputs)
            for name, text in alone.items():
                self.assertEqual(together[name], text, f"{name} on {count} processes")

    def test_refit_is_identical_for_any_number_of_processes(self):
        self.assert_alike(
            ["refit", *self.flights[:4], "--holdout", self.flights[4], "-m", MODEL, "-o", "fitted.toml",
             "--json", "fitted.json", "--table", "fitted.csv", "--report", "fitted.html"],
            ["fitted.toml", "fitted.json", "fitted.csv", "fitted.html"], [2, 6])

    def test_refit_without_cached_flights_is_identical(self):
        self.assert_alike(
            ["refit", *self.flights[:3], "-m", MODEL, "-o", "fitted.toml", "--json", "fitted.json", "--memory", "0"],
            ["fitted.toml", "fitted.json"], [2])

    def test_refit_in_stages_and_with_two_references_is_identical(self):
        self.assert_alike(
            ["refit", *self.flights[:3], "-m", MODEL, "-o", "fitted.toml", "--json", "fitted.json",
             "--stage", "pitch manoeuvre, speed run: static-alpha", "--reference", "lams", "--reference", "height",
             "--training-share", "0.8", "--force"],
            ["fitted.toml", "fitted.json"], [4])

    def test_refit_compare_and_diagnose_by_wind_and_height_are_identical(self):
        by_gps = ["-m", MODEL, "--reference", "wind", "--reference", "height"]
        self.assert_alike(["refit", *self.flights[:3], *by_gps, "-o", "fitted.toml", "--json", "fitted.json"],
                          ["fitted.toml", "fitted.json"], [3])
        self.assert_alike(["compare", *self.flights[:3], *by_gps, "--json", "compare.json"], ["compare.json"], [2])
        self.assert_alike(["diagnose", *self.flights[:3], *by_gps, "--json", "diagnose.json"], ["diagnose.json"], [2])

    def test_compare_is_identical(self):
        self.assert_alike(
            ["compare", *self.flights[:3], "-m", MODEL, "--report", "compare.html", "--json", "compare.json",
             "--table", "compare.csv"],
            ["compare.html", "compare.json", "compare.csv"], [4])

    def test_check_is_identical(self):
        self.assert_alike(
            ["check", *self.flights[:3], "-m", MODEL, "--report", "check.html", "--json", "check.json",
             "--table", "check.csv"],
            ["check.html", "check.json", "check.csv"], [2])

    def test_temperature_is_identical(self):
        self.assert_alike(
            ["temperature", *self.flights[:3], "-m", MODEL, "-o", "warm.toml", "--json", "temperature.json", "--report",
             "temperature.html", "--degree", "0", "--force"],
            ["warm.toml", "temperature.json", "temperature.html"], [2])

    def test_diagnose_is_identical(self):
        self.assert_alike(
            ["diagnose", *self.flights[:3], "-m", MODEL, "--report", "diagnose.html", "--json", "diagnose.json"],
            ["diagnose.html", "diagnose.json"], [4])

    def test_improve_is_identical(self):
        self.assert_alike(
            ["improve", *self.flights[:2], "-m", MODEL, "--holdout", self.flights[2], "-o", "best.toml", "--report",
             "improve.html", "--json", "improve.json", "--force"],
            ["best.toml", "improve.html", "improve.json"], [2])

    def test_unreadable_flights_are_skipped_by_all_processes(self):
        self.damage(self.flights[1], "truncated")
        self.damage(self.flights[2], "missing")
        self.assert_alike(
            ["refit", *self.flights[:4], "-m", MODEL, "-o", "fitted.toml", "--json", "fitted.json", "--skip-unreadable",
             "--force"],
            ["fitted.toml", "fitted.json"], [3])

    def damage(self, flight, how):
        path = self.path / flight
        if how == "missing":
            path.unlink()
        elif how == "truncated":
            path.write_bytes(path.read_bytes()[: path.stat().st_size // 3])
        else:
            import netCDF4

            with netCDF4.Dataset(path, "a") as file:
                file["PSFD"].units = "furlong"

    def test_unreadable_flight_gives_one_error_message(self):
        for how in ["missing", "truncated", "wrong unit"]:
            for bad in (self.flights[0], self.flights[2]):  # of the first process, and of another
                with self.subTest(how=how, flight=bad):
                    shutil.copy(self.flights_folder / bad, self.path)
                    self.damage(bad, how)
                    words = ["refit", *self.flights[:4], "-m", MODEL, "-o", "fitted.toml", "--json", "fitted.json"]
                    alone = subprocess.run([TOOL, *words], capture_output=True, text=True, cwd=self.path)
                    self.assertEqual(alone.returncode, 1)
                    together = on_processes(3, *words, cwd=self.path)
                    self.assertEqual(together.returncode, 1)
                    # mpirun adds other lines.
                    told = [line for line in together.stderr.splitlines() if line.startswith("pcor: ")]
                    self.assertEqual("\n".join(told) + "\n", alone.stderr)
                    self.assertFalse(list(self.path.glob("*fitted*")))
            shutil.copy(self.flights_folder / bad, self.path)

    def test_unwritable_output_and_wrong_usage_give_one_message(self):
        for status, words in {
            1: ["refit", *self.flights[:2], "-m", MODEL, "-o", "nowhere/fitted.toml"],
            2: ["refit", *self.flights[:2], "-m", MODEL],
        }.items():
            alone = subprocess.run([TOOL, *words], capture_output=True, text=True, cwd=self.path)
            together = on_processes(3, *words, cwd=self.path)
            self.assertEqual((alone.returncode, together.returncode), (status, status))
            told = [line for line in together.stderr.splitlines() if line.startswith("pcor: ")]
            self.assertEqual("\n".join(told) + "\n", alone.stderr.replace(str(TOOL), str(TOOL_ON_PROCESSES)))

    def test_processes_with_different_commands_are_refused(self):
        def one(*more):
            return ["-n", "1", TOOL_ON_PROCESSES, "refit", *self.flights[:2], "-m", MODEL, "-o", "fitted.toml", *more]
        together = subprocess.run([LAUNCHER, *one(), ":", *one("--loss", "huber")],
                                  capture_output=True, text=True, env=ENVIRONMENT, timeout=SECONDS, cwd=self.path)
        self.assertEqual(together.returncode, 1)
        self.assertIn("different results", together.stderr)
        self.assertFalse((self.path / "fitted.toml").exists())

    def test_process_command_on_several_processes_is_refused(self):
        words = ["process", self.flights[0], "-m", MODEL, "-o", "corrected.nc"]
        self.assertEqual(on_processes(1, *words, cwd=self.path).returncode, 0)
        (self.path / "corrected.nc").unlink()
        together = on_processes(2, *words, cwd=self.path)
        self.assertEqual(together.returncode, 2)
        self.assertIn("docs/campaigns.md", together.stderr)
        self.assertFalse((self.path / "corrected.nc").exists())

    def at_work(self):
        """The processes of the tool that have opened a flight of this test."""
        found = []
        for process in Path("/proc").glob("[0-9]*"):
            try:
                opened = [os.readlink(file) for file in (process / "fd").iterdir()]
                if os.readlink(process / "exe") == str(TOOL_ON_PROCESSES.resolve()) and \
                        any(file.startswith(str(self.path.resolve())) for file in opened):
                    found.append(int(process.name))
            except OSError:
                pass
        return sorted(found)

    def test_killed_process_ends_the_job(self):
        words = ["refit", *self.flights, "-m", MODEL, "-o", "fitted.toml", "--memory", "0"]
        killed = 0
        for trial in range(3):
            job = subprocess.Popen(command(3, *words), cwd=self.path, env=ENVIRONMENT, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, start_new_session=True)
            try:
                processes = []
                begin = time.monotonic()
                while len(processes) < 3 and job.poll() is None and time.monotonic() - begin < SECONDS:
                    processes = self.at_work()
                time.sleep(0.05 * trial)
                if len(processes) == 3 and job.poll() is None:
                    os.kill(processes[trial % 3], signal.SIGKILL)
                    job.wait(SECONDS)
                    if job.returncode == 0:  # all had been said when it was killed
                        self.assertTrue((self.path / "fitted.toml").exists())
                    else:
                        killed += 1
                    begin = time.monotonic()
                    while self.at_work() and time.monotonic() - begin < SECONDS:
                        time.sleep(0.1)
                    self.assertEqual(self.at_work(), [])
                job.wait(SECONDS)
            finally:
                if job.poll() is None:
                    os.killpg(job.pid, signal.SIGKILL)
            (self.path / "fitted.toml").unlink(missing_ok=True)
        self.assertGreater(killed, 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + OPTIONS)
