"""The results as Markdown: by effect, and against what is to be reached."""

import statistics

HEAD = ("| hidden | cases | SNR | truth in set | first | mean set | exactly right | identified | wrong | held out over "
        "noise | static error after/before |\n|---|---|---|---|---|---|---|---|---|---|---|")


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


def scored(cases, key):
    return [case["score"].get(key) for case in cases if "score" in case]


def numbers(cases, key):
    return [case[key] for case in cases if case.get(key) is not None]


def growth(case):
    """The static error after `improve` over that before."""
    if case.get("static_after") is None or not case.get("static_before"):
        return None
    return case["static_after"] / case["static_before"]


def row(name, cases, snr):
    sizes = scored(cases, "size")
    held = quantile(numbers(cases, "held_out_after"), 0.5)
    ratio = quantile([value for value in map(growth, cases) if value is not None], 0.5)
    words = [name, str(len(cases)), snr, percent(scored(cases, "in_set")), percent(scored(cases, "first")),
             mean(sizes), percent(scored(cases, "exact")), percent(scored(cases, "identified")),
             percent(scored(cases, "wrong")), "-" if held is None else f"{held:.4f}",
             "-" if ratio is None else f"{ratio:.2f}"]
    return "| " + " | ".join(words) + " |"


def effect_table(cases):
    lines = [HEAD]
    for name in dict.fromkeys(case["name"] for case in cases):
        of_name = [case for case in cases if case["name"] == name]
        told = [case for case in of_name if not case.get("absorbed")]
        for snr in sorted({case["snr"] for case in told}):
            lines.append(row(name, [case for case in told if case["snr"] == snr], f"{snr:g}"))
        if beyond := [case for case in of_name if case.get("absorbed")]:
            reached = quantile([hidden["snr"] for case in beyond for hidden in case["hidden"]], 0.5)
            lines.append(row(name, beyond, f"absorbed ({reached:.2g})"))
    return "\n".join(lines)


def outside_table(cases):
    lines = ["| hidden | cases | SNR | called identified | any name | noticed | traced first | traced among five | held "
             "out over noise |", "|---|---|---|---|---|---|---|---|---|"]
    for name in dict.fromkeys(case["name"] for case in cases):
        of_name = [case for case in cases if case["name"] == name]
        for snr in sorted({case["snr"] for case in of_name}):
            some = [case for case in of_name if case["snr"] == snr]
            held = quantile(numbers(some, "held_out_after"), 0.5)
            reached = " (at most)" if any(case.get("absorbed") for case in some) else ""
            lines.append(f"| {name} | {len(some)} | {snr:g}{reached} | {percent(scored(some, 'identified'))} | "
                         f"{percent(scored(some, 'claims'))} | {percent(scored(some, 'noticed'))} | "
                         f"{percent(scored(some, 'traced'))} | {percent(scored(some, 'traced_among_five'))} | "
                         f"{'-' if held is None else f'{held:.4f}'} |")
    return "\n".join(lines)


def of_kind(cases, kind, **wanted):
    return [case for case in cases
            if case["kind"] == kind and "error" not in case and all(case.get(key) == value
                                                                     for key, value in wanted.items())]


