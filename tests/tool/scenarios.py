"""Scenarios and flights that several suites share."""

import hashlib
import os
import shutil
import subprocess
import tempfile
from pathlib import Path


def half_of_hidden(source):
    """The first half of c130-hidden, which has every kind of manoeuvre."""
    text = (source / "data/scenarios/c130-hidden.toml").read_text()
    climb, landing = ("[[leg]]\nkind = " + leg for leg in ('"climb"\naltitude = 5500', '"landing"'))
    return text[:text.index(climb)] + text[text.index(landing):]


def simulate(tool, output, scenario, seed):
    """Writes the simulated flight of a scenario, given as text. It is kept in the folder of the
    tool and copied until the tool is newer."""
    flights = tool.parent / "pcor_test_flights"
    flight = flights / hashlib.sha256(f"{seed} {scenario}".encode()).hexdigest()
    if not flight.exists() or flight.stat().st_mtime < tool.stat().st_mtime:
        flights.mkdir(exist_ok=True)
        with tempfile.TemporaryDirectory(dir=flights) as folder:
            written, simulated = Path(folder) / "scenario.toml", Path(folder) / "flight.nc"
            written.write_text(scenario)
            subprocess.run([tool, "simulate", written, "-o", simulated, "--seed", str(seed), "--quiet"], check=True)
            os.replace(simulated, flight)
    shutil.copy(flight, output)
