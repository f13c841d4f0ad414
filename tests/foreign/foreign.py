#!/usr/bin/python3
"""Tests the tool on flights of an independent simulator, with the scores of its judge.

    foreign.py TOOL [--share K/N] [--salt X]

The environment variable PCOR_FOREIGN names the folder of the simulator, with simulate.py and judge.py; without it the exit
status is 77. The judge runs refit, diagnose, improve and process and compares their results with the truth. The test fails
if the number of correct cases is significantly below the required rate.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

SKIPPED = 77  # exit status of a test that cannot run here
CHANCE = 1e-3  # probability that a tool with the required rate fails by chance
VISIBLE = 0.1  # min SNR of a visible effect
OUTSIDE = ("unknown", "recorded")


def folder_of_simulator():
    named = os.environ.get("PCOR_FOREIGN")
    return Path(named) if named and (Path(named) / "simulate.py").exists() else None


def run(simulator, program, *arguments, **environment):
    words = [sys.executable, str(simulator / program), *map(str, arguments)]
    result = subprocess.run(words, capture_output=True, text=True, env={**os.environ, **environment})
    if result.returncode != 0:
        raise RuntimeError(f"{program}: exit status {result.returncode}: {result.stderr.strip()[-500:]}")
    return result.stdout


def judged(tool, simulator, folder, salt, share="0/1", jobs=2):
    """Scores of the judge for each case of a salt. Simulates flights that are not in `folder`."""
    suite = Path(folder) / f"foreign-{salt}-{share.replace('/', '-of-')}"
    made = suite / "made"
    if not made.exists():
        number, parts = map(int, share.split("/"))
        shares = [f"{number + parts * job}/{parts * jobs}" for job in range(jobs)]
        running = [subprocess.Popen([sys.executable, str(simulator / "simulate.py"), "suite", str(suite), each],
                                    env={**os.environ, "SALT": salt}) for each in shares]
        if any([process.wait() for process in running]):
            raise RuntimeError(f"simulate.py: the suite of salt {salt} was not made")
        made.touch()
    with tempfile.TemporaryDirectory() as made_here:
        answer = Path(made_here) / "judged.json"
        run(simulator, "judge.py", tool, suite, "--json", answer, "-j", jobs)
        return json.loads(answer.read_text())


def groups(cases):
    """Requirements: text, cases, required rate, and test of a case."""
    hard = [case for case in cases if case["id"].startswith(OUTSIDE)]
    known = [case for case in cases if case["effects"] and not case["id"].startswith(("poor", *OUTSIDE))
             and min(case["snr"]) >= VISIBLE]
    single, pairs = ([case for case in known if len(case["effects"]) == number] for number in (1, 2))
    null = [case for case in cases if not case["effects"]]

    def both(case):
        return case.get("in_set") and case.get("nothing_else")

    return [
        ("one effect: truth in a named set", single, 0.99, lambda case: case.get("in_set")),
        ("one effect: no other effect named", single, 0.97, lambda case: case.get("nothing_else")),
        ("one effect: both", single, 0.96, both),
        ("two effects: both in sets", pairs, 1.0, lambda case: case.get("in_set")),
        ("two effects: both in sets, no other effect named", pairs, 0.90, both),
        ("null cases: no effect named", null, 1.0, lambda case: case.get("false_alarm") is False),
        ("outside the catalogue: flagged", hard, 48 / 54, lambda case: case["identified"]),
        ("static error not increased", cases, 1.0, lambda case: not case.get("harm")),
        ("no error of the tool", cases, 1.0, lambda case: "error" not in case),
    ]


def max_failures(count, rate, chance=CHANCE):
    """Smallest number of failures in `count` cases for which P(more failures) < chance at the given rate of success."""
    more = 1.0
    for failures in range(count + 1):
        more -= math.comb(count, failures) * (1 - rate) ** failures * rate ** (count - failures)
        if more < chance:
            return failures
    return count


def mean_set(cases):
    single = groups(cases)[0][1]
    sizes = [len(names) for case in single for names in case.get("found", [])]
    return sum(sizes) / len(sizes) if sizes else 0.0


def median(values):
    values = sorted(values)
    return (values[(len(values) - 1) // 2] + values[len(values) // 2]) / 2 if values else math.nan


def error_ratio(cases):
    """Median ratio of the static error after and before `improve`, for static effects with SNR 0.8."""
    return median([case["err_best"] / case["err_base"] for case in cases
                   if "error" not in case and case["id"].startswith("static") and case["id"].endswith(".0.8")])


def tables(tool, folder, salts, jobs=2):
    """Table of the given salts as Markdown; None without the simulator."""
    simulator = folder_of_simulator()
    if simulator is None:
        return None
    cases = [judged(tool, simulator, folder, salt, jobs=jobs) for salt in salts]
    lines = [f"| quantity | target | {' | '.join(f'salt {salt}' for salt in salts)} |", "|---|---|" + "---|" * len(salts)]
    for rows in zip(*map(groups, cases)):
        text, _, rate, _ = rows[0]
        counts = [f"{sum(map(bool, map(right, some)))} of {len(some)}" for _, some, _, right in rows]
        lines.append(f"| {text} | {100 * rate:.0f} % | {' | '.join(counts)} |")
    lines.append("| one effect: mean size of the set | 1.6 | " + " | ".join(f"{mean_set(some):.2f}" for some in cases) +
                 " |")
    lines.append("| static effects, SNR 0.8: static error after / before, median | 0.2 | " +
                 " | ".join(f"{error_ratio(some):.2f}" for some in cases) + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(prog="foreign.py", description=__doc__.split("\n")[0])
    parser.add_argument("tool", help="the program pcor")
    parser.add_argument("--share", default="3/10", metavar="K/N", help="share K of N shares of the cases")
    parser.add_argument("--salt", default="x", help="salt of the simulator: another value simulates other flights")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="parallel processes")
    options = parser.parse_args()
    simulator = folder_of_simulator()
    if simulator is None:
        print("skipped: PCOR_FOREIGN names no folder with simulate.py and judge.py")
        return SKIPPED
    with tempfile.TemporaryDirectory(prefix="foreign-") as folder:
        cases = judged(Path(options.tool).resolve(), simulator, folder, options.salt, options.share, options.jobs)
    failed = False
    for text, some, rate, right in groups(cases):
        wrong = [case for case in some if not right(case)]
        allowed = max_failures(len(some), rate)
        failed = failed or len(wrong) > allowed
        print(f"{'FAILED ' if len(wrong) > allowed else ''}{text}: {len(some) - len(wrong)} of {len(some)}, at most "
              f"{allowed} may fail")
        for case in wrong:
            print(f"    {case['id']}: {case.get('error') or case['found']}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
