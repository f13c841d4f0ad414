"""One case: flights with a secret, the tool on them as a user would run it, and what came out."""

import resource
import shutil
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import netCDF4
import numpy

import plans
import scoring
import secret_effects
import strength
from tool_runs import ToolError

OUTLIER = 5.0  # times the robust scatter: such held-out samples are left out for twin and case alike


@dataclass(frozen=True)
class Case:
    kind: str  # null, single, pair, outside
    name: str
    plan: plans.Plan
    noise: str
    seed: int
    snr: float = 0.0
    secrets: tuple = ()
    improve: bool = True

    @property
    def label(self):
        return f"{self.name}, SNR {self.snr}, {self.plan}, noise {self.noise}, seed {self.seed}"


@dataclass
class Setting:
    """What all cases of a run share."""

    tool: object
    folder: Path
    diagnose: bool = True
    improve: bool = True
    twins: dict = field(default_factory=dict)

    @property
    def cache(self):
        path = self.folder / "calibration"
        path.mkdir(exist_ok=True, parents=True)
        return path


def without_truth(flight, kept):
    """What the aircraft recorded, and nothing that only a simulator knows. The truth goes to `kept`."""
    with netCDF4.Dataset(flight) as file:
        file.set_auto_maskandscale(False)
        recorded = flight.with_name("recorded.nc")
        with netCDF4.Dataset(recorded, "w") as copy:
            copy.set_fill_off()
            for name, dimension in file.dimensions.items():
                copy.createDimension(name, None if dimension.isunlimited() else len(dimension))
            told = ("simulation_effects", "simulation_legs", "history")
            copy.setncatts({name: file.getncattr(name) for name in file.ncattrs() if name not in told})
            for name, variable in file.variables.items():
                if name.startswith("TRUE_"):
                    continue
                attributes = {key: variable.getncattr(key) for key in variable.ncattrs()}
                made = copy.createVariable(name, variable.dtype, variable.dimensions, chunksizes=[len(variable)],
                                           fill_value=attributes.pop("_FillValue", None))
                made.set_auto_maskandscale(False)
                made.setncatts(attributes)
                made[:] = variable[:]
    if kept is None:
        flight.unlink()
    else:
        flight.replace(kept)
    recorded.replace(flight)


def simulate(setting, folder, case, part, effects, without, truth=None):
    flight = folder / f"flight{part}.nc"
    scenario = folder / "scenario.toml"
    scenario.write_text(plans.scenario_text(case.plan, part, 10 * case.seed + part, case.noise, effects,
                                            without=without))
    setting.tool.run("simulate", scenario, "-o", flight, "--quiet")
    without_truth(flight, truth)
    return flight


@dataclass
class Twin:
    """The same flights with nothing hidden: what the best model could reach."""

    noise: float  # rms of the training flights, hPa; with spikes that of the held-out flight without them
    held_out: object = None  # residual of every sample, hPa
    rms: float = 0.0


def twin_of(setting, folder, case, without, arguments):
    """Made once for flights that cases share, and kept in a file."""
    words = f"{case.plan}-{case.noise}-{case.seed}-{'-'.join((*without, *arguments))}".replace(" ", "_")
    kept = setting.folder / f"twin-{words}.npz"
    if not kept.exists():
        flights = [simulate(setting, folder, case, part, "", without) for part in (0, 1, 2)]
        user, fitted = folder / "user.toml", folder / "twin.toml"
        user.write_text(plans.model_text(case.plan.aircraft, without))
        fit = setting.tool.json_of("refit", *flights[:2], "-m", user, "-o", fitted, *arguments)
        residual = strength.residual_of(setting.tool, flights[2], fitted, folder, arguments)
        part = kept.with_suffix(f".{id(case)}.npz")
        numpy.savez(part, noise=fit["rms_hpa"], residual=residual)
        part.replace(kept)
    with numpy.load(kept) as file:
        noise, residual = float(file["noise"]), file["residual"]
    scatter = 1.4826 * numpy.nanmedian(numpy.abs(residual))
    residual[~(numpy.abs(residual) < OUTLIER * scatter)] = numpy.nan
    rms = float(numpy.sqrt(numpy.nanmean(residual**2)))
    return Twin(rms if case.noise == "B" else noise, residual, rms)  # spikes are no noise that an effect hides in


def rms_where(values, used):
    both = numpy.isfinite(values) & used
    return float(numpy.sqrt((values[both] ** 2).mean()))


def static_error(setting, folder, flight, truth, model):
    """The rms of the corrected static pressure against the true one, in the air with flaps up, hPa."""
    output = folder / "processed.nc"
    setting.tool.run("process", flight, "-m", model, "-o", output, "--quiet")
    (found,) = strength.read(output, "PSXC")
    right, speed, height, flaps = strength.read(truth, "TRUE_PS", "TRUE_TAS", "RALT" if has(truth, "RALT") else "GGALT",
                                                "FLAPS")
    output.unlink()
    return rms_where(found - right, (speed > 70) & (flaps < 5) & (height > 300))


