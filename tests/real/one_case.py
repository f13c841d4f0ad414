"""One case: a flight with a hidden effect, runs of the tool, and the results."""

import json
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy

import air as airs
import injected
import scoring
import strength
from tool_runs import ToolError

HARM, WORSE_STEP = 0.02, 0.0005  # hPa, significant increases
MAX_RMS = 3.0  # hPa, of a hidden effect before the law absorbs a part


@dataclass(frozen=True)
class Case:
    group: str
    hidden: str  # name in injected.py; for a null in a sensor the raw variable
    z: float = 0.0  # size of the effect, see Air.oracle_z; for a null in a sensor the noise, hPa
    noise: str = "shift"
    memory: str = ""
    reference: str = "static"  # or laser
    seed: int = 0
    kept: bool = False

    @property
    def label(self):
        size = f"{self.memory} {self.z:g} hPa" if self.memory else f"z {self.z:g}" if self.z else "nothing"
        return f"{self.group}: {self.hidden}, {size}, noise {self.noise}, {self.reference}, seed {self.seed}"


class Stage:
    """Folder with the models of the user, for the cases of one process."""

    def __init__(self, tool, air, parent):
        self.tool, self.air = tool, air
        self.folder = Path(tempfile.mkdtemp(dir=parent))
        for name, pair, law, laser in (("static", ("PSFD", "QCF"), airs.LAW, False), ("laser", ("PSFD", "QCF"), airs.LAW, True),
                                       ("second", ("PSFRD", "QCFR"), airs.OTHER_LAW, False)):
            (self.folder / f"{name}.toml").write_text(airs.model_text(pair, law, laser))
        flight, processed = self.folder / "clean.nc", self.folder / "processed.nc"
        air.write(flight, air.series())
        tool.run("process", flight, "-m", self.folder / "static.toml", "-o", processed, "--quiet")
        (self.airspeed,) = strength.read(processed, "TASX")

    def references(self, reference):
        return ("--reference", f"static:{self.folder / 'second.toml'}") if reference == "static" else ()

    def series(self, case, noisy=True):
        """Series of the flight without an effect, with noise of the reference only."""
        air, draw = self.air, airs.generator(case.label, "noise")
        noise = air.surrogate(air.static_noise, case.noise if noisy else "none", draw)
        total = air.surrogate(air.total_noise, case.noise if noisy else "none", draw)
        laser = case.reference == "laser"
        made = air.series(None if laser else noise, total)
        if laser:
            angles = numpy.cos(numpy.radians(air.raw["ATTACK"])) * numpy.cos(numpy.radians(air.raw["SSLIP"]))
            density = 100 * air.p / (287.05 * (air.raw["ATX"] + 273.15))
            with numpy.errstate(all="ignore"):
                made["VLAMS"] = self.airspeed * angles + 100 * noise / (density * self.airspeed)
        return made

    def residual(self, case, series):
        flight = self.folder / "probe.nc"
        self.air.write(flight, series)
        arguments = self.references("static") if case.reference == "static" else ("--reference", "lams")
        return strength.residual_of(self.tool, flight, self.folder / f"{case.reference}.toml", self.folder, arguments)

    def size_of(self, case, hidden):
        """Size of the effect for the requested z, its rms, hPa, and its z, from a noiseless residual of the size `probe`."""
        series = self.series(case, noisy=False)
        hidden.change(self.air, series, hidden.probe)
        column = self.residual(case, series) / hidden.probe
        column = numpy.nan_to_num(column)
        rms, z = numpy.sqrt((column[self.air.run] ** 2).mean()), self.air.oracle_z(column)
        size = min(case.z / z, MAX_RMS / rms)
        return size, size * rms, size * z

    def static_error(self, flight, model):
        output = self.folder / "processed.nc"
        self.tool.run("process", flight, "-m", model, "-o", output, "--quiet")
        (corrected,) = strength.read(output, "PSXC")
        error = (corrected - self.air.p)[self.air.run]
        return float(numpy.sqrt(numpy.nanmean(error**2)))


def hidden_of(case, air):
    variable, shape, where = (case.hidden.replace("(", "").replace(")", "").split(" ") + ["", ""])[:3]
    if case.group == "outside":
        return injected.outside(air, variable, shape, where)
    lists = {"own": injected.OWN, "own, foreign shape": injected.OWN_FOREIGN, "second ill": injected.OTHER,
             "second ill, foreign": injected.OTHER_FOREIGN, "laser": injected.LASER, "laser, foreign": injected.LASER_FOREIGN}
    return next(each for each in lists[case.group] if each.name == case.hidden)


