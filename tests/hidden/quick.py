"""The part of the suite that is a test: few cases, and thresholds that a working tool passes with a wide margin."""

import plans
import worlds
from cases import Case

SEED = 500
STRONG = (("static-lag", 4.0), ("load-factor", 2.0), ("static-beta-odd", 3.0), ("clock-skew", 3.0),
          ("static-alpha-quad", 4.0))


def wanted():
    flown = plans.Plan("C-130", "manoeuvres", SEED)
    steady = plans.Plan("C-130", "steady", SEED + 1)
    strong = [Case("single", name, flown, seed=SEED, secrets=(name,), times=times, improve=False)
              for name, times in STRONG]
    unclear = Case("single", "lams-scale", steady, seed=SEED + 1, secrets=("lams-scale",), times=3.0, improve=False)
    torque = "unknown ENGTRQ sine (static)"
    outside = Case("outside", torque, flown, seed=SEED, secrets=(torque,), times=2.0, improve=False)
    return [*worlds.null_cases(SEED, 14), *strong, unclear, outside]


def check(setting, jobs, run_all):
    """Prints what failed; the exit status."""
    setting.improve = False
    cases = run_all(setting, wanted(), jobs)
    failures = [f"{case['name']}: {case['error']}" for case in cases if "error" in case]
    if not setting.diagnose:
        return report(failures, cases)
    claims = [case for case in cases if case["kind"] == "null" and case.get("claim") == "named"]
    if len(claims) > 1:
        failures.append(f"{len(claims)} of 14 null flights have a name, at most 1 may: "
                        f"{[case['summary']['findings'] for case in claims]}")
    for case in cases:
        if "score" not in case:
            continue
        said = f"{case['name']}, hidden {case['hidden']}: {case['diagnosis']}"
        if case["kind"] == "single" and case["plan_kind"] == "manoeuvres" and not case["score"]["in_set"]:
            failures.append("not found: " + said)
        if case["plan_kind"] == "steady" and case["score"]["verdict"] == "identified":
            failures.append("too sure without manoeuvres: " + said)
        if case["kind"] == "outside" and not case["score"]["traced_among_five"]:
            failures.append("not traced: " + said)
    return report(failures, cases)


def report(failures, cases):
    for failure in failures:
        print("FAILED " + failure)
    print(f"{len(cases)} cases, {len(failures)} failures")
    return 1 if failures else 0
