"""Results as a page of Markdown: targets, an earlier run for comparison, and tables of effects."""

import statistics

import nulls

VISIBLE = 0.1  # min SNR at which the residual shows an effect; smaller effects need other references
HEAD = ("| hidden effect | cases | size / usual | SNR | truth in set | no other name | size of set | identified | silent | "
        "wrong | held-out rms / baseline | static error after / before |\n|---|---|---|---|---|---|---|---|---|---|---|---|")


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
    """Static error after `improve` / static error before."""
    if case.get("static_after") is None or not case.get("static_before"):
        return None
    return case["static_after"] / case["static_before"]


def made_worse(case):
    """True if the static error increased by more than chance: by more than 2 % and by more than 0.02 hPa."""
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
    lines = ["| hidden effect | cases | SNR | identified | effect named | flagged | traced first | traced among five | "
             "held-out rms / baseline |", "|---|---|---|---|---|---|---|---|---|"]
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
    """Rows of targets: quantity, number of cases, target, result."""
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
    with_laser = of_kind(cases, "other")
    static = [growth(case) for case in flown if case["static"] and case["snr"] >= 0.8]
    every = [case for case in cases if "error" not in case and case["kind"] != "null"]
    times = numbers(every, "diagnose_seconds")

    def claims(*kinds):
        return percent([case["claim"] in kinds for case in null])

    return [
        ("one effect, SNR >= 0.1: truth in a named set", len(seen), "99 %", percent(scored(seen, "in_set"))),
        ("one effect, SNR >= 0.1: no other effect named", len(seen), "97 %", percent(scored(seen, "nothing_else"))),
        ("one effect, SNR >= 0.1: both", len(seen), "96 %", percent(scored(seen, "both"))),
        ("one effect, SNR >= 0.1: mean size of the set", len(seen), "1.6", mean(scored(seen, "size"))),
        ("one effect, SNR >= 0.1: verdict silent", len(seen), "-", percent(scored(seen, "silent"))),
        ("one effect, SNR >= 0.1: truth is the first name", len(seen), "-", percent(scored(seen, "first"))),
        ("one effect, SNR >= 0.1, with manoeuvres: both", len(flown), "-", percent(scored(flown, "both"))),
        ("one effect, SNR >= 0.1, 9 to 20 times the usual size: both", len(large), "-", percent(scored(large, "both"))),
        ("one effect, SNR >= 0.1, wrong initial coefficients: both", len(wrong_start), "-",
         percent(scored(wrong_start, "both"))),
        ("one effect, SNR < 0.1: truth in a named set", len(unseen), "-", percent(scored(unseen, "in_set"))),
        ("one effect, SNR < 0.1: another name, verdict not partial", len(unseen), "-", percent(scored(unseen, "wrong"))),
        ("two effects, SNR >= 0.1: both in named sets", len(seen_pairs), "100 %", percent(scored(seen_pairs, "in_set"))),
        ("two effects, SNR >= 0.1: both in named sets, no other effect named", len(seen_pairs), "90 %",
         percent(scored(seen_pairs, "both"))),
        ("fault of the second system, with a laser: first system blamed", len(with_laser), "0 %",
         percent(scored(with_laser, "own_blamed"))),
        ("no laser, fault of the first system: truth in a named set", len(own), "-", percent(scored(own, "in_set"))),
        ("no laser, fault of the first system: set includes the second system", len(own), "100 %",
         percent(scored(own, "twin_told"))),
        ("no laser, fault of the second system: first system blamed", len(other), "0 %", percent(scored(other, "own_blamed"))),
        ("no laser: static error increased", len(two), "0 %", percent(map(made_worse, two))),
        ("all cases: static error increased by more than 2 % and 0.02 hPa", len(every), "0 %",
         percent(map(made_worse, every))),
        ("static effect, SNR >= 0.8: static error after / before, median", len(static), "0.2", median_of(static)),
        ("one effect, SNR >= 0.1: held-out rms / baseline, median", len(seen), "-",
         median_of(numbers(seen, "held_out_after"), 4)),
        ("outside the catalogue, SNR >= 0.1: flagged", len(seen_outside), "89 %", percent(scored(seen_outside, "noticed"))),
        ("outside the catalogue, SNR >= 0.1: identified", len(seen_outside), "1 %",
         percent(scored(seen_outside, "identified"))),
        ("outside the catalogue, SNR >= 0.1, recorded: traced to its variable", len(seen_outside), "-",
         percent(scored(seen_outside, "traced"))),
        ("null cases: effect named", len(null), "0.5 %", claims("named")),
        ("null cases: effect named or variable traced", len(null), "2 %", claims("named", "traced")),
        ("null cases: structure without a cause", len(null), "-", claims("structure")),
        ("time of diagnose for two flights, median, s", len(times), "2", median_of(times)),
        ("failed runs", len(cases), "0", str(len(failed(cases)))),
    ]


def failed(cases):
    return [case for case in cases if "error" in case or case.get("claim") == "error"]


def target_table(cases, before):
    rows = targets(cases)
    lines = ["| quantity | cases | target | result |", "|---|---|---|---|"]
    if before:
        name, recorded = before
        same = {case["label"] for case in cases}
        earlier = [case for case in recorded if case["label"] in same]
        lines = [f"| quantity | cases | target | result | {name} |", "|---|---|---|---|---|"]
        return "\n".join(lines + [f"| {quantity} | {count} | {target} | {result} | {old} |"
                                  for (quantity, count, target, result), (_, _, _, old) in zip(rows, targets(earlier))])
    return "\n".join(lines + [f"| {quantity} | {count} | {target} | {result} |" for quantity, count, target, result in rows])


def page(cases, header, before=None, foreign=None):
    lines = ["# Hidden effects: results", "",
             "Generated by `tests/hidden/hidden_effects`. Hidden effects and names that count as correct: `secret_effects.py`; "
             "instrument errors: `instruments.py`; SNR: `strength.py`; scores: `scoring.py`. The set of a finding is the named "
             "effect with its aliases. The baseline is the same flight without hidden effects, fitted with the right model.", ""]
    lines += [f"- {key}: {value}" for key, value in header.items()]
    lines += ["", "## Targets", "", target_table(cases, before)]
    if foreign:
        lines += ["", "## Flights of an independent simulator", "", foreign]
    for title, kind, table in (("One effect", "single", effect_table), ("Two effects", "pair", effect_table),
                               ("Fault of the second static system, with a laser", "other", effect_table),
                               ("Two static systems, no laser", "two systems", effect_table),
                               ("Outside the catalogue", "outside", outside_table)):
        if some := of_kind(cases, kind):
            lines += ["", f"## {title}", "", table(some)]
    if some := of_kind(cases, "null"):
        lines += ["", "## Null cases", "", "```", nulls.table_of(some), "```"]
    lines += ["", "## Failed runs", ""]
    lines += [f"- {case['label']}: {case.get('error', case.get('verdict'))}" for case in failed(cases)] or ["None."]
    return "\n".join(lines) + "\n"
