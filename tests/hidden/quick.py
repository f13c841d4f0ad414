"""Quick part of the suite, used as a test: a few cases, with thresholds that a working tool passes by a wide margin. The long
tests set PCOR_EVERY_CASE for more cases.
"""

import os

import plans
import worlds
from cases import Case

SEED = 500
STRONG = (("static-lag", 4.0), ("load-factor", 2.0), ("static-beta-odd", 3.0), ("clock-skew", 3.0),
          ("static-alpha-quad", 4.0))
EVERY = bool(os.environ.get("PCOR_EVERY_CASE"))
NULLS = 14 if EVERY else 5


def selected_cases():
    flown = plans.Plan("C-130", "manoeuvres", SEED)
    steady = plans.Plan("C-130", "steady", SEED + 1)
    strong = [Case("single", name, flown, seed=SEED, secrets=(name,), times=times, improve=False)
              for name, times in (STRONG if EVERY else STRONG[:2])]
    unclear = Case("single", "lams-scale", steady, seed=SEED + 1, secrets=("lams-scale",), times=3.0, improve=False)
    torque = "unknown ENGTRQ sine (static)"
    outside = Case("outside", torque, flown, seed=SEED, secrets=(torque,), times=2.0, improve=False)
    return [*worlds.null_cases(SEED, NULLS), *strong, unclear, outside]


def check(setting, jobs, run_all):
    """Runs the cases and prints failures; returns the exit status."""
    setting.improve = False
    cases = run_all(setting, selected_cases(), jobs)
    failures = [f"{case['name']}: {case['error']}" for case in cases if "error" in case]
    claims = [case for case in cases if case["kind"] == "null" and case.get("claim") == "named"]
    if len(claims) > 1:
        failures.append(f"an effect was named in {len(claims)} of {NULLS} null cases (at most 1 allowed): "
                        f"{[case['summary']['findings'] for case in claims]}")
    for case in cases:
        if "score" not in case:
            continue
        description = f"{case['name']}, hidden {case['hidden']}: {case['diagnosis']}"
        if case["kind"] == "single" and case["plan_kind"] == "manoeuvres" and not case["score"]["in_set"]:
            failures.append("not found: " + description)
        if case["plan_kind"] == "steady" and case["score"]["verdict"] == "identified":
            failures.append("identified without manoeuvres: " + description)
        if case["kind"] == "outside" and not case["score"]["traced_among_five"]:
            failures.append("not traced: " + description)
    return report(failures, cases)


def report(failures, cases):
    for failure in failures:
        print("FAILED " + failure)
    print(f"{len(cases)} cases, {len(failures)} failures")
    return 1 if failures else 0
