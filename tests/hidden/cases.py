"""One case: simulated flights with hidden effects, runs of the tool, and the results."""

import resource
import shutil
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy

import instruments
import nulls
import plans
import scoring
import secret_effects
import strength
from records import Records, without_truth
from tool_runs import ToolError

OUTLIER = 5.0  # times the robust scatter of the baseline; such held-out samples are excluded from baseline and case


@dataclass(frozen=True)
class Case:
    kind: str  # null, single, pair, other, two systems, outside
    name: str
    plan: plans.Plan
    noise: str = "ar"
    trouble: str = "none"
    start: str = "right"  # initial coefficients of the user's model, see plans.STARTS
    seed: int = 0
    secrets: tuple = ()  # names of hidden effects
    times: float = 0.0  # size / usual size of the hidden effects
    improve: bool = True

    @property
    def label(self):
        return (f"{self.name}, {self.times:g} times the usual size, {self.plan}, noise {self.noise}, {self.trouble}, "
                f"start {self.start}, seed {self.seed}")

    @property
    def world(self):
        return f"{self.plan}-{self.noise}-{self.trouble}-{self.seed}".replace(" ", "_").replace("/", "")


@dataclass
class Setting:
    """Settings shared by all cases of a run."""

    tool: object
    folder: Path
    improve: bool = True


@dataclass(frozen=True)
class UserInputs:
    """Model and reference of the user: effects missing from the model (`without`), moist air, laser."""

    without: tuple = ()
    moist: bool = True
    laser: bool = True

    def model(self, folder, aircraft, start="right"):
        path = folder / f"user-{start}.toml".replace(" ", "-")
        path.write_text(plans.model_text(aircraft, self.without, self.moist, start, self.laser))
        return path

    def arguments(self, folder):
        if self.laser:
            return ()
        path = folder / "second.toml"
        path.write_text(plans.second_model_text())
        return ("--reference", f"static:{path}")


def user_inputs_of(secrets, aircraft):
    without = tuple(name for secret in secrets for name in secret_effects.lacking(secret, plans.LAWS[aircraft]))
    return UserInputs(without, all(secret.moist for secret in secrets), all(secret.laser for secret in secrets))


def simulate(setting, folder, case, part, without, hidden=()):
    """Flight with ideal instruments; `hidden` lists secrets with their sizes."""
    flight, scenario = folder / f"flight{part}.nc", folder / "scenario.toml"
    effects = "\n\n".join(secret.text(case.plan.aircraft, size) for secret, size in hidden)
    scenario.write_text(plans.scenario_text(case.plan, part, 10 * case.seed + part, effects, without))
    setting.tool.run("simulate", scenario, "-o", flight, "--quiet")
    records = Records(flight, part)
    for secret, size in hidden:
        if secret.change:
            secret.change(records, size)
    records.write()
    return flight


def record(case, part, flight, truth=None):
    """Adds instrument errors to the flight and moves the variables of the simulator (TRUE_...) to `truth`."""
    pair = (plans.STATIC[case.plan.aircraft], "QCF")
    instruments.record(flight, pair, case.noise, {case.trouble}, [case.seed, part])
    without_truth(flight, truth)


@dataclass
class Baseline:
    """The same flights without hidden effects, with a fit of the right model."""

    rms: float  # held-out residual, hPa
    held_out: object  # held-out residual of each sample, hPa; NaN for outliers
    ideal: object  # residual of the training flights without noise, hPa
    columns: object  # derivatives with respect to the user's coefficients on the training flights


def baseline_of(setting, folder, case, inputs):
    """Baseline of a case, stored in a file, because several cases share it."""
    laser = "laser" if inputs.laser else "second"
    kept = setting.folder / ("-".join(("baseline", case.world, laser, *inputs.without)) + ".npz")
    if not kept.exists():
        arguments = inputs.arguments(folder)
        right = UserInputs(inputs.without, True, inputs.laser).model(folder, case.plan.aircraft)
        flights = [simulate(setting, folder, case, part, inputs.without) for part in (0, 1, 2)]
        ideal = [strength.residual_of(setting.tool, flight, right, folder, arguments) for flight in flights[:2]]
        columns = [strength.columns_of(flight, case.plan.aircraft, inputs.without) for flight in flights[:2]]
        for part, flight in enumerate(flights):
            record(case, part, flight)
        fitted = folder / "baseline.toml"
        setting.tool.run("refit", *flights[:2], "-m", right, "-o", fitted, "--quiet", *arguments)
        residual = strength.residual_of(setting.tool, flights[2], fitted, folder, arguments)
        part = kept.with_suffix(f".{id(case)}.npz")
        numpy.savez(part, residual=residual, ideal=numpy.concatenate(ideal), columns=numpy.concatenate(columns))
        part.replace(kept)
    with numpy.load(kept) as file:
        residual, ideal, columns = file["residual"], file["ideal"], file["columns"]
    scatter = 1.4826 * numpy.nanmedian(numpy.abs(residual))
    residual[~(numpy.abs(residual) < OUTLIER * scatter)] = numpy.nan
    rms = float(numpy.sqrt(numpy.nanmean(residual**2)))
    return Baseline(rms, residual, ideal, columns)


def rms_where(values, used):
    both = numpy.isfinite(values) & used
    return float(numpy.sqrt((values[both] ** 2).mean()))


