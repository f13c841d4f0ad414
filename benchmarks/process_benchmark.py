#!/usr/bin/env python3
"""Compares the run time of `pcor process` with nccopy on a flight of 5 hours at 25 Hz.

    benchmarks/process_benchmark.py [BUILD_FOLDER]        default build/benchmark

The two commands alternate, so that other load on the machine affects both. The ratio of the medians is compared with
its target. Peak memory for 5 hours is compared with that for 1 hour; it should be nearly equal (1 hour is slightly
less than one block of records). Exit status 1 if a target is missed.
"""

import pathlib
import sys
import tempfile

from measure import ROOT, Targets, median, run

MODEL = ROOT / "benchmarks/process/model.toml"
MAX_RATIO = 1.2
MAX_MEMORY_RATIO = 1.15


def measure(build, kind, runs, folder):
    """Usage of nccopy and of `pcor process` on one flight of 5 hours, one Usage per run."""
    path = folder / f"{kind}-5.nc"
    run([build / "benchmarks/make_flight", kind, "5", path])
    copying, processing = [], []
    for _ in range(runs):
        copying.append(run(["nccopy", path, folder / "copy.nc"]))
        processing.append(run(process(build, path)))
    return copying, processing


def process(build, path):
    output = path.with_name("out.nc")
    return [build / "tools/pcor", "process", "--quiet", "--model", MODEL, "--output", output, path]


def main():
    build = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build/benchmark"
    targets = Targets()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for kind in ["classic", "netcdf4"]:
            copying, processing = measure(build, kind, 9, folder)
            short = folder / f"{kind}-1.nc"
            run([build / "benchmarks/make_flight", kind, "1", short])
            memory = median(each.memory for each in processing)
            growth = memory / median(run(process(build, short)).memory for _ in range(3))
            print(f"{kind}, {(folder / f'{kind}-5.nc').stat().st_size / 1e6:.0f} MB")
            for name, usages in [("nccopy", copying), ("pcor process", processing)]:
                walls = [each.wall for each in usages]
                print(f"  {name:<14} {median(walls):.3f} s ({min(walls):.3f} to {max(walls):.3f})")
            ratio = median(each.wall for each in processing) / median(each.wall for each in copying)
            targets.check("pcor process / nccopy", ratio, ratio <= MAX_RATIO, f"at most {MAX_RATIO}")
            targets.check(f"memory, {memory:.0f} MiB / that for 1 hour", growth, growth <= MAX_MEMORY_RATIO,
                          f"at most {MAX_MEMORY_RATIO}")
    return 1 if targets.missed else 0


if __name__ == "__main__":
    sys.exit(main())
