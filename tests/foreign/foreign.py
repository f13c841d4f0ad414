#!/usr/bin/python3
"""Flights by another simulator than the project's, and what its judge says of the tool there.

    foreign.py TOOL [--share K/N] [--salt X]

The environment variable PCOR_FOREIGN names the folder of that simulator, with simulate.py and judge.py; without it
nothing is run, and the exit status is 77. The judge runs refit, diagnose, improve and process as a user would, and
knows the truth. Fails where fewer cases are right than the wanted rates let expect.
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
CHANCE = 1e-3  # that a tool which has a wanted rate fails by luck with the flights
VISIBLE = 0.1  # SNR
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
    """The judge's results, case by case, on the flights of a salt, which are made where they are not in `folder`."""
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
    """Cases by requirement: question, required rate, and selection."""
    hard = [case for case in cases if case["id"].startswith(OUTSIDE)]
    known = [case for case in cases if case["effects"] and not case["id"].startswith(("poor", *OUTSIDE))
             and min(case["snr"]) >= VISIBLE]
    single, pairs = ([case for case in known if len(case["effects"]) == number] for number in (1, 2))
    null = [case for case in cases if not case["effects"]]

    def both(case):
        return case.get("in_set") and case.get("nothing_else")

    return [
        ("one effect: truth in a named set", single, 0.99, lambda case: case.get("in_set")),
        ("one effect: nothing else named", single, 0.97, lambda case: case.get("nothing_else")),
        ("one effect: both", single, 0.96, both),
        ("two effects: both in sets", pairs, 1.0, lambda case: case.get("in_set")),
        ("two effects: and nothing else", pairs, 0.90, both),
        ("null flights without a name", null, 1.0, lambda case: case.get("false_alarm") is False),
        ("outside the catalogue, flagged", hard, 48 / 54, lambda case: case["identified"]),
        ("static pressure not made worse", cases, 1.0, lambda case: not case.get("harm")),
        ("no crash, no refusal", cases, 1.0, lambda case: "error" not in case),
    ]


def most_failures(count, rate, chance=CHANCE):
    """The largest number of failures among `count` cases compatible with a rate of success: P(more) < chance."""
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
    """Static error after `improve` over that before, of static effects of SNR 0.8: the median."""
    return median([case["err_best"] / case["err_base"] for case in cases
                   if "error" not in case and case["id"].startswith("static") and case["id"].endswith(".0.8")])


def tables(tool, folder, salts, jobs=2):
    """Markdown of all flights of the given salts; None if the simulator is absent."""
    simulator = folder_of_simulator()
    if simulator is None:
        return None
    cases = [judged(tool, simulator, folder, salt, jobs=jobs) for salt in salts]
    lines = [f"| what | wanted | {' | '.join(f'salt {salt}' for salt in salts)} |", "|---|---|" + "---|" * len(salts)]
    for rows in zip(*map(groups, cases)):
        what, _, rate, _ = rows[0]
        counts = [f"{sum(map(bool, map(right, some)))} of {len(some)}" for _, some, _, right in rows]
        lines.append(f"| {what} | {100 * rate:.0f} % | {' | '.join(counts)} |")
    lines.append("| one effect: mean size of the set | 1.6 | " + " | ".join(f"{mean_set(some):.2f}" for some in cases) +
                 " |")
    lines.append("| static effects, SNR 0.8: static error after over before, median | 0.2 | " +
                 " | ".join(f"{error_ratio(some):.2f}" for some in cases) + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(prog="foreign.py", description=__doc__.split("\n")[0])
    parser.add_argument("tool", help="the program pcor")
    parser.add_argument("--share", default="3/10", metavar="K/N", help="the K-th of N shares of the cases")
    parser.add_argument("--salt", default="x", help="salt of the simulator: another value simulates other flights")
    parser.add_argument("--jobs", type=int, default=2, metavar="N")
    options = parser.parse_args()
    simulator = folder_of_simulator()
    if simulator is None:
        print("skipped: PCOR_FOREIGN names no folder with simulate.py and judge.py")
        return SKIPPED
    with tempfile.TemporaryDirectory(prefix="foreign-") as folder:
        cases = judged(Path(options.tool).resolve(), simulator, folder, options.salt, options.share, options.jobs)
    failed = False
    for what, some, rate, right in groups(cases):
        wrong = [case for case in some if not right(case)]
        allowed = most_failures(len(some), rate)
        failed = failed or len(wrong) > allowed
        print(f"{'FAILED ' if len(wrong) > allowed else ''}{what}: {len(some) - len(wrong)} of {len(some)}, at most "
              f"{allowed} may fail")
        for case in wrong:
            print(f"    {case['id']}: {case.get('error') or case['found']}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
