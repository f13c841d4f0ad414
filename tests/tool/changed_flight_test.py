#!/usr/bin/env python3
"""No command mixes two versions of a flight that changes while it runs: changed_flight_test.py PCOR SOURCE_FOLDER

A flight is replaced, appended to or touched at a random moment of a run. The run ends with one line that names the file,
or its result is that of one version: of the old one (the change came after the last look) or of the new one (it came before
the first). PCOR_RUNS sets the runs of each command, 6 if it is not set.
"""
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

pcor = pathlib.Path(sys.argv[1]).resolve()
source = pathlib.Path(sys.argv[2]).resolve()
scenarios = source / "data/scenarios"
runs = int(os.environ.get("PCOR_RUNS", "6"))
model = ["-m", str(scenarios / "models/c130-psfd-eq18.toml")]
COMMANDS = {
    "compare": ["compare", "first.nc", "second.nc", *model, "--json", "-"],
    "refit": ["refit", "first.nc", "second.nc", *model, "-o", "out.toml", "--json", "-", "--force"],
    "diagnose": ["diagnose", "first.nc", "second.nc", *model, "--json", "-"],
    "improve": ["improve", "first.nc", "--holdout", "second.nc", *model, "-o", "out.toml", "--json", "-", "--force"],
    "check": ["check", "first.nc", "second.nc", *model, "--json", "-"],
    "temperature": ["temperature", "first.nc", "second.nc", *model, "-o", "out.toml", "--json", "-", "--force"],
}


def replace(path, other):
    shutil.copy(other, path.parent / "copy.nc")
    os.rename(path.parent / "copy.nc", path)


def append(path, _):
    with open(path, "ab") as file:
        file.write(b"more")


def touch(path, _):
    os.utime(path)


def start(arguments, folder):
    return subprocess.Popen([pcor, *arguments, "--quiet"], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            text=True)


def result_of(arguments, folder):
    begin = time.monotonic()
    out, err = start(arguments, folder).communicate()
    return out, err, time.monotonic() - begin


class ChangedFlight(unittest.TestCase):
    def test_commands_never_mix_two_versions_of_a_flight(self):
        random.seed(1)
        counts = {}
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            for name, seed in (("a", 1), ("b", 2), ("second", 3)):
                subprocess.run([pcor, "simulate", scenarios / "c130-short.toml", "--seed", str(seed), "-o", folder / f"{name}.nc",
                                "--quiet"], check=True)
            for command, arguments in COMMANDS.items():
                allowed, longest = {}, 0.0
                for version in "ab":
                    replace(folder / "first.nc", folder / f"{version}.nc")
                    out, err, seconds = result_of(arguments, folder)
                    allowed[version] = (out, err)
                    longest = max(longest, seconds)
                tally = {"named": 0, "a": 0, "b": 0}
                for run in range(runs):
                    replace(folder / "first.nc", folder / "a.nc")
                    change = (replace, append, touch)[run % 3]
                    running = start(arguments, folder)
                    time.sleep(random.uniform(0.0, longest))
                    change(folder / "first.nc", folder / "b.nc")
                    out, err = running.communicate()
                    same = [version for version, result in allowed.items() if result == (out, err)]
                    lines = err.splitlines()
                    if same:
                        tally[same[0]] += 1
                    elif running.returncode == 1 and len(lines) == 1 and "first.nc" in lines[0] and not out:
                        tally["named"] += 1
                    else:
                        self.fail(f"{command}, run {run}, {change.__name__}: status {running.returncode}, {err!r}, "
                                 f"{len(out)} characters of output")
                counts[command] = tally
                print(command, tally, flush=True)
        self.assertTrue(any(tally["named"] for tally in counts.values()), "no run met a change")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
