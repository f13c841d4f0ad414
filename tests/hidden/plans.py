"""Scenarios of flights: legs and atmosphere from the number of a plan.

The number of the plan and the part determine legs, heights, speeds and atmosphere; the seed determines turbulence. Parts are
flights of the same kind on different days, in which an effect has about the same size. The instruments are ideal;
instruments.py adds their errors.
"""

import random
from dataclasses import dataclass

LAWS = {
    "C-130": {"static-constant": ("a0", 0.004127875), "static-alpha": ("a1", 0.021279816),
              "static-qp": ("a2", 0.030849643)},
    "GV": {"static-constant": ("a0", -0.012255), "static-qp": ("a2", 0.075372), "static-mach3": ("m3", -0.087508),
           "static-attack": ("a3", 0.002148)},
}
STATIC = {"C-130": "PSFD", "GV": "PSF"}
THERMOMETER = {"C-130": ("TTRR", 0.95), "GV": ("TTHR1", 0.985)}

# For each level: height and its spread, m; speed, lowest and highest speed of a speed run, m/s
HEIGHTS = {
    "C-130": [(1400, 300, 103, 92, 138), (3300, 500, 112, 95, 145), (5400, 400, 120, 102, 150)],
    "GV": [(2500, 500, 145, 125, 185), (7000, 700, 178, 152, 215), (10900, 300, 222, 198, 247)],
}
CLIMB = {"C-130": 6, "GV": 10}  # m/s
TAKE_OFF_SPEED = {"C-130": 100, "GV": 140}  # m/s
KINDS = ("manoeuvres", "long", "steady", "short")
# Factors on the coefficients of the user's model before the fit
STARTS = {"right": 1.0, "neutral": 0.0, "halved": 0.5, "doubled": 2.0, "negated": -1.0}
SECOND = {"static-constant": ("a0", 0.002047), "static-alpha": ("a1", 0.008890), "static-qp": ("a2", 0.07119)}

ROLES = {
    "lams_airspeed": "VLAMS", "attack": "ATTACK", "sideslip": "SSLIP", "vapor_pressure": "EDPC",
    "radome_dynamic_pressure": "QCR", "attack_differential_pressure": "ADIFR",
    "sideslip_differential_pressure": "BDIFR", "altitude": "GGALT", "vertical_speed": "GGVSPD", "pitch": "PITCH",
    "roll": "ROLL", "heading": "THDG", "ground_speed": "GGSPD", "ground_track": "GGTRK", "latitude": "GGLAT",
    "normal_acceleration": "BNORMA", "flaps": "FLAPS", "liquid_water": "PLWCC", "transducer_temperature": "TBAY",
    "cabin_pressure": "PCAB", "engine_torque": "ENGTRQ", "longitudinal_acceleration": "BLONA",
    "height_above_ground": "RALT",
}


@dataclass(frozen=True)
class Plan:
    aircraft: str
    kind: str
    number: int

    def __str__(self):
        return f"{self.aircraft} {self.kind} {self.number}"


def model_text(aircraft, without=(), moist=True, start="right", laser=True):
    """Model file of the user: the law of the aircraft except the effects `without`."""
    roles = {role: variable for role, variable in ROLES.items() if laser or role != "lams_airspeed"}
    law = {effect: (parameter, STARTS[start] * value) for effect, (parameter, value) in LAWS[aircraft].items()
           if effect not in without}
    return text_of(aircraft, (STATIC[aircraft], "QCF"), roles, law, moist)


def second_model_text():
    """Model file of the second static system of the C-130, with the right coefficients."""
    roles = {role: variable for role, variable in ROLES.items() if role != "lams_airspeed"}
    return text_of("C-130", ("PSFRD", "QCFR"), roles, SECOND)


