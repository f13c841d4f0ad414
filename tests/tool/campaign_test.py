#!/usr/bin/env python3
"""The files of examples/campaign on many flights, one of them damaged.

    campaign_test.py TOOL SOURCE_DIRECTORY

The job arrays run as scripts, without a scheduler, with the variables that a scheduler sets.
"""

import csv
import json
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

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
from scenarios import simulate  # noqa: E402

TOOL = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()
PAGE = (SOURCE / "docs/campaigns.md").read_text()
MODEL = SOURCE / "data/scenarios/models/c130-psfd-eq18.toml"
# Two projects have a flight with the same name, and a name has a blank.
NAMES = [f"{project}/rf{number:02} {project}.nc" for project in ("first", "second") for number in range(1, 6)] + \
        ["first/rf06.nc", "second/rf06.nc"]
BAD = "second/rf06.nc"
ARRAYS = {"array.pbs": "PBS_ARRAY_INDEX", "array.slurm": "SLURM_ARRAY_TASK_ID"}


def setUpModule():
    global FLIGHTS, WHOLE
    folder = tempfile.TemporaryDirectory()
    unittest.addModuleCleanup(folder.cleanup)
    FLIGHTS = Path(folder.name) / "all flights"
    for seed, name in enumerate(NAMES, 1):
        (FLIGHTS / name).parent.mkdir(parents=True, exist_ok=True)
        simulate(TOOL, FLIGHTS / name, (SOURCE / "data/scenarios/c130-short.toml").read_text(), seed)
    WHOLE = (FLIGHTS / BAD).read_bytes()


def command_of_the_page(begin):
    (command,) = re.findall(rf"^{begin}.*$", PAGE, flags=re.MULTILINE)
    return command


