"""Scores the JSON of a diagnosis against the truth."""


def names_in(finding):
    """Set of a finding: the named effect and its aliases."""
    aliases = [alias if isinstance(alias, str) else alias["effect"] for alias in finding.get("aliases", [])]
    return [finding["effect"], *aliases]


def traced_in(diagnosis):
    return [variable["name"] for variable in diagnosis.get("unexplained", {}).get("variables", [])]


def verdict_of(diagnosis):
    """Verdict of the tool, or, if the JSON has no verdict, a verdict derived from the findings."""
    if "verdict" in diagnosis:
        return diagnosis["verdict"]
    if diagnosis["findings"]:
        return "cannot be told apart" if diagnosis["findings"][0].get("aliases") else "identified"
    return "unexplained" if diagnosis.get("unexplained", {}).get("significant") else "silent"


def summary_of(diagnosis):
    return {"verdict": verdict_of(diagnosis), "findings": [names_in(finding) for finding in diagnosis["findings"]],
            "chi2": [finding.get("chi2") for finding in diagnosis["findings"]],
            "unexplained_hpa": diagnosis.get("unexplained", {}).get("rms_hpa"), "traced": traced_in(diagnosis)[:5]}


def of_hidden(diagnosis, secrets):
    """Scores of one diagnosis. `wrong`: a finding has no hidden effect in its set, and the verdict is not "partial"; with
    "partial" the tool states that the named effect is not the cause. `own_blamed`: the set of a finding has no effect of the other static
    system."""
    sets = [names_in(finding) for finding in diagnosis["findings"]]
    truths = [set(secret.truth) for secret in secrets if secret.truth]
    verdict = verdict_of(diagnosis)
    found = [next((names for names in sets if truth & set(names)), None) for truth in truths]
    right = [names for names in sets if any(truth & set(names) for truth in truths)]
    score = {
        "verdict": verdict,
        "identified": verdict == "identified",
        "silent": verdict == "silent",
        "in_set": bool(truths) and all(names is not None for names in found),
        "first": bool(sets and truths) and any(sets[0][0] in truth for truth in truths),
        "size": len(found[0]) if found and found[0] else None,
        "nothing_else": len(right) == len(sets),
        "wrong": len(right) < len(sets) and verdict != "partial",
        "own_blamed": any(not any(name.startswith("reference:") for name in names) for names in sets),
        "twin_told": all(any(name.startswith("reference:") for name in names) for names in right),
        "claims": bool(sets),
    }
    score["both"] = score["in_set"] and score["nothing_else"]
    outside = [secret for secret in secrets if secret.outside]
    if outside:
        traced = traced_in(diagnosis)
        wanted = set(outside[0].traced)
        score["traced"] = bool(traced) and traced[0] in wanted if wanted else None
        score["traced_among_five"] = bool(wanted & set(traced[:5])) if wanted else None
        score["noticed"] = verdict != "silent"
    return score
