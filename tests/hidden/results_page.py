"""The results as Markdown: compared with the aims, by effect, and compared with an earlier program."""

import statistics

import nulls

VISIBLE = 0.1  # SNR from which on the laser's residual shows an effect; below it other references have to
HEAD = ("| hidden | cases | times usual | SNR | truth in set | nothing else | mean set | identified | silent | wrong | held "
        "out over noise | static error after/before |\n|---|---|---|---|---|---|---|---|---|---|---|---|")


def percent(values):
    values = [value for value in values if value is not None]
    return f"{100 * sum(map(bool, values)) / len(values):.1f} %" if values else "-"


def mean(values, digits=2):
    values = [value for value in values if value is not None]
    return f"{statistics.fmean(values):.{digits}f}" if values else "-"


def quantile(values, part):
    values = sorted(values)
    if not values:
        return None
    place = part * (len(values) - 1)
    low = int(place)
    high = min(low + 1, len(values) - 1)
    return values[low] + (place - low) * (values[high] - values[low])


def median_of(values, digits=2):
    middle = quantile([value for value in values if value is not None], 0.5)
    return "-" if middle is None else f"{middle:.{digits}f}"


def scored(cases, key):
    return [case["score"].get(key) for case in cases if "score" in case]


def numbers(cases, key):
    return [case[key] for case in cases if case.get(key) is not None]


def growth(case):
    """The static error after `improve` over that before."""
    if case.get("static_after") is None or not case.get("static_before"):
        return None
    return case["static_after"] / case["static_before"]


def made_worse(case):
    """By more than rounding and luck with the noise do: 2 % and 0.02 hPa."""
    if growth(case) is None:
        return None
    return case["static_after"] > max(1.02 * case["static_before"], case["static_before"] + 0.02)


def span(values):
    low, high = min(values), max(values)
    return f"{low:.2g}" if high < 1.05 * low + 1e-9 else f"{low:.2g} to {high:.2g}"


def effect_table(cases):
    lines = [HEAD]
    for name in dict.fromkeys(case["name"] for case in cases):
        of_name = [case for case in cases if case["name"] == name]
        for shown in (True, False):
            some = [case for case in of_name if is_visible(case) == shown]
            if not some:
                continue
            times = [hidden["times_usual"] for case in some for hidden in case["hidden"]]
            words = [name, str(len(some)), span(times), span([case["snr"] for case in some]),
                     percent(scored(some, "in_set")), percent(scored(some, "nothing_else")), mean(scored(some, "size")),
                     percent(scored(some, "identified")), percent(scored(some, "silent")),
                     percent(scored(some, "wrong")), median_of(numbers(some, "held_out_after"), 4),
                     median_of(map(growth, some))]
            lines.append("| " + " | ".join(words) + " |")
    return "\n".join(lines)


def outside_table(cases):
    lines = ["| hidden | cases | SNR | called identified | any name | noticed | traced first | traced among five | "
             "held out over noise |", "|---|---|---|---|---|---|---|---|---|"]
    for name in dict.fromkeys(case["name"] for case in cases):
        some = [case for case in cases if case["name"] == name]
        words = [name, str(len(some)), span([case["snr"] for case in some]), percent(scored(some, "identified")),
                 percent(scored(some, "claims")), percent(scored(some, "noticed")), percent(scored(some, "traced")),
                 percent(scored(some, "traced_among_five")), median_of(numbers(some, "held_out_after"), 4)]
        lines.append("| " + " | ".join(words) + " |")
    return "\n".join(lines)


def is_visible(case):
    return case["snr"] >= VISIBLE


def of_kind(cases, kind):
    return [case for case in cases if case["kind"] == kind and "error" not in case]


