#!/usr/bin/env python3
"""The report of every command on simulated flights, and on a flight of PCOR_FLIGHTS, for the tests that look at reports.

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
    "compare-two": (*FITTED, "-m", "model.toml", "-m", "fitted.toml"),
}
GOTEX = Path(os.environ.get("PCOR_FLIGHTS", "")) / "GOTEX-rf06-C130-2004.nc"
if GOTEX.exists():
    BY_SYSTEM = ("--reference", "static:c130-psfrd-2003")
    BY_GPS = ("--reference", "height", "--reference", "wind")
    COMMANDS |= {
        "inspect-real": (GOTEX,),
        "refit-real": (GOTEX, "-m", "c130-psfd-qcf-2003", *BY_SYSTEM, "-o", "real.toml"),
        "compare-real": (GOTEX, "-m", "c130-psfd-qcf-2003", "-m", "real.toml", *BY_SYSTEM),
        "diagnose-real": (GOTEX, "-m", "real.toml", *BY_SYSTEM),
        "improve-real": (GOTEX, "-m", "real.toml", *BY_SYSTEM, "-o", "best-real.toml"),
        "check-real": (GOTEX, "-m", "real.toml"),
        "process-real": (GOTEX, "-m", "real.toml", "-o", "corrected-real.nc"),
        "temperature-real": (GOTEX, "-m", "real.toml", "-o", "calibrated-real.toml", "--force"),
        "refit-gps": (GOTEX, "-m", "c130-psfd-qcf-2003", *BY_GPS, "-o", "gps.toml", "--force"),
        "diagnose-gps": (GOTEX, "-m", "gps.toml", *BY_GPS),
    }
TOOL, SOURCE, FOLDER = (Path(word).resolve() for word in sys.argv[1:4])
sys.dont_write_bytecode = True  # no __pycache__ in the source directory
sys.path.insert(0, str(SOURCE / "tests/tool"))
from scenarios import half_of_hidden, simulate  # noqa: E402


def run(*words, **more):
    return subprocess.run([str(word) for word in words], cwd=FOLDER, check=True, capture_output=True, text=True, **more)


def page(name):
    return (FOLDER / f"{name}.html").as_uri()


def looked_at(ways):
    """Names of reports and ways for slow checks: those with most kinds of pictures, each in one way; all in all ways in the long tests."""
    return itertools.product(COMMANDS, ways) if os.environ.get("PCOR_EVERY_CASE") else zip(("check", "improve"), ways)


def main():
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir(parents=True)
    climbs = (SOURCE / "data/scenarios/c130-climbs.toml").read_text()
    for name, scenario, seed in (("one", half_of_hidden(SOURCE), 101), ("two", half_of_hidden(SOURCE), 102),
                                 ("three", half_of_hidden(SOURCE), 103), ("climbs", climbs, 1)):
        simulate(TOOL, FOLDER / f"{name}.nc", scenario, seed)
    shutil.copy(SOURCE / "data/scenarios/models/c130-psfd-eq18.toml", FOLDER / "model.toml")
    for name, words in COMMANDS.items():
        run(TOOL, name.split("-")[0], *words, "--report", f"{name}.html", "--quiet")


if __name__ == "__main__":
    main()
