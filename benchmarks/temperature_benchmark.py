#!/usr/bin/env python3
"""Measures the run time of `pcor temperature`, with reading, on simulated climbs and descents at 1 Hz, on two cores.

    benchmarks/temperature_benchmark.py [BUILD_FOLDER]        default build/benchmark

Each flight repeats the legs of data/scenarios/c130-climbs.toml with a different seed. The flights are fitted as recorded,
and as written by `pcor process --hydrostatic` (--archived).

The time of the search for the noise model differs by a factor of two between sets of the same size. So the time of a
size is the mean over several random sets of flights. Sizes alternate, so that other load on the machine affects all.
Targets refer to processor time, which depends less on other load than wall time. Exit status 1 if a target is missed.
"""

import concurrent.futures
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile

from measure import ROOT, Targets, run

SCENARIO = ROOT / "data/scenarios/c130-climbs.toml"
MODEL = ROOT / "data/models/c130-psfd-eq18.toml"
CORES = 2
SETS = 8
HOURS_PER_REPETITION = 2.5  # legs of the scenario from the first climb to the last descent, and a level leg
LEVEL = '\nkind = "level"\nduration = 200\n\n'
NUMBERS = [5, 10, 20]  # numbers of flights of 5 hours
LENGTHS = [2.5, 5.0, 10.0]  # hours, for FEW flights
FEW = 5
AVAILABLE = {2.5: 20, 5.0: 40, 10.0: 20}  # hours: number of simulated flights

MAX_SECONDS = 10.0  # for 20 flights of 5 hours
MAX_EXPONENT = 1.2  # exponent of time as a function of the number of samples; short flights may need more iterations


def scenario(hours):
    """Text of the scenario with repeated legs, for a flight of the given length."""
    head, *legs = SCENARIO.read_text().split("[[leg]]")
    begin, middle, end = legs[:2], legs[2:-2], legs[-2:]
    return "[[leg]]".join([head, *begin, *round(hours / HOURS_PER_REPETITION) * [LEVEL, *middle], *end])


def simulate(tool, folder):
    """Simulated flights by (hours, "recorded" or "archived")."""
    flights = {}
    tasks = []
    for hours, number in AVAILABLE.items():
        plan = folder / f"{hours}.toml"
        plan.write_text(scenario(hours))
        for seed in range(1, number + 1):
            recorded, archived = folder / f"{hours}-{seed}.nc", folder / f"{hours}-{seed}-archived.nc"
            flights.setdefault((hours, "recorded"), []).append(recorded)
            flights.setdefault((hours, "archived"), []).append(archived)
            tasks.append((plan, seed, recorded, archived))

    def make(task):
        plan, seed, recorded, archived = task
        subprocess.run([tool, "simulate", plan, "--seed", str(seed), "-o", recorded, "--quiet"], check=True)
        subprocess.run([tool, "process", recorded, "-m", MODEL, "-o", archived, "--hydrostatic", "--quiet"], check=True)

    with concurrent.futures.ThreadPoolExecutor(CORES) as pool:
        list(pool.map(make, tasks))
    return flights


def records(flight):
    header = subprocess.run(["ncdump", "-h", flight], stdout=subprocess.PIPE, text=True, check=True).stdout
    return int(header.split("UNLIMITED ; // (")[1].split()[0])


def mean(values):
    return sum(values) / len(values)


def measure(tool, folder, kind, flights, sizes):
    """Usage of all sets by size; a size is (hours, number of flights)."""
    draw = random.Random(1)
    found = {size: [] for size in sizes}
    for _ in range(SETS):
        for hours, number in sizes:
            command = [tool, "temperature", *draw.sample(flights[hours, kind], number), "-m", MODEL]
            command += ["-o", folder / "out.toml", "--quiet"]
            found[hours, number].append(run(command + (["--archived"] if kind == "archived" else [])))
    return found


def show(found, samples, targets):
    """Prints the times of the sizes and checks the exponent."""
    print(f"  {'':<24}{'samples':>9}{'wall s (min, max)':>24}{'processor s':>13}{'s / 1e6':>13}{'ratio':>7}")
    before = None
    for (hours, number), times in found.items():
        wall = [each.wall for each in times]
        processor = [each.processor for each in times]
        count = number * samples[hours]
        spread = f"{mean(wall):.2f} ({min(wall):.2f}, {max(wall):.2f})"
        ratio = f"{mean(processor) / before:7.2f}" if before else ""
        print(f"  {f'{number} flights of {hours:g} h':<24}{count:>9}{spread:>24}{mean(processor):13.2f}"
              f"{1e6 * mean(processor) / count:13.2f}{ratio}")
        before = mean(processor)
    counts = [number * samples[hours] for hours, number in found]
    means = [mean([each.processor for each in times]) for times in found.values()]
    exponent = math.log(means[-1] / means[0]) / math.log(counts[-1] / counts[0])
    targets.check("exponent of processor time", exponent, exponent <= MAX_EXPONENT, f"at most {MAX_EXPONENT}")


def main():
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:CORES])
    tool = (pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build/benchmark") / "tools/pcor"
    targets = Targets()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        flights = simulate(tool, folder)
        samples = {hours: records(flights[hours, "recorded"][0]) for hours in AVAILABLE}
        by_number = [(5.0, number) for number in NUMBERS]
        by_length = [(hours, FEW) for hours in LENGTHS]
        print(f"{CORES} cores, load {os.getloadavg()[0]:.1f}, {SETS} sets of each size")
        for kind in ["recorded", "archived"]:
            found = measure(tool, folder, kind, flights, sorted({*by_number, *by_length}))
            print(f"\n{kind}, by number of flights")
            show({size: found[size] for size in by_number}, samples, targets)
            slowest = max(each.processor for each in found[by_number[-1]])
            targets.check("processor seconds of the slowest set of 20", slowest, slowest <= MAX_SECONDS,
                          f"at most {MAX_SECONDS}")
            print(f"\n{kind}, by length of flight")
            show({size: found[size] for size in by_length}, samples, targets)
    return 1 if targets.missed else 0


if __name__ == "__main__":
    sys.exit(main())
