"""Results as text, a table and lines of JSON."""

import json

COLUMNS = (("in set", "in_set"), ("identified", "identified"), ("no other name", "nothing_else"), ("wrong", "wrong"),
           ("wrong, identified", "sure_and_wrong"), ("both systems", "both_told"), ("named", "named"),
           ("structure", "structure"), ("silent", "silent"), ("traced", "any_traced"), ("traced first", "traced_first"),
           ("traced among five", "traced_among_five"), ("harm", "harm"), ("worse step", "ladder_worse"))

# Groups with another name in the table: the label of a case determines its noise, so the group itself keeps its name.
TITLES = {"second ill": "second system", "second ill, foreign": "second system, foreign shape", "laser, foreign": "laser, foreign shape",
          "null in the residual": "null, noise of the residual", "null in a sensor": "null, noise of a sensor"}

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
            f"{' WORSE STEP' if facts['ladder_worse'] else ''}")


def rows_of(found):
    """Rows of the table, (name, cases): groups, effects by size and shape, sums."""
    groups = dict.fromkeys(facts["group"] for facts in found)
    rows = [(TITLES.get(group, group), [facts for facts in found if facts["group"] == group]) for group in groups]
    known = [facts for facts in found if not facts["group"].startswith(("null", "outside"))]
    rows += [(f"effects, {name}", [facts for facts in known if low <= facts.get("z_reached", 0) < high]) for name, low, high in BANDS]
    for name, foreign in (("shapes of the catalogue, medium and large", False), ("foreign shapes, medium and large", True)):
        rows.append((name, [facts for facts in known if facts.get("z_reached", 0) >= 14 and ("foreign" in facts["group"]) == foreign]))
    rows.append(("all nulls", [facts for facts in found if facts["group"].startswith("null")]))
    return [*rows, ("all", found)]


def of(found):
    lines = ["| group | cases | " + " | ".join(title for title, _ in COLUMNS) + " | errors |", "|---" * (len(COLUMNS) + 3) + "|"]
    for name, some in rows_of(found):
        good = [facts for facts in some if "error" not in facts]
        cells = []
        for _, key in COLUMNS:
            values = [bool(facts[key]) for facts in good if key in facts]
            empty = not values or (("null" in name or name == "outside") and key in ("in_set", "identified", "nothing_else", "both_told"))
            cells.append("-" if empty else str(sum(values)))
        lines.append(f"| {name} | {len(some)} | " + " | ".join(cells) + f" | {len(some) - len(good)} |")
    return "\n".join(lines)
