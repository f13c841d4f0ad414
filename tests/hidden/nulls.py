#!/usr/bin/python3
"""Null cases: flights without hidden effects. Counts wrong claims of `pcor diagnose`.

    nulls.py TOOL --cases 200 --seed 1

A case has two flights of about two hours. Half of the cases have noise with a short memory, half 1/f noise. Troubles
alternate: an instrument drifts, freezes or has bursts, the model starts with wrong coefficients, or all together
(instruments.py). The model is refitted and diagnosed. A named effect is a wrong claim, and so is a variable to which
structure is traced. Structure without a cause is not a wrong claim, because slow noise is structure.
"""

import argparse
import multiprocessing
import os
import random
import shutil
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(variable, "1")  # --jobs already uses the cores

import instruments  # noqa: E402
import plans  # noqa: E402
import scoring  # noqa: E402
from records import without_truth  # noqa: E402
from tool_runs import Tool, ToolError  # noqa: E402

TROUBLES = ("none", "drift of p", "drift of q", "frozen", "bursts", "wrong start", "all")
CLAIMS = ("named", "traced", "structure", "silent")


@dataclass(frozen=True)
class NullCase:
    number: int
    seed: int
    plan: plans.Plan
    noise: str
    trouble: str

    def __str__(self):
        return f"case {self.number} ({self.plan}, {self.noise}, {self.trouble})"


def null_case(seed, number):
    """Noises and troubles alternate, so that any 14 consecutive numbers contain all combinations."""
    noise = instruments.NOISES[number % 2]
    trouble = TROUBLES[(number // 2) % len(TROUBLES)]
    draw = random.Random(f"null {seed} {number}")
    plan = plans.Plan("GV" if draw.random() < 0.3 else "C-130", "long", 1000 * seed + number)
    return NullCase(number, seed, plan, noise, trouble)


def run_case(tool, case, references=(), kept=None):
    """Result of a case as a dictionary for JSON."""
    folder = Path(tempfile.mkdtemp(prefix="null-"))
    draw = random.Random(f"{case} {case.seed}")
    pair = (plans.STATIC[case.plan.aircraft], "QCF")
    troubles = {case.trouble} if case.trouble != "all" else set(draw.sample(TROUBLES[1:5], 3))
    facts = {"case": str(case), "noise": case.noise, "trouble": case.trouble, "told": []}
    try:
        flights = []
        for part in (0, 1):
            flight, scenario = folder / f"flight{part}.nc", folder / "scenario.toml"
            scenario.write_text(plans.scenario_text(case.plan, part, 10 * case.number + part))
            tool.run("simulate", scenario, "-o", flight, "--quiet")
            facts["told"] += instruments.record(flight, pair, case.noise, troubles, [case.seed, case.number, part])
            without_truth(flight, None)
            flights.append(flight)
        user, fitted = folder / "user.toml", folder / "fitted.toml"
        start = draw.choice(list(plans.STARTS)[1:]) if case.trouble in ("wrong start", "all") else "right"
        user.write_text(plans.model_text(case.plan.aircraft, start=start))
        facts["told"].append(f"initial coefficients {start}")
        fit = tool.json_of("refit", *flights, "-m", user, "-o", fitted, *references)
        diagnosis = tool.json_of("diagnose", *flights, "-m", fitted, *references)
        facts |= {"rms_hpa": fit["rms_hpa"], "verdict": scoring.verdict_of(diagnosis),
                  "claim": claim_of(diagnosis), "summary": scoring.summary_of(diagnosis)}
    except (ToolError, OSError, ValueError, KeyError) as error:
        facts |= {"claim": "error", "verdict": f"{type(error).__name__}: {error}"}
    if kept and facts["claim"] in ("named", "traced", "error"):
        shutil.copytree(folder, Path(kept) / f"{case.seed}-{case.number}", dirs_exist_ok=True)
    shutil.rmtree(folder)
    return facts


def claim_of(diagnosis):
    if diagnosis["findings"]:
        return "named"
    if scoring.traced_in(diagnosis):
        return "traced"
    return "silent" if scoring.verdict_of(diagnosis) == "silent" else "structure"


def table_of(found):
    lines = [f"{'noise':<8}{'trouble':<14}{'cases':>6}" + "".join(f"{claim:>11}" for claim in (*CLAIMS, "error"))]
    kinds = sorted({(facts["noise"], facts["trouble"]) for facts in found},
                   key=lambda key: (key[0], TROUBLES.index(key[1])))
    for noise, trouble in [*kinds, ("all", "")]:
        some = [facts for facts in found if noise == "all" or (facts["noise"], facts["trouble"]) == (noise, trouble)]
        counts = [sum(facts["claim"] == claim for facts in some) for claim in (*CLAIMS, "error")]
        lines.append(f"{noise:<8}{trouble:<14}{len(some):>6}" + "".join(f"{count:>11}" for count in counts))
    return "\n".join(lines)


def run_numbered(arguments):
    return run_case(*arguments)


def main():
    parser = argparse.ArgumentParser(prog="nulls.py", description=__doc__.split("\n")[0],
                                     formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    parser.add_argument("tool", help="the program pcor")
    parser.add_argument("--cases", type=int, default=200, metavar="N")
    parser.add_argument("--first", type=int, default=0, metavar="K", help="number of the first case")
    parser.add_argument("--seed", type=int, default=1, metavar="S", help="another seed simulates other flights")
    parser.add_argument("--reference", action="append", default=[], metavar="REF", help="reference, see pcor compare --help")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="parallel processes")
    parser.add_argument("--keep", metavar="FOLDER", help="folder for the files of cases with a wrong claim or an error")
    options = parser.parse_args()
    tool = Tool(options.tool)
    references = [word for reference in options.reference for word in ("--reference", reference)]
    selected = [(tool, null_case(options.seed, number), references, options.keep)
                for number in range(options.first, options.first + options.cases)]
    found = []
    with multiprocessing.Pool(options.jobs) as pool:
        for facts in pool.imap(run_numbered, selected):
            found.append(facts)
            if facts["claim"] in ("named", "traced", "error"):
                print(f"{facts['case']}: {facts['verdict']} {facts.get('summary', '')}; {'; '.join(facts['told'])}",
                      flush=True)
    print(table_of(found))
    wrong = sum(facts["claim"] in ("named", "traced") for facts in found)
    print(f"{sum(facts['claim'] == 'named' for facts in found)} of {len(found)} named, {wrong} with a wrong claim")
    return 1 if any(facts["claim"] == "error" for facts in found) else 0


if __name__ == "__main__":
    sys.exit(main())