class CampaignTest(unittest.TestCase):
    """A folder of the campaign, with its files edited as described on the page; one flight is cut in half."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "campaign"
        shutil.copytree(SOURCE / "examples/campaign", self.path)
        self.edit("one_flight", "flights=flights", f"flights='{FLIGHTS}'")
        self.edit("one_flight", "model=model.toml", f"model='{MODEL}'")
        self.run_script(command_of_the_page("find flights/").replace("flights/", f"'{FLIGHTS}'/"))
        (FLIGHTS / BAD).write_bytes(WHOLE[: len(WHOLE) // 2])

    def edit(self, file, old, new):
        text = (self.path / file).read_text()
        self.assertEqual(text.count(old), 1, f"{old} of {file}")
        (self.path / file).write_text(text.replace(old, new))

    def run_script(self, command, **environment):
        environment = {**os.environ, "PATH": f"{TOOL.parent}:{os.environ['PATH']}", "HOME": str(self.path.parent),
                       **environment}
        return subprocess.run(["bash", "-c", command], cwd=self.path, env=environment, capture_output=True, text=True)

    def array(self, file, tasks, indices=None):
        """Runs the tasks of a job array one after the other; returns their results."""
        self.edit(file, "tasks=100\n", f"tasks={tasks}\n")
        return [self.run_script(f"bash {file}", PBS_O_WORKDIR=str(self.path), **{ARRAYS[file]: str(index)})
                for index in (indices or range(tasks))]

    def mend(self):
        (FLIGHTS / BAD).write_bytes(WHOLE)

    def made(self, kind="corrected", suffix=""):
        """When each file was made, by its name."""
        root = self.path / kind
        return {str(path.relative_to(root)): path.stat().st_mtime_ns for path in root.rglob("*" + suffix) if path.is_file()}

    def assert_all_but_the_bad_one(self):
        good = set(NAMES) - {BAD}
        self.assertEqual(set(self.made()), good)
        self.assertEqual(set(self.made("checks")), {name + ".csv" for name in good})
        unfinished = self.run_script("./unfinished")
        self.assertEqual((unfinished.returncode, unfinished.stdout.count("\n")), (1, 1))
        self.assertRegex(unfinished.stdout, f"^{BAD}: .*truncated")

    def assert_all(self):
        self.assertEqual(set(self.made()), set(NAMES))
        self.assertEqual(self.run_script("./unfinished").stdout, "")


@unittest.skipUnless(shutil.which("parallel"), "GNU parallel is not installed")
class OneMachine(CampaignTest):
    def test_failed_flight_is_reported_and_processed_after_repair(self):
        result = self.run_script("./one_machine")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn(BAD, result.stdout)
        self.assert_all_but_the_bad_one()
        before = self.made(), self.made("checks")
        self.mend()
        for command in ("./one_machine --resume-failed", "./one_machine"):
            with self.subTest(command=command):
                result = self.run_script(command)
                self.assertEqual((result.returncode, result.stdout), (0, ""), result.stderr)
                self.assert_all()
                self.assertLessEqual(before[0].items(), self.made().items())
                self.assertLessEqual(before[1].items(), self.made("checks").items())
                (self.path / "corrected" / BAD).unlink()

    def test_missing_gnu_parallel_marks_no_flight_as_done(self):
        (self.path / "parallel").write_text("#!/bin/sh\nexit 127\n")
        (self.path / "parallel").chmod(0o755)
        result = self.run_script("./one_machine", PATH=f"{self.path}:{os.environ['PATH']}")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stdout.count(": not begun\n"), len(NAMES))


class JobArrays(CampaignTest):
    def test_job_arrays_are_valid_scripts(self):
        for file in ARRAYS:
            self.assertEqual(self.run_script(f"bash -n {file}").returncode, 0, file)

    def test_every_flight_belongs_to_one_task(self):
        (self.path / "one_flight").write_text('#!/bin/sh\necho "$1"\n')
        for file in ARRAYS:
            original = (self.path / file).read_text()
            for tasks in (1, 2, 5, len(NAMES), 17):
                with self.subTest(file=file, tasks=tasks):
                    done = "".join(result.stdout for result in self.array(file, tasks, range(tasks + 2)))
                    self.assertEqual(sorted(done.splitlines()), sorted(NAMES))
                    (self.path / file).write_text(original)

    def test_only_the_task_of_the_bad_flight_fails(self):
        for file in ARRAYS:
            with self.subTest(file=file):
                statuses = [result.returncode for result in self.array(file, 5)]
                self.assertEqual((statuses.count(0), len(statuses)), (4, 5))
                self.assert_all_but_the_bad_one()
                for kind in ("corrected", "checks", "failed"):
                    shutil.rmtree(self.path / kind)

    def test_a_second_run_processes_new_flights_only(self):
        self.array("array.slurm", 5)
        before = self.made()
        self.mend()
        self.edit("array.slurm", "tasks=5", "tasks=100")
        self.assertEqual({result.returncode for result in self.array("array.slurm", 5)}, {0})
        self.assert_all()
        self.assertLessEqual(before.items(), self.made().items())

    def test_missing_flight_list_is_an_error(self):
        (self.path / "flights.txt").unlink()
        for file in ARRAYS:
            self.assertNotEqual(self.array(file, 1)[0].returncode, 0)
        self.assertEqual(self.run_script("./unfinished").returncode, 1)


class OneFlight(CampaignTest):
    def test_checks_of_all_flights_form_one_table(self):
        for name in NAMES[:2]:
            self.assertEqual(self.run_script(f"./one_flight '{name}'").returncode, 0)
        self.run_script(command_of_the_page("find checks"))
        with open(self.path / "checks.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        verdicts = {name: [row["verdict"] for row in rows if row["flight"] == Path(name).name] for name in NAMES[:2]}
        by_tool = self.run_script(f"pcor check '{FLIGHTS / NAMES[0]}' -m '{MODEL}' --json -")
        expected = [check["verdict"] or "not run" for check in json.loads(by_tool.stdout)["checks"]]
        self.assertEqual(verdicts[NAMES[0]], expected)
        self.assertEqual(len(verdicts[NAMES[1]]), len(expected))

    def tool_that(self, does):
        """Replaces the tool by another program."""
        (self.path / "pcor").write_text(f"#!/bin/sh\n{does}\n")
        (self.path / "pcor").chmod(0o755)
        return {"PATH": f"{self.path}:{os.environ['PATH']}"}

    def test_a_stopped_task_is_not_done(self):
        environment = {**os.environ, **self.tool_that("touch begun; exec sleep 60")}
        run = subprocess.Popen(["./one_flight", NAMES[0]], cwd=self.path, start_new_session=True, env=environment)
        while not (self.path / "begun").exists():
            time.sleep(0.01)
        os.killpg(run.pid, signal.SIGKILL)
        run.wait()
        self.assertIn(f"{NAMES[0]}: interrupted\n", self.run_script("./unfinished").stdout)

    def test_killed_tool_is_reported_as_failed(self):
        """Like a system without free memory."""
        result = self.run_script(f"./one_flight '{NAMES[0]}'", **self.tool_that("kill -9 $$"))
        self.assertEqual((result.returncode, result.stderr), (1, f"{NAMES[0]}: killed, status 137\n"))

    def test_last_line_may_lack_a_newline(self):
        (self.path / "flights.txt").write_text(NAMES[0])
        self.assertEqual(self.run_script("./unfinished").stdout, f"{NAMES[0]}: not begun\n")


@unittest.skipUnless(shutil.which("make"), "make is not installed")
class Make(CampaignTest):
    def test_failed_flight_is_reported_and_processed_after_repair(self):
        plain = self.path / "flights"  # make knows no names with blanks
        for name in NAMES:
            (plain / name.replace(" ", "_")).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(FLIGHTS / name, plain / name.replace(" ", "_"))
        shutil.copy(MODEL, self.path / "model.toml")
        result = self.run_script("make -k -j 2")
        self.assertEqual(result.returncode, 2)
        self.assertIn(f"corrected/{BAD}] Error", result.stderr)
        before = self.made()
        self.assertEqual(set(before), {name.replace(" ", "_") for name in NAMES} - {BAD})
        (plain / BAD).write_bytes(WHOLE)
        self.assertEqual(self.run_script("make -k -j 2").returncode, 0)
        self.assertLessEqual(before.items(), self.made().items())


class Page(unittest.TestCase):
    def test_page_names_each_file(self):
        for path in (SOURCE / "examples/campaign").iterdir():
            self.assertIn(f"`{path.name}`", PAGE)

    def test_links_resolve(self):
        for target in re.findall(r"\]\(([^)#:]+)\)", PAGE):
            self.assertTrue((SOURCE / "docs" / target).exists(), target)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)  # which gives the reason of a test that is skipped
