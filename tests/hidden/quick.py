"""The part of the suite that is a test: few cases, and thresholds that a working tool passes with a wide margin."""

import plans
import worlds
from cases import Case

SEED = 500
STRONG = (("static-lag", 2.0), ("load-factor", 2.0), ("static-beta-odd", 2.0), ("clock-skew", 2.0),
          ("static-alpha-quad", 2.0))


def wanted():
    nulls = worlds.null_cases(SEED, 20, 0)
    flown = plans.Plan("C-130", "manoeuvres", SEED)
    steady = plans.Plan("C-130", "steady", SEED + 1)
    strong = [Case("single", name, flown, "A", SEED, snr, (name,), improve=False) for name, snr in STRONG]
    unclear = Case("single", "lams-scale", steady, "A", SEED + 1, 1.0, ("lams-scale",), improve=False)
    torque = "unknown ENGTRQ sine (static)"
    return nulls + strong + [unclear, Case("outside", torque, flown, "A", SEED, 2.0, (torque,), improve=False)]


def check(setting, jobs, run_all):
    """Prints what failed; the exit status."""
    setting.improve = False
    cases = run_all(setting, wanted(), jobs)
    failures = [f"{case['name']}: {case['error']}" for case in cases if "error" in case]
    if not setting.diagnose:
        return report(failures, cases)
    cases = [case for case in cases if "score" in case]
    claims = [case for case in cases if case["kind"] == "null" and case["score"]["named"]]
    if len(claims) > 1:
        failures.append(f"{len(claims)} of 20 null flights have a name, at most 1 may: "
                        f"{[case['diagnosis']['findings'] for case in claims]}")
    for case in cases:
        said = f"{case['name']}, hidden {case.get('hidden')}: {case['diagnosis']}"
        if case["kind"] == "single" and case["plan_kind"] == "manoeuvres" and not case["score"]["in_set"]:
            failures.append("not found: " + said)
        if case["plan_kind"] == "steady" and case["score"]["verdict"] not in ("silent", "cannot be told apart"):
            failures.append("too sure without manoeuvres: " + said)
        if case["kind"] == "outside" and not case["score"]["traced_among_five"]:
            failures.append("not traced: " + said)
    return report(failures, cases)


def report(failures, cases):
    for failure in failures:
        print("FAILED " + failure)
    print(f"{len(cases)} cases, {len(failures)} failures")
    return 1 if failures else 0
