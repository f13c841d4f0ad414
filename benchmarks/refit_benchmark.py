#!/usr/bin/python3
"""Compares the run time of the refit of equation 20 with least_squares of scipy and lstsq of numpy on the same arrays.

    benchmarks/refit_benchmark.py [BUILD_FOLDER] [MAX_SAMPLES]        defaults build/benchmark and 10,000,000

The programs alternate, each with one thread, so that other load on the machine affects all. Ratios are ratios of medians.

The time of pcor is the time of the whole `refit`, with masks, noise, standard errors, contributions of the effects and
statistics. The time of the others is that of the solution; the derivatives are precomputed as a matrix. least_squares
gets this matrix as its jacobian, and the noise scale of pcor. The faster of its solvers "exact" and "lsmr" is used, from
the start of pcor, zero, and from the solution of lstsq. The ratios depend on the BLAS of numpy, so another python3 may
give other ratios.

Memory is the peak memory of pcor with the samples. Exit status 1 if a target is missed.
"""

import os

for name in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"]:
    os.environ[name] = "1"

import json
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy
import scipy
import scipy.optimize

from measure import ROOT, Targets, median

RUNS = {10_000: 15, 100_000: 9, 1_000_000: 5, 10_000_000: 3}
LEAST_SQUARES_RUNS = {10_000: 15, 100_000: 5, 1_000_000: 3, 10_000_000: 1}
NAMES = ["static-constant.a0", "static-qp.a2", "static-mach.m1", "static-mach2.m2", "static-mach3.m3"]

COMPARED_SAMPLES = 1_000_000
MIN_RATIOS = {"lstsq": 1.0, "zero": 8.0}  # time of least_squares / time of pcor by start, at COMPARED_SAMPLES
EXPONENTS = (0.9, 1.1)  # range of the exponent of time as a power of the number of samples
MAX_GROWTH = 12.0  # ratio of times for ten times the samples, between the two largest numbers of samples
MAX_MEMORY = 1024.0  # MiB, at the largest number of samples
MAX_DIFFERENCE = 0.5  # difference of coefficients from least_squares, in standard errors


def seconds(times):
    return f"{median(times):9.4f} s ({min(times):.4f} to {max(times):.4f})"


def timed(function):
    begin = time.perf_counter()
    result = function()
    return result, time.perf_counter() - begin


def derivatives(folder):
    """Matrix of equation 20, hPa per unit of each coefficient, and delta-p of the reference, hPa."""
    p, q, mach, reference = [
        numpy.fromfile(folder / f"{name}.f8")
        for name in ["static_pressure", "dynamic_pressure", "mach", "reference"]
    ]
    matrix = numpy.empty((len(p), len(NAMES)))
    for column, values in enumerate([p, q, p * mach, p * mach**2, p * mach**3]):
        matrix[:, column] = values
    return matrix, reference - p


def robust(matrix, delta_p, start, scale, solver):
    result = scipy.optimize.least_squares(
        lambda x: matrix @ x - delta_p,
        start,
        jac=lambda x: matrix.copy(),  # least_squares changes the matrix in place
        method="trf",
        loss="huber",
        f_scale=scale,
        x_scale="jac",
        tr_solver=solver,
    )
    if not result.success:
        sys.exit(f"least_squares failed: {result.message}")
    return result.x


def measure(program, samples, folder):
    """Times of all programs, s, the JSON of pcor, and the solution of least_squares."""
    found = {}
    matrix = None
    for run in range(RUNS[samples]):
        command = [program, str(samples), "--threads", "1"]
        if matrix is None:
            command += ["--write", folder]
        fit = json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)
        found.setdefault("pcor", []).append(fit["seconds"])
        if matrix is None:
            matrix, delta_p = derivatives(folder)
        solution, taken = timed(lambda: numpy.linalg.lstsq(matrix, delta_p, rcond=None)[0])
        found.setdefault("lstsq", []).append(taken)
        if run >= LEAST_SQUARES_RUNS[samples]:
            continue
        for begin, start in [("lstsq", solution), ("zero", numpy.zeros(len(NAMES)))]:
            if begin == "zero" and samples > COMPARED_SAMPLES:
                continue
            for solver in ["exact", "lsmr"]:
                other, taken = timed(lambda: robust(matrix, delta_p, start, 4.0 * fit["deviation"], solver))
                found.setdefault(f"least_squares {solver} from {begin}", []).append(taken)
                if (begin, solver) == ("lstsq", "exact"):
                    exact = other
    return found, fit, exact


def main():
    build = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build/benchmark"
    max_samples = int(sys.argv[2]) if len(sys.argv) > 2 else max(RUNS)
    program = build / "benchmarks/refit_flight"
    print(f"numpy {numpy.__version__}, scipy {scipy.__version__}, one thread each, "
          f"load {os.getloadavg()[0]:.1f}")
    targets = Targets()
    times = {}
    for samples in [n for n in RUNS if n <= max_samples]:
        with tempfile.TemporaryDirectory() as folder:
            found, fit, other = measure(program, samples, pathlib.Path(folder))
        times[samples] = median(found["pcor"])
        print(f"\n{samples} samples, {fit['flights']} flights, {fit['passes']} passes, "
              f"{fit['memory']:.0f} MiB")
        for name, values in found.items():
            print(f"  {name:<30}{seconds(values)}")
        difference = 0.0
        for name, value in zip(NAMES, other):
            own, error = fit["parameters"][name]
            difference = max(difference, abs(own - value) / error)
            print(f"  {name:<20} {own:+.6f} +- {error:.6f}, least_squares {value:+.6f}, "
                  f"relative difference {abs(own / value - 1.0):.1e}")
        targets.check("largest difference, in standard errors", difference, difference < MAX_DIFFERENCE,
                      f"below {MAX_DIFFERENCE}")
        print(f"  {'time of lstsq / pcor':<46} {median(found['lstsq']) / times[samples]:8.3g}")
        for start in ["lstsq", "zero"]:
            best = min((median(values) for name, values in found.items() if name.endswith(f" from {start}")),
                       default=None)
            if best is None:
                continue
            text = f"time of least_squares from {start} / pcor"
            if samples == COMPARED_SAMPLES:
                targets.check(text, best / times[samples], best / times[samples] >= MIN_RATIOS[start],
                              f"at least {MIN_RATIOS[start]}")
            else:
                print(f"  {text:<46} {best / times[samples]:8.3g}")

    print("\ntime of pcor as a function of the number of samples")
    counts = sorted(times)
    if len(counts) > 1:
        exponent = numpy.polyfit(numpy.log(counts), numpy.log([times[n] for n in counts]), 1)[0]
        targets.check("exponent", exponent, EXPONENTS[0] <= exponent <= EXPONENTS[1],
                      f"{EXPONENTS[0]} to {EXPONENTS[1]}")
        growth = times[counts[-1]] / times[counts[-2]]
        targets.check(f"time at {counts[-1]} / at {counts[-2]}", growth, growth < MAX_GROWTH, f"below {MAX_GROWTH}")
    targets.check(f"memory at {counts[-1]}, MiB", fit["memory"], fit["memory"] < MAX_MEMORY, f"below {MAX_MEMORY}")
    return 1 if targets.missed else 0


if __name__ == "__main__":
    sys.exit(main())