def text_of(aircraft, pair, roles, law, moist=True):
    thermometer, recovery = THERMOMETER[aircraft]
    lines = ['format = "pcor-model/1"', f'name = "{aircraft}"', f'aircraft = "{aircraft}"', "", "[variables]",
             f'static_pressure = "{pair[0]}"', f'dynamic_pressure = "{pair[1]}"',
             f'recovery_temperature = "{thermometer}"']
    lines += [f'{role} = "{variable}"' for role, variable in roles.items()]
    lines += ["", "[temperature]", f"recovery_factor = {recovery}", "", "[humidity]", f"moist = {str(moist).lower()}"]
    for effect, (parameter, value) in law.items():
        lines += ["", "[[effect]]", f'id = "{effect}"', f"parameters = {{ {parameter} = {value} }}"]
    return "\n".join(lines) + "\n"


def leg(kind, **numbers):
    lines = ["[[leg]]", f'kind = "{kind}"']
    return "\n".join(lines + [f"{key} = {round(value, 3)}" for key, value in numbers.items()])


def block(rng, aircraft, height, kinds):
    """Manoeuvres at one height, in random order."""
    _, _, speed, low, high = HEIGHTS[aircraft][height]
    speed = speed + rng.uniform(-3, 3)
    amplitude = 4 if aircraft == "C-130" else (3.5, 3, 2)[height]
    choices = {
        "level": lambda: leg("level", duration=rng.uniform(120, 240), speed=speed),
        "pitch": lambda: leg("pitch", period=rng.choice([18, 20, 25, 30]), cycles=rng.randint(5, 8),
                             amplitude=amplitude * rng.uniform(0.7, 1.0), speed=speed),
        "yaw": lambda: leg("yaw", period=rng.choice([10, 12, 14]), cycles=rng.randint(10, 14),
                           amplitude=rng.uniform(3, 4), speed=speed),
        "speed-run": lambda: leg("speed-run", low=low + rng.uniform(0, 4), high=high - rng.uniform(0, 4),
                                 rate=rng.uniform(0.28, 0.4)),
        "reverse-heading": lambda: leg("reverse-heading", duration=rng.uniform(180, 240), speed=speed),
        "circle": lambda: leg("circle", angle=rng.choice([-360, 360]), speed=speed),
        "turn": lambda: leg("turn", angle=rng.choice([-90, 90, 120, -120]), speed=speed),
    }
    rng.shuffle(kinds)
    return [choices[kind]() for kind in kinds]


def legs_of(plan, part):
    rng = random.Random(f"{plan} part {part}")
    heights = HEIGHTS[plan.aircraft]

    def height_of(index):
        return heights[index][0] + rng.uniform(-1, 1) * heights[index][1]

    legs = [leg("ground", duration=30)]
    if plan.kind == "short":
        height = height_of(0)
        legs.append(leg("take-off", altitude=height, speed=TAKE_OFF_SPEED[plan.aircraft], rate=CLIMB[plan.aircraft]))
        kinds = ["level"] + rng.choice([["pitch", "yaw", "speed-run"], ["pitch", "speed-run"], ["yaw", "speed-run"],
                                        ["speed-run", "turn"], ["pitch", "yaw", "turn"], ["level", "level"]])
        legs += block(rng, plan.aircraft, 0, kinds)
    else:
        order = rng.sample([0, 1, 2], 2 if plan.kind == "manoeuvres" else 3)
        if plan.aircraft == "GV" and plan.kind == "manoeuvres" and 2 not in order:
            order[1] = 2  # the level with a high Mach number
        now = None
        for place, index in enumerate(order):
            goal = height_of(index)
            speed = heights[index][2]
            if now is None:
                first = min(goal, heights[0][0])
                legs.append(leg("take-off", altitude=first, speed=TAKE_OFF_SPEED[plan.aircraft],
                                rate=CLIMB[plan.aircraft]))
                now = first
            if goal > now + 20:
                legs.append(leg("climb", altitude=goal, rate=CLIMB[plan.aircraft] * rng.uniform(0.8, 1.2),
                                speed=min(speed, 115 if plan.aircraft == "C-130" else 215)))
            elif goal < now - 20:
                legs.append(leg("descent", altitude=goal, rate=CLIMB[plan.aircraft] * rng.uniform(0.8, 1.2),
                                speed=speed))
            now = goal
            if plan.kind == "steady":
                legs.append(leg("level", duration=rng.uniform(500, 900), speed=speed + rng.uniform(-3, 3)))
            elif place == 0:
                legs += block(rng, plan.aircraft, index, ["level", "pitch", "yaw", "speed-run", "turn"])
            else:
                legs += block(rng, plan.aircraft, index, ["level", "pitch", "yaw", "speed-run", "circle",
                                                          "reverse-heading"])
        if plan.kind != "steady":
            low, speed = heights[0][0] - 500, heights[0][2]
            if now > low + 50:
                legs.append(leg("descent", altitude=low, rate=CLIMB[plan.aircraft] * 1.2, speed=speed))
            legs.append(leg("level", duration=120, speed=speed - 8, flaps=30))
            legs.append(leg("level", duration=60, speed=speed - 8, flaps=0))
    return legs + [leg("landing"), leg("ground", duration=30)]


