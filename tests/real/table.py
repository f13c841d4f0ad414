"""The results in words and numbers."""

import json

COLUMNS = (("in set", "in_set"), ("identified", "identified"), ("nothing else", "nothing_else"), ("wrong", "wrong"),
           ("sure+wrong", "sure_and_wrong"), ("both told", "both_told"), ("named", "named"), ("structure", "structure"),
           ("silent", "silent"), ("any trace", "any_traced"), ("traced 1st", "traced_first"), ("traced 5", "traced_among_five"), ("harm", "harm"),
           ("ladder worse", "ladder_worse"))

BANDS = (("small, z below 14", 0, 14), ("medium", 14, 45), ("large, z above 45", 45, 1e9))


def line_of(facts):
    return json.dumps(facts, sort_keys=True)


def short(facts):
    if "error" in facts:
        return f"ERROR {facts['label']}: {facts['error']}"
    right = facts["in_set"] and facts["nothing_else"] if "size" in facts and facts["group"] != "outside" else (
        facts.get("traced_among_five", True) and not facts["named"])
    return (f"{'ok ' if right else 'BAD'} {facts['label']}: {facts['verdict']} {facts['findings']} traced {facts['traced'][:2]} "
            f"static {facts['static_before']:.3f}->{facts['static_after']:.3f}{' HARM' if facts['harm'] else ''}"
            f"{' LADDER' if facts['ladder_worse'] else ''}")


def rows_of(found):
    """(name, cases): groups, and the hidden effects by size."""
    groups = dict.fromkeys(facts["group"] for facts in found)
    rows = [(group, [facts for facts in found if facts["group"] == group]) for group in groups]
    known = [facts for facts in found if not facts["group"].startswith(("null", "outside"))]
    rows += [(f"effects, {name}", [facts for facts in known if low <= facts.get("z_reached", 0) < high]) for name, low, high in BANDS]
    for name, foreign in (("catalogue's shapes, medium and large", False), ("foreign shapes, medium and large", True)):
        rows.append((name, [facts for facts in known if facts.get("z_reached", 0) >= 14 and ("foreign" in facts["group"]) == foreign]))
    rows.append(("all nulls", [facts for facts in found if facts["group"].startswith("null")]))
    return [*rows, ("all", found)]


def of(found):
    lines = ["| group | cases | " + " | ".join(title for title, _ in COLUMNS) + " | errors |", "|---" * (len(COLUMNS) + 3) + "|"]
    for name, some in rows_of(found):
        good = [facts for facts in some if "error" not in facts]
        cells = []
        for _, key in COLUMNS:
            told = [bool(facts[key]) for facts in good if key in facts]
            empty = not told or (("null" in name or name == "outside") and key in ("in_set", "identified", "nothing_else", "both_told"))
            cells.append("-" if empty else str(sum(told)))
        lines.append(f"| {name} | {len(some)} | " + " | ".join(cells) + f" | {len(some) - len(good)} |")
    return "\n".join(lines)