def targets(cases):
    """Rows of what is to be reached and what was."""
    null = [case for case in of_kind(cases, "null") if case["noise"] != "drift"]
    drifting = of_kind(cases, "null", noise="drift")
    singles = [case for case in of_kind(cases, "single") if not case.get("absorbed")]
    flown = [case for case in singles if case["plan_kind"] == "manoeuvres"]
    steady = [case for case in singles if case["plan_kind"] == "steady"]
    beyond = [case for case in of_kind(cases, "single") if case.get("absorbed")]
    outside = [case for case in of_kind(cases, "outside") if not case.get("absorbed")]
    pairs = [case for case in of_kind(cases, "pair") if not case.get("absorbed")]

    def at(some, least, most=1e9):
        return [case for case in some if least <= case["snr"] < most]

    def not_silent(some):
        return [not value for value in scored(some, "silent") if value is not None]

    held = numbers(singles, "held_out_after")
    strong = numbers(at(singles, 0.999), "held_out_after")
    ratios = [growth(case) for case in cases if "error" not in case and growth(case) is not None]
    static = [growth(case) for case in at(flown, 0.999) if case.get("static") and growth(case) is not None]
    times = numbers(cases, "diagnose_seconds")

    def pair_of(values):
        middle, high = quantile(values, 0.5), quantile(values, 0.95)
        return "-" if middle is None else f"{middle:.4f}, {high:.4f}"

    return [
        ("truth in the set, SNR 0.3 and more, manoeuvres", len(at(flown, 0.299)), "98 %",
         percent(scored(at(flown, 0.299), "in_set"))),
        ("the same, SNR 0.2", len(at(flown, 0.199, 0.299)), "95 %", percent(scored(at(flown, 0.199, 0.299), "in_set"))),
        ("the same without manoeuvres, SNR 0.3 and more", len(at(steady, 0.299)), "-",
         percent(scored(at(steady, 0.299), "in_set"))),
        ("mean size of the set, SNR 0.3", len(at(flown, 0.299, 0.5)), "2", mean(scored(at(flown, 0.299, 0.5), "size"))),
        ("mean size of the set, SNR 1", len(at(flown, 0.999)), "1.4", mean(scored(at(flown, 0.999), "size"))),
        ("truth named first, SNR 0.3 and more", len(at(flown, 0.299)), "-", percent(scored(at(flown, 0.299), "first"))),
        ("exactly the right set, SNR 0.3 and more", len(at(flown, 0.299)), "-",
         percent(scored(at(flown, 0.299), "exact"))),
        ("wrong claim, one effect", len(singles), "-", percent(scored(singles, "wrong"))),
        ("another name for an absorbed effect", len(beyond), "-", percent(scored(beyond, "wrong"))),
        ("a name on a null flight", len(null), "0.5 %", percent(scored(null, "named"))),
        ("any verdict on a null flight", len(null), "1 %", percent(not_silent(null))),
        ("a name on a null flight, 600 s drift", len(drifting), "on its own", percent(scored(drifting, "named"))),
        ("any verdict on a null flight, 600 s drift", len(drifting), "on its own", percent(not_silent(drifting))),
        ("held-out error over noise floor, one effect, SNR 1: median, 95th percentile", len(strong), "1.01, 1.04",
         pair_of(strong)),
        ("the same, all SNR", len(held), "-", pair_of(held)),
        ("outside the catalogue, called identified", len(outside), "1 %", percent(scored(outside, "identified"))),
        ("outside the catalogue, any name", len(outside), "-", percent(scored(outside, "claims"))),
        ("outside and recorded, traced to its variable", len(outside), "-", percent(scored(outside, "traced"))),
        ("two effects, both found", len(pairs), "95 %", percent(scored(pairs, "in_set"))),
        ("static effect, SNR 1: static error after over before, median", len(static), "below 1",
         "-" if not static else f"{quantile(static, 0.5):.2f}"),
        ("static error grows by more than 2 % after improving", len(ratios), "0 %",
         percent([value > 1.02 for value in ratios])),
        ("diagnosis of two flights: median s (program started)", len(times), "-", mean([quantile(times, 0.5)])),
    ]


def page(cases, told):
    errors = [case for case in cases if "error" in case]
    lines = ["# Hidden effects: what the tool finds of them", "",
             "Written by `tests/hidden/hidden_effects`, not by hand. What is hidden, and what counts as right: "
             "`secret_effects.py`; SNR: `strength.py`; scores: `scoring.py`.", ""]
    lines += [f"- {key}: {value}" for key, value in told.items()]
    lines += ["", "## Against what is to be reached", "", "| what | cases | to reach | reached |", "|---|---|---|---|"]
    lines += [f"| {what} | {count} | {wanted} | {found} |" for what, count, wanted, found in targets(cases)]
    for title, kind, table in (("One effect", "single", effect_table), ("Two effects", "pair", effect_table),
                               ("Outside the catalogue", "outside", outside_table)):
        if some := of_kind(cases, kind):
            lines += ["", f"## {title}", "", table(some)]
    lines += ["", "## Runs that failed", ""]
    lines += [f"- {case['name']}, {case['plan']}, seed {case['seed']}: {case['error']}" for case in errors] or ["None."]
    return "\n".join(lines) + "\n"
