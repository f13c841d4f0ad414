"""Cases of the suite. Two thirds are open; the others are reserved for a final test (`kept`)."""

import itertools
import random

import injected
from one_case import Case

SALT = "air-1"
SIZES = (7, 21, 70)  # z in a fit that knows the column, see Air.oracle_z: about 1, 3 and 10 times the detection limit
SURROGATES = ("shift", "phases", "signs")
SENSORS = ("PSFD", "QCF", "QCR", "ADIFR", "BDIFR", "TTX", "VLAMS", "second")
MEMORIES, NOISES = ("5", "60", "600", "1/f"), (0.01, 0.02, 0.05, 0.1)  # s; hPa
HIDDEN = (("own", injected.OWN, "static", 22), ("own, foreign shape", injected.OWN_FOREIGN, "static", 13),
          ("second ill", injected.OTHER, "static", 13), ("second ill, foreign", injected.OTHER_FOREIGN, "static", 7),
          ("laser", injected.LASER, "laser", 30), ("laser, foreign", injected.LASER_FOREIGN, "laser", 15))


def whole(salt=SALT):
    """All 215 cases: 146 open, 69 reserved."""
    made = []
    for group, effects, reference, share in HIDDEN:
        mixed = [(effect.name, SIZES[(k + n) % 3]) for n in range(3) for k, effect in enumerate(effects)]
        for number, (name, z) in enumerate(mixed[:round(share * 1.5)]):
            made.append(Case(group, name, z, SURROGATES[number % 3], "", reference, number))
    for number, (variable, shape) in enumerate(injected.CAUSES):
        where = ("own", "other", "laser")[number % 3]
        made.append(Case("outside", f"{variable} {shape} ({where})", SIZES[1 + number % 2], SURROGATES[number % 3], "",
                         "laser" if where == "laser" else "static", number))
    for number in range(21):
        reference = ("static", "laser")[number % 2]
        made.append(Case("null in the residual", f"nothing, {reference}", 0, SURROGATES[number % 3], "", reference, number))
    for number, (memory, sensor) in enumerate(itertools.product(MEMORIES, SENSORS)):
        reference = "static" if sensor in ("PSFD", "ADIFR", "second", "BDIFR") and number % 3 else "laser"
        made.append(Case("null in a sensor", sensor, NOISES[(number // 8 + number) % 4], "fast", memory, reference, number))
    groups = {}
    for case in made:
        groups.setdefault(case.group, []).append(case)
    result = []
    for group, cases in groups.items():
        keep = set(random.Random(f"{salt} {group}").sample(range(len(cases)), len(cases) // 3))
        result += [Case(**{**vars(case), "kept": number in keep}) for number, case in enumerate(cases)]
    return result


def quick(cases):
    """26 open cases, some of each group."""
    made = []
    for group in dict.fromkeys(case.group for case in cases):
        some = [case for case in cases if case.group == group and not case.kept and case.z != SIZES[0]]
        count = {"null in a sensor": 5, "outside": 3, "second ill, foreign": 1, "second ill": 2, "null in the residual": 3}.get(group, 3)
        made += random.Random(f"quick {group}").sample(some, min(count, len(some)))
    return made