def static_error(setting, folder, flight, truth, model, used):
    """Rms error of the corrected static pressure, hPa, in samples `used` above 300 m and 70 m/s with flaps below 5 %."""
    output = folder / "processed.nc"
    setting.tool.run("process", flight, "-m", model, "-o", output, "--quiet")
    (corrected,) = strength.read(output, "PSXC")
    true, speed, height, flaps = strength.read(truth, "TRUE_PS", "TRUE_TAS", "RALT", "FLAPS")
    output.unlink()
    return rms_where(corrected - true, used & (speed > 70) & (flaps < 5) & (height > 300))


def visible(setting, folder, case, inputs, baseline, hidden):
    """Rms of the hidden effects, hPa: the part that the user's fitted model does not absorb, and the total."""
    model, arguments = inputs.model(folder, case.plan.aircraft), inputs.arguments(folder)
    flights = [simulate(setting, folder, case, part, inputs.without, hidden) for part in (0, 1)]
    residual = numpy.concatenate([strength.residual_of(setting.tool, flight, model, folder, arguments)
                                  for flight in flights])
    return strength.unabsorbed(residual - baseline.ideal, baseline.columns)


def hide(setting, folder, case, inputs, baseline):
    """Secrets with their sizes, and a description of each. Assumes that effects are linear in their size."""
    hidden, descriptions = [], []
    for number, name in enumerate(case.secrets):
        secret = secret_effects.BY_NAME[name]
        unabsorbed, total = visible(setting, folder, case, inputs, baseline, [(secret, secret.usual)])
        times = min(case.times, secret_effects.MAX_RMS / max(total, 1e-9)) if secret.scalable else 1.0
        sign = -1 if secret.both_signs and (case.seed + number) % 2 else 1
        hidden.append((secret, sign * times * secret.usual))
        descriptions.append({"effect": name, "strength": hidden[-1][1], "times_usual": times,
                             "snr": unabsorbed * times / baseline.rms})
    return hidden, descriptions


def run_case(setting, case):
    """Result of a case as a dictionary for JSON. A failed run of the tool has the key "error"."""
    begin, work = time.monotonic(), processor_seconds()
    facts = {"kind": case.kind, "name": case.name, "label": case.label, "plan_kind": case.plan.kind,
             "noise": case.noise, "trouble": case.trouble, "start": case.start, "secrets": list(case.secrets)}
    if case.kind == "null":
        facts |= nulls.run_case(setting.tool, nulls.null_case(*case.secrets))
    else:
        folder = Path(tempfile.mkdtemp(dir=setting.folder))
        try:
            facts |= run_hidden(setting, folder, case)
        except (ToolError, OSError, ValueError, KeyError) as error:
            facts["error"] = f"{type(error).__name__}: {error}"
        finally:
            shutil.rmtree(folder)
    facts["seconds"] = round(time.monotonic() - begin, 2)
    facts["processor_seconds"] = round(processor_seconds() - work, 2)
    return facts


def processor_seconds():
    """Processor time of this process and of its runs of the tool, s."""
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def run_hidden(setting, folder, case):
    tool, aircraft = setting.tool, case.plan.aircraft
    secrets = [secret_effects.BY_NAME[name] for name in case.secrets]
    inputs = user_inputs_of(secrets, aircraft)
    arguments = inputs.arguments(folder)
    baseline = baseline_of(setting, folder, case, inputs)
    hidden, descriptions = hide(setting, folder, case, inputs, baseline)
    improve = case.improve and setting.improve
    facts = {"hidden": descriptions, "snr": min(each["snr"] for each in descriptions), "noise_hpa": baseline.rms,
             "static": all(secret.static for secret in secrets)}

    truth = folder / "truth.nc"
    flights = [simulate(setting, folder, case, part, inputs.without, hidden)
               for part in ((0, 1, 2) if improve else (0, 1))]
    for part, flight in enumerate(flights):
        record(case, part, flight, truth if part == 2 else None)
    user, fitted, best = inputs.model(folder, aircraft, case.start), folder / "fitted.toml", folder / "best.toml"
    facts["fit_hpa"] = tool.json_of("refit", *flights[:2], "-m", user, "-o", fitted, *arguments)["rms_hpa"]

    begin = time.monotonic()
    diagnosis = tool.json_of("diagnose", *flights[:2], "-m", fitted, *arguments)
    facts["diagnose_seconds"] = round(time.monotonic() - begin, 2)
    facts["diagnosis"] = scoring.summary_of(diagnosis)
    facts["score"] = scoring.of_hidden(diagnosis, secrets)
    if improve:
        used = numpy.isfinite(baseline.held_out)
        residual = strength.residual_of(tool, flights[2], fitted, folder, arguments)
        facts["held_out_before"] = rms_where(residual, used) / baseline.rms
        facts["static_before"] = static_error(setting, folder, flights[2], truth, fitted, used)
        begin = time.monotonic()
        improvement = tool.json_of("improve", *flights[:2], "-m", user, "-o", best, *arguments)
        facts["improve_seconds"] = round(time.monotonic() - begin, 2)
        facts["added"] = [step["added"] for step in improvement["steps"] if step["added"]]
        residual = strength.residual_of(tool, flights[2], best, folder, arguments)
        facts["held_out_after"] = rms_where(residual, used) / baseline.rms
        facts["static_after"] = static_error(setting, folder, flights[2], truth, best, used)
    return facts