def disturb(case, air, series):
    """Adds noise with memory to one raw variable: case.z in hPa; TTX gets 3 K per hPa, VLAMS the equivalent in m/s."""
    draw = airs.generator(case.label, "sensor")
    noise = case.z * airs.with_memory(case.memory, air.size, draw)
    if case.hidden == "VLAMS":
        noise = 100 * noise / (numpy.maximum(air.raw["TASX"], 40) * 1.1)
    for name, factor in {"TTX": {"TTX": 3}, "second": {"PSFRD": 1}}.get(case.hidden, {case.hidden: 1}).items():
        series[name] = series[name] + factor * noise
    for angle, sensor in (("ATTACK", "ADIFR"), ("SSLIP", "BDIFR")):
        if case.hidden in (sensor, "QCR"):  # the recorder computes the angles from the radome pressures
            with numpy.errstate(all="ignore"):
                change = series[sensor] / series["QCR"] - air.raw[sensor] / air.raw["QCR"]
                per_ratio = 1 / numpy.polyfit(air.raw[angle][air.run], (air.raw[sensor] / air.raw["QCR"])[air.run], 1)[0]
            series[angle] = series[angle] + numpy.where(numpy.isfinite(change), per_ratio * change, 0)


def run_case(stage, case):
    """Result of a case as a dictionary for JSON. A failed run of the tool has the key "error"."""
    begin, tool, air, folder = time.monotonic(), stage.tool, stage.air, stage.folder
    facts = {"group": case.group, "label": case.label, "hidden": case.hidden, "z": case.z, "kept": case.kept}
    try:
        series, hidden = stage.series(case), None
        if case.group == "null in a sensor":
            disturb(case, air, series)
        elif not case.group.startswith("null"):
            hidden = hidden_of(case, air)
            size, rms, z = stage.size_of(case, hidden)
            hidden.change(air, series, size)
            facts |= {"size": size, "hidden_hpa": rms, "z_reached": z}
        flight, fitted, best = folder / "flight.nc", folder / "fitted.toml", folder / "best.toml"
        air.write(flight, series)
        arguments, user = stage.references(case.reference), folder / f"{case.reference}.toml"
        facts["fit_hpa"] = tool.json_of("refit", flight, "-m", user, "-o", fitted, *arguments)["rms_hpa"]
        diagnosis = tool.json_of("diagnose", flight, "-m", fitted, *arguments)
        improved = tool.json_of("improve", flight, "-m", user, "-o", best, *arguments)
        facts |= scoring.summary_of(diagnosis) | score_of(diagnosis, improved, hidden)
        facts["static_before"] = stage.static_error(flight, fitted)
        facts["static_after"] = stage.static_error(flight, best)
        facts["harm"] = facts["static_after"] > facts["static_before"] + HARM
    except (ToolError, OSError, ValueError, KeyError, TypeError) as error:
        facts["error"] = f"{type(error).__name__}: {error}"
    facts["seconds"] = round(time.monotonic() - begin, 2)
    return json.loads(json.dumps(facts, default=float))


def score_of(diagnosis, improved, hidden):
    sets = [scoring.names_in(finding) for finding in diagnosis["findings"]]
    verdict, traced = scoring.verdict_of(diagnosis), scoring.traced_in(diagnosis)
    held_out = [step["rms_holdout_hpa"] for step in improved["steps"] if step.get("rms_holdout_hpa") is not None]
    score = {"added": [step["added"] for step in improved["steps"] if step["added"]], "ladder": held_out,
             "ladder_worse": any(later > earlier + WORSE_STEP for earlier, later in zip(held_out, held_out[1:]))}
    right = set(hidden.right) if hidden else set()
    good = [bool(right & set(names)) for names in sets]
    score |= {"in_set": any(good), "identified": any(good) and len(sets[good.index(True)]) == 1 and verdict == "identified",
              "nothing_else": all(good), "named": bool(sets), "wrong": not all(good) and verdict != "partial",
              "sure_and_wrong": verdict == "identified" and not all(good),
              "both_told": any(good) and any(counterpart(name) in names for names, right_one in zip(sets, good) if right_one
                                             for name in right & set(names)),
              "silent": verdict == "silent", "structure": verdict != "silent" and not sets, "any_traced": bool(traced)}
    if hidden and hidden.traced:
        score |= {"traced_first": bool(traced) and traced[0] in hidden.traced,
                  "traced_among_five": bool(set(traced[:5]) & set(hidden.traced))}
    return score


def counterpart(name):
    """The same effect of the other system."""
    return name.removeprefix("reference:") if name.startswith("reference:") else "reference:" + name