def atmosphere_of(plan, part):
    rng = random.Random(f"{plan} air {part}")
    inversion = rng.uniform(1000, 2500)
    warm = rng.uniform(280, 300) if plan.aircraft == "C-130" else rng.uniform(294, 302)
    turbulence, layer = 1e-4, 2e-3
    if plan.number % 2:  # other turbulence in and above the boundary layer
        turbulence, layer, inversion = rng.choice([1e-5, 3e-5, 3e-4]), rng.choice([1e-3, 4e-3]), rng.uniform(1300, 3500)
    base = HEIGHTS[plan.aircraft][0 if plan.kind == "short" else rng.choice([0, 1])][0] - 700
    return "\n".join([
        "[atmosphere]", f"ground_pressure = {rng.uniform(990, 1022):.2f}", f"ground_temperature = {warm:.2f}",
        f"lapse_rate = {rng.uniform(6, 6.8):.2f}", f"inversion_height = {inversion:.0f}",
        f"ground_humidity = {rng.uniform(45, 85):.1f}", f"upper_humidity = {rng.uniform(15, 50):.1f}",
        f"wind_speed = {rng.uniform(2, 10):.2f}", f"wind_from = {rng.uniform(0, 360):.1f}",
        f"turbulence = {turbulence}", f"boundary_layer = {layer}",
        *(["tropopause = 15000"] if plan.aircraft == "GV" else []),
        "[[atmosphere.cloud]]", f"base = {base}", f"top = {base + 1400}", f"cover = {rng.uniform(0.15, 0.4):.2f}"])


def terms_of(law, without=()):
    return ", ".join(f"{name} = {value}" for name, (_, value) in law.items() if name not in without)


def scenario_text(plan, part, seed, effects="", without=()):
    """Scenario for `pcor simulate`. Parts 0 and 1 of a plan are for training, part 2 is held out."""
    day = random.Random(f"{plan} aircraft {part}")
    weight = day.uniform(*((54000, 60000) if plan.aircraft == "C-130" else (31000, 36000)))
    head = ['format = "pcor-scenario/1"', f'name = "{plan} {part}"', f'aircraft = "{plan.aircraft}"', f"seed = {seed}",
            f"start = 2011-11-{10 + part}T15:00:00Z", "noiseless = true",
            f"heading = {day.uniform(0, 360):.1f}", f"weight = {weight:.0f}"]
    law = terms_of(LAWS[plan.aircraft], without)
    system = ["[[system]]", f'static = "{STATIC[plan.aircraft]}"', 'dynamic = "QCF"', f"law = {{ {law} }}"]
    if plan.aircraft == "C-130":
        system += ["[[system]]", 'static = "PSFRD"', 'dynamic = "QCFR"', f"law = {{ {terms_of(SECOND)} }}"]
    return "\n\n".join(["\n".join(head), atmosphere_of(plan, part), "\n".join(system),
                        "\n".join(legs_of(plan, part)), effects]) + "\n"
