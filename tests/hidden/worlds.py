"""Selects the flights of the cases of a run.

A world is a combination of plan, noise, instrument trouble, initial coefficients and seed. Cases share worlds, so that a
baseline is computed once. The cases of an effect use different worlds, and each effect starts with another world.
"""

import instruments
import plans
import secret_effects
from cases import Case

EVALUATION, TUNING = 900_000, 1
PLANS = (("C-130", "manoeuvres"), ("C-130", "long"), ("GV", "manoeuvres"), ("C-130", "manoeuvres"),
         ("C-130", "steady"), ("C-130", "manoeuvres"), ("C-130", "long"), ("GV", "long"),
         ("C-130", "manoeuvres"), ("C-130", "manoeuvres"))
TROUBLES = ("none", "none", *instruments.TROUBLES)
WORLDS = 40
TIMES = (1.0, 3.0, 0.3, 10.0, 20.0)  # size / usual size


def world(base, number):
    """World `number`: ten plans with four seeds each; noises, troubles and initial coefficients alternate."""
    number %= WORLDS
    variant, turn = number % len(PLANS), number // len(PLANS)
    aircraft, kind = PLANS[variant]
    starts = list(plans.STARTS)
    return {"plan": plans.Plan(aircraft, kind, base + variant), "seed": base + number,
            "noise": instruments.NOISES[(variant + turn) % 2], "trouble": TROUBLES[number % len(TROUBLES)],
            "start": starts[number // 2 % len(starts)] if number % 2 else "right"}


def null_cases(base, count):
    """Null cases with the numbers of nulls.py."""
    return [Case("null", "null", plans.Plan("", "long", number), secrets=(base, number)) for number in range(count)]


def hidden_cases(base, kind, name, secrets, count, times, order):
    """Cases of one effect or pair, in worlds of the aircraft that have it."""
    aircraft = set(plans.LAWS).intersection(*(secret_effects.BY_NAME[each].aircraft for each in secrets))
    made, number = [], 7 * order
    while len(made) < count:
        flown = world(base, number)
        number += 1
        if flown["plan"].aircraft in aircraft:
            made.append(Case(kind, name, secrets=tuple(secrets), times=times[(len(made) + order) % len(times)],
                             improve=len(made) % 2 == 0, **flown))
    return made


def all_cases(base, options):
    made = null_cases(base, options.nulls)
    groups = (("single", [*secret_effects.CATALOGUE, *secret_effects.VARIANTS], options.cases, TIMES),
              ("other", secret_effects.OTHER, options.cases, TIMES),
              ("two systems", secret_effects.TWO_SYSTEMS, options.cases, TIMES),
              ("outside", secret_effects.OUTSIDE, options.outside_cases, (1.0, 3.0)))
    for kind, secrets, count, times in groups:
        for order, secret in enumerate(secrets):
            if chosen(secret.name, options.effects):
                made += hidden_cases(base, kind, secret.name, (secret.name,), count if secret.scalable else 2, times,
                                     order)
    for order, pair in enumerate(secret_effects.PAIRS):
        if chosen(" + ".join(pair), options.effects):
            made += hidden_cases(base, "pair", " + ".join(pair), pair, options.pair_cases, (3.0, 10.0), order)
    return made


def chosen(name, words):
    return not words or any(word in name for word in words)
