"""Scenarios and flights that several suites share."""

import hashlib
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path


def half_of_hidden(source):
    """The first half of c130-hidden, which has every kind of manoeuvre."""
    text = (source / "data/scenarios/c130-hidden.toml").read_text()
    climb, landing = ("[[leg]]\nkind = " + leg for leg in ('"climb"\naltitude = 5500', '"landing"'))
    return text[:text.index(climb)] + text[text.index(landing):]


def simulate(tool, output, scenario, seed=None):
    """Writes the simulated flight of the text of a scenario. Each flight is simulated once for each build of the tool, kept beside
    the tool, and copied. Flights of builds that are older than a day are deleted."""
    options = [] if seed is None else ["--seed", str(seed)]
    flights = tool.parent / "pcor_test_flights" / str(tool.stat().st_mtime_ns)
    flight = flights / hashlib.sha256(" ".join([*options, scenario]).encode()).hexdigest()
    if not flight.exists():
        flights.mkdir(parents=True, exist_ok=True)
        for other in flights.parent.iterdir():
            if time.time() - other.stat().st_mtime > 86400:
                shutil.rmtree(other, ignore_errors=True)
        with tempfile.TemporaryDirectory(dir=flights) as folder:
            written, simulated = Path(folder) / "scenario.toml", Path(folder) / "flight.nc"
            written.write_text(scenario)
            subprocess.run([tool, "simulate", written, "-o", simulated, *options, "--quiet"], check=True)
            os.replace(simulated, flight)
    shutil.copy(flight, output)
