#!/usr/bin/env python3
"""The report of every command on simulated flights, for the tests that look at reports.

    reports.py TOOL SOURCE_DIRECTORY FOLDER       makes them in FOLDER
"""

import itertools
import os
import shutil
import subprocess
import sys
from pathlib import Path

FITTED = ("one.nc", "two.nc")
COMMANDS = {
    "inspect": ("one.nc",),
    "compare": (*FITTED, "-m", "model.toml"),
    "refit": (*FITTED, "-m", "model.toml", "-o", "fitted.toml"),
    "diagnose": (*FITTED, "-m", "fitted.toml"),
    "improve": (*FITTED, "-m", "model.toml", "--holdout", "three.nc", "--trace-variables", "-o", "best.toml"),
    "check": (*FITTED, "three.nc", "-m", "fitted.toml"),
    "process": ("three.nc", "-m", "fitted.toml", "-o", "corrected.nc"),
    "temperature": ("climbs.nc", "-m", "model.toml", "-o", "calibrated.toml", "--force"),
}
TOOL, SOURCE, FOLDER = (Path(word).resolve() for word in sys.argv[1:4])


def run(*words, **more):
    return subprocess.run([str(word) for word in words], cwd=FOLDER, check=True, capture_output=True, text=True, **more)


def page(command):
    return (FOLDER / f"{command}.html").as_uri()


def looked_at(ways):
    """Commands and ways for slow checks: those with most kinds of pictures, each in one way; all in all ways in the long tests."""
    return itertools.product(COMMANDS, ways) if os.environ.get("PCOR_EVERY_CASE") else zip(("check", "improve"), ways)


def main():
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir(parents=True)
    # The first half of this flight has every kind of manoeuvre.
    hidden = (SOURCE / "data/scenarios/c130-hidden.toml").read_text()
    climb, landing = ("[[leg]]\nkind = " + leg for leg in ('"climb"\naltitude = 5500', '"landing"'))
    (FOLDER / "hidden.toml").write_text(hidden[:hidden.index(climb)] + hidden[hidden.index(landing):])
    for name, scenario, seed in (("one", "hidden.toml", 101), ("two", "hidden.toml", 102), ("three", "hidden.toml", 103),
                                 ("climbs", SOURCE / "data/scenarios/c130-climbs.toml", 1)):
        run(TOOL, "simulate", scenario, "--seed", seed, "-o", f"{name}.nc", "--quiet")
    shutil.copy(SOURCE / "data/scenarios/models/c130-psfd-eq18.toml", FOLDER / "model.toml")
    for command, words in COMMANDS.items():
        run(TOOL, command, *words, "--report", f"{command}.html", "--quiet")


if __name__ == "__main__":
    main()