def has(path, name):
    with netCDF4.Dataset(path) as file:
        return name in file.variables


def hide(setting, folder, case, without, noise):
    """The text of the effects, with strengths for the SNR."""
    calibration = strength.Calibration(setting.tool, folder, setting.cache)
    texts, told, absorbed = [], [], False
    for number, name in enumerate(case.secrets):
        secret = secret_effects.BY_NAME[name]
        size, rms, beyond = calibration.strength_of(secret, case.plan, case.snr * noise)
        if secret.both_signs and (case.seed + number) % 2:
            size = -size
        texts.append(secret.text(case.plan.aircraft, size))
        told.append({"effect": name, "strength": size, "times_usual": size / secret.usual, "snr": rms / noise})
        absorbed = absorbed or beyond
    return "\n\n".join(texts), told, absorbed


def run_case(setting, case):
    """The facts of a case as a dictionary for JSON. An error of the tool is a fact, too."""
    begin, work = time.monotonic(), processor_seconds()
    facts = {"kind": case.kind, "name": case.name, "plan": str(case.plan), "plan_kind": case.plan.kind,
             "aircraft": case.plan.aircraft, "noise": case.noise, "seed": case.seed, "snr": case.snr,
             "secrets": list(case.secrets)}
    folder = Path(tempfile.mkdtemp(dir=setting.folder))
    try:
        facts |= (run_null if case.kind == "null" else run_hidden)(setting, folder, case)
    except (ToolError, OSError, ValueError, KeyError) as error:
        facts["error"] = f"{type(error).__name__}: {error}"
    finally:
        shutil.rmtree(folder)
    facts["seconds"] = round(time.monotonic() - begin, 2)
    facts["processor_seconds"] = round(processor_seconds() - work, 2)
    return facts


def processor_seconds():
    """Of this process and of the runs of the tool that it waited for."""
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def diagnosed(setting, flights, fitted, arguments, facts):
    if not setting.diagnose:
        return {}
    begin = time.monotonic()
    diagnosis = setting.tool.json_of("diagnose", *flights, "-m", fitted, *arguments)
    facts["diagnose_seconds"] = round(time.monotonic() - begin, 2)
    facts["diagnosis"] = scoring.summary_of(diagnosis)
    return diagnosis


def run_null(setting, folder, case):
    flight = simulate(setting, folder, case, 0, "", ())
    user, fitted = folder / "user.toml", folder / "fitted.toml"
    user.write_text(plans.model_text(case.plan.aircraft))
    facts = {"noise_hpa": setting.tool.json_of("refit", flight, "-m", user, "-o", fitted)["rms_hpa"]}
    if diagnosis := diagnosed(setting, [flight], fitted, (), facts):
        facts["score"] = scoring.of_null(diagnosis)
    return facts


def run_hidden(setting, folder, case):
    tool, aircraft = setting.tool, case.plan.aircraft
    secrets = [secret_effects.BY_NAME[name] for name in case.secrets]
    without = tuple(name for secret in secrets for name in secret_effects.lacking(secret, plans.LAWS[aircraft]))
    arguments = tuple(word for secret in secrets for word in secret.arguments)
    twin = twin_of(setting, folder, case, without, arguments)
    effects, told, absorbed = hide(setting, folder, case, without, twin.noise)
    facts = {"hidden": told, "absorbed": absorbed, "noise_hpa": twin.noise}
    if not all(secret.scalable for secret in secrets):  # its size is what it is
        facts["snr"] = round(told[0]["snr"], 1)

    truth = folder / "truth.nc"
    flights = [simulate(setting, folder, case, part, effects, without, truth if part == 2 else None)
               for part in ((0, 1, 2) if case.improve and setting.improve else (0, 1))]
    user, fitted, best = folder / "user.toml", folder / "fitted.toml", folder / "best.toml"
    user.write_text(plans.model_text(aircraft, without, all(secret.moist for secret in secrets)))
    facts["fit_hpa"] = tool.json_of("refit", *flights[:2], "-m", user, "-o", fitted, *arguments)["rms_hpa"]

    if diagnosis := diagnosed(setting, flights[:2], fitted, arguments, facts):
        facts["score"] = scoring.of_hidden(diagnosis, secrets)
    if setting.improve and case.improve:
        used = numpy.isfinite(twin.held_out)
        residual = strength.residual_of(tool, flights[2], fitted, folder, arguments)
        facts["held_out_before"] = rms_where(residual, used) / twin.rms
        facts["static_before"] = static_error(setting, folder, flights[2], truth, fitted)
        begin = time.monotonic()
        improvement = tool.json_of("improve", *flights[:2], "-m", user, "-o", best, *arguments)
        facts["improve_seconds"] = round(time.monotonic() - begin, 2)
        facts["added"] = [step["added"] for step in improvement["steps"] if step["added"]]
        residual = strength.residual_of(tool, flights[2], best, folder, arguments)
        facts["held_out_after"] = rms_where(residual, used) / twin.rms
        facts["static_after"] = static_error(setting, folder, flights[2], truth, best)
    return facts
