"""Which flights the cases of a run have.

Null flights have a plan of their own each. Cases with a secret share a number of worlds: a plan and a seed, so that
what the best model reaches there, and what a unit of an effect leaves, is found once. A secret meets worlds of all
kinds, and each secret begins with another one.
"""

import plans
import secret_effects
from cases import Case

EVALUATION, TUNING = 900_000, 1
PLANS = (("C-130", "manoeuvres"), ("C-130", "manoeuvres"), ("GV", "manoeuvres"), ("C-130", "manoeuvres"),
         ("C-130", "steady"), ("C-130", "manoeuvres"), ("C-130", "manoeuvres"), ("GV", "manoeuvres"),
         ("C-130", "manoeuvres"), ("C-130", "manoeuvres"))
WORLDS = 40


def world(base, number):
    """Plan, noise and seed of a world: ten plans, each with four seeds, two of them with hard noise."""
    number %= WORLDS
    variant, turn = number % len(PLANS), number // len(PLANS)
    aircraft, kind = PLANS[variant]
    return plans.Plan(aircraft, kind, base + variant), "AB"[(variant + turn) % 2], base + number


def null_cases(base, count, drifting):
    made = []
    for number in range(count + drifting):
        plan = plans.Plan("GV" if number % 5 == 4 else "C-130", "short", base + 100 + number)
        noise = "drift" if number >= count else "AB"[number % 2]
        made.append(Case("null", "null", plan, noise, base + 1000 + number))
    return made


def hidden_cases(base, kind, name, secrets, count, strengths, order):
    """Cases of one secret in worlds of the aircraft that it is for."""
    aircraft = set(plans.LAWS).intersection(*(secret_effects.BY_NAME[each].aircraft for each in secrets))
    made, number = [], 7 * order
    while len(made) < count:
        plan, noise, seed = world(base, number)
        number += 1
        if plan.aircraft in aircraft:
            snr = strengths[len(made) % len(strengths)]
            improved = snr >= 1.0 or len(made) % 4 == 0  # it takes longest; what it reaches is asked at SNR 1
            made.append(Case(kind, name, plan, noise, seed, snr, tuple(secrets), improved))
    return made


def all_cases(base, options):
    made = null_cases(base, options.nulls, options.drifting)
    strengths = options.snr
    singles = [secret for secret in secret_effects.CATALOGUE if chosen(secret.name, options.effects)]
    outside = [secret for secret in secret_effects.OUTSIDE if chosen(secret.name, options.effects)]
    pairs = [pair for pair in secret_effects.PAIRS if chosen(" + ".join(pair), options.effects)]
    for order, secret in enumerate(singles):
        count = options.cases if secret.scalable else min(options.cases, 4)
        made += hidden_cases(base, "single", secret.name, (secret.name,), count, strengths, order)
    for order, secret in enumerate(outside):
        made += hidden_cases(base, "outside", secret.name, (secret.name,), options.outside_cases, (1.0, 2.0), order)
    for order, pair in enumerate(pairs):
        made += hidden_cases(base, "pair", " + ".join(pair), pair, options.pair_cases, (0.5, 1.0), order)
    return made


def chosen(name, wanted):
    return not wanted or any(word in name for word in wanted)