def targets(cases):
    """Rows of aims and results: description, number of cases, aim, result."""
    null = [case for case in of_kind(cases, "null") if case["claim"] != "error"]
    singles, pairs, outside = (of_kind(cases, kind) for kind in ("single", "pair", "outside"))
    seen = [case for case in singles if is_visible(case)]
    unseen = [case for case in singles if not is_visible(case)]
    flown = [case for case in seen if case["plan_kind"] != "steady"]
    large = [case for case in seen if case["hidden"][0]["times_usual"] >= 9]
    wrong_start = [case for case in seen if case["start"] != "right"]
    seen_pairs = [case for case in pairs if is_visible(case)]
    seen_outside = [case for case in outside if is_visible(case)]
    two = of_kind(cases, "two systems")
    own = [case for case in two if "the other" not in case["name"] and is_visible(case)]
    other = [case for case in two if "the other" in case["name"]]
    beside = of_kind(cases, "other")
    static = [growth(case) for case in flown if case["static"] and case["snr"] >= 0.8]
    every = [case for case in cases if "error" not in case and case["kind"] != "null"]
    times = numbers(every, "diagnose_seconds")

    def claims(*wanted):
        return percent([case["claim"] in wanted for case in null])

    return [
        ("one effect, SNR 0.1 and more: truth in a named set", len(seen), "99 %", percent(scored(seen, "in_set"))),
        ("same cases: no other effect named", len(seen), "97 %", percent(scored(seen, "nothing_else"))),
        ("the same: both", len(seen), "96 %", percent(scored(seen, "both"))),
        ("the same, mean size of the set", len(seen), "1.6", mean(scored(seen, "size"))),
        ("the same: silence", len(seen), "-", percent(scored(seen, "silent"))),
        ("the same, first in the set", len(seen), "-", percent(scored(seen, "first"))),
        ("the same, with manoeuvres: both", len(flown), "-", percent(scored(flown, "both"))),
        ("the same, 9 to 20 times the usual size: both", len(large), "-", percent(scored(large, "both"))),
        ("the same, from wrong coefficients: both", len(wrong_start), "-", percent(scored(wrong_start, "both"))),
        ("one effect that the laser does not show: truth in a named set", len(unseen), "-",
         percent(scored(unseen, "in_set"))),
        ("the same: another name, not called partial", len(unseen), "-", percent(scored(unseen, "wrong"))),
        ("two effects, SNR 0.1 and more: both in sets", len(seen_pairs), "100 %",
         percent(scored(seen_pairs, "in_set"))),
        ("same cases: no other effect named", len(seen_pairs), "90 %", percent(scored(seen_pairs, "both"))),
        ("fault of the other system, with a laser: own system blamed", len(beside), "0 %",
         percent(scored(beside, "own_blamed"))),
        ("two systems only, fault of the own: truth in a named set", len(own), "-", percent(scored(own, "in_set"))),
        ("the same: the other system is admitted", len(own), "100 %", percent(scored(own, "twin_told"))),
        ("two systems only, fault of the other: the own one blamed", len(other), "0 %",
         percent(scored(other, "own_blamed"))),
        ("two systems only: static pressure made worse", len(two), "0 %", percent(map(made_worse, two))),
        ("all cases: static pressure made worse (2 % and 0.02 hPa)", len(every), "0 %",
         percent(map(made_worse, every))),
        ("static effect, SNR 0.8 and more: static error after over before, median", len(static), "0.2",
         median_of(static)),
        ("held-out error over noise, one effect: median", len(seen), "-",
         median_of(numbers(seen, "held_out_after"), 4)),
        ("outside the catalogue, SNR 0.1 and more: flagged", len(seen_outside), "89 %",
         percent(scored(seen_outside, "noticed"))),
        ("the same: called identified", len(seen_outside), "1 %", percent(scored(seen_outside, "identified"))),
        ("the same, recorded: traced to its variable", len(seen_outside), "-",
         percent(scored(seen_outside, "traced"))),
        ("null flights: a name", len(null), "0.5 %", claims("named")),
        ("null flights: a name or a cause traced", len(null), "2 %", claims("named", "traced")),
        ("null flights: structure, no cause", len(null), "-", claims("structure")),
        ("diagnosis of two flights: median s (program started)", len(times), "2", median_of(times)),
        ("runs that failed", len(cases), "0", str(len(failed(cases)))),
    ]


def failed(cases):
    return [case for case in cases if "error" in case or case.get("claim") == "error"]


def target_table(cases, before):
    rows = targets(cases)
    lines = ["| what | cases | to reach | reached |", "|---|---|---|---|"]
    if before:
        words, told = before
        same = {case["label"] for case in cases}
        earlier = [case for case in told if case["label"] in same]
        lines = [f"| what | cases | to reach | reached | {words} |", "|---|---|---|---|---|"]
        return "\n".join(lines + [f"| {what} | {count} | {aim} | {found} | {once} |"
                                  for (what, count, aim, found), (_, _, _, once) in zip(rows, targets(earlier))])
    return "\n".join(lines + [f"| {what} | {count} | {aim} | {found} |" for what, count, aim, found in rows])


def page(cases, told, before=None, foreign=None):
    lines = ["# Hidden effects: what the tool finds of them", "",
             "Written by `tests/hidden/hidden_effects`, not by hand. Hidden effects and definition of correct: "
             "`secret_effects.py`; instruments: `instruments.py`; SNR: `strength.py`; scores: `scoring.py`.", ""]
    lines += [f"- {key}: {value}" for key, value in told.items()]
    lines += ["", "## Comparison with the aims", "", target_table(cases, before)]
    if foreign:
        lines += ["", "## Flights of another simulator", "", foreign]
    for title, kind, table in (("One effect", "single", effect_table), ("Two effects", "pair", effect_table),
                               ("A fault of the other static system, with a laser", "other", effect_table),
                               ("Two static systems and no laser", "two systems", effect_table),
                               ("Outside the catalogue", "outside", outside_table)):
        if some := of_kind(cases, kind):
            lines += ["", f"## {title}", "", table(some)]
    if some := of_kind(cases, "null"):
        lines += ["", "## Null flights", "", "```", nulls.table_of(some), "```"]
    lines += ["", "## Runs that failed", ""]
    lines += [f"- {case['label']}: {case.get('error', case.get('verdict'))}" for case in failed(cases)] or ["None."]
    return "\n".join(lines) + "\n"
