#!/usr/bin/env python3
"""Measures the processor time and the memory of `pcor diagnose` and `pcor improve` on simulated flights of two hours.

    benchmarks/diagnosis_benchmark.py [BUILD_FOLDER] [FLIGHTS]        defaults build/benchmark and 16

The flights are those of data/scenarios/c130-hidden.toml with different seeds: the model lacks an effect of the engine
torque. Exit status 1 if a target, which is for 16 flights on a quiet machine, is missed.
"""

import pathlib
import sys
import tempfile

from measure import ROOT, Targets, median, run

SCENARIO = ROOT / "data/scenarios/c130-hidden.toml"
MODEL = ROOT / "data/scenarios/models/c130-psfd-eq18.toml"
COMMANDS = ["diagnose", "improve"]
MAX_SECONDS = {"diagnose": 5.0, "improve": 8.0}
MAX_MEMORY = 1024.0  # MiB


def simulate(build, number, folder):
    """The flights."""
    flights = [folder / f"{seed}.nc" for seed in range(1, number + 1)]
    for seed, flight in enumerate(flights, 1):
        run([build / "tools/pcor", "simulate", SCENARIO, "--seed", str(seed), "-o", flight])
    return flights


def measure(build, name, flights):
    """Usage of one run of a command."""
    command = [build / "tools/pcor", name, *flights, "-m", MODEL]
    return run(command + (["-o", flights[0].with_name("improved.toml")] if name == "improve" else []))


def main():
    build = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build/benchmark"
    number = int(sys.argv[2]) if len(sys.argv) > 2 else 16
    targets = Targets()
    with tempfile.TemporaryDirectory() as folder:
        flights = simulate(build, number, pathlib.Path(folder))
        for name in COMMANDS:
            usages = [measure(build, name, flights) for _ in range(3)]
            seconds = median(each.processor for each in usages)
            memory = median(each.memory for each in usages)
            print(f"{name}, {number} flights: {median(each.wall for each in usages):.1f} s")
            targets.check("processor time, s", seconds, seconds <= MAX_SECONDS[name],
                          f"at most {MAX_SECONDS[name]}")
            targets.check("memory, MiB", memory, memory <= MAX_MEMORY, f"at most {MAX_MEMORY}")
    return 1 if targets.missed else 0


if __name__ == "__main__":
    sys.exit(main())
