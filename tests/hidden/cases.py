"""One case: flights with a secret, a run of the tool as by a user, and the results."""

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

OUTLIER = 5.0  # times the robust scatter: such held-out samples are left out for twin and case alike


@dataclass(frozen=True)
class Case:
    kind: str  # null, single, pair, other, two systems, outside
    name: str
    plan: plans.Plan
    noise: str = "ar"
    trouble: str = "none"
    start: str = "right"  # of the user's coefficients, see plans.STARTS
    seed: int = 0
    secrets: tuple = ()
    times: float = 0.0  # the usual size
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
    diagnose: bool = True
    improve: bool = True


@dataclass(frozen=True)
class Question:
    """The user's side of a case: missing terms of the model, further inputs of the tool."""

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


def question_of(secrets, aircraft):
    without = tuple(name for secret in secrets for name in secret_effects.lacking(secret, plans.LAWS[aircraft]))
    return Question(without, all(secret.moist for secret in secrets), all(secret.laser for secret in secrets))


def simulate(setting, folder, case, part, without, hidden=()):
    """A flight of ideal instruments; `hidden` are secrets with their strengths."""
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
    """Real instruments on the flight; values known only to the simulator are written to `truth`."""
    pair = (plans.STATIC[case.plan.aircraft], "QCF")
    instruments.record(flight, pair, case.noise, {case.trouble}, [case.seed, part])
    without_truth(flight, truth)


@dataclass
class Twin:
    """The same flights with nothing hidden: what the best model could reach."""

    noise: float  # rms, hPa
    held_out: object = None  # residual of every sample, hPa
    rms: float = 0.0
    ideal: object = None  # residual of the training flights without noise, hPa
    columns: object = None  # what the coefficients of the user's model multiply there


def twin_of(setting, folder, case, question):
    """Made once for flights that cases share, and kept in a file."""
    laser = "laser" if question.laser else "second"
    kept = setting.folder / ("-".join(("twin", case.world, laser, *question.without)) + ".npz")
    if not kept.exists():
        arguments = question.arguments(folder)
        right = Question(question.without, True, question.laser).model(folder, case.plan.aircraft)
        flights = [simulate(setting, folder, case, part, question.without) for part in (0, 1, 2)]
        ideal = [strength.residual_of(setting.tool, flight, right, folder, arguments) for flight in flights[:2]]
        columns = [strength.columns_of(flight, case.plan.aircraft, question.without) for flight in flights[:2]]
        for part, flight in enumerate(flights):
            record(case, part, flight)
        fitted = folder / "twin.toml"
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
    return Twin(rms, residual, rms, ideal, columns)


def rms_where(values, used):
    both = numpy.isfinite(values) & used
    return float(numpy.sqrt((values[both] ** 2).mean()))


def static_error(setting, folder, flight, truth, model, used):
    """The rms of the corrected static pressure against the true one, in the air with flaps up, hPa."""
    output = folder / "processed.nc"
    setting.tool.run("process", flight, "-m", model, "-o", output, "--quiet")
    (found,) = strength.read(output, "PSXC")
    right, speed, height, flaps = strength.read(truth, "TRUE_PS", "TRUE_TAS", "RALT", "FLAPS")
    output.unlink()
    return rms_where(found - right, used & (speed > 70) & (flaps < 5) & (height > 300))


def visible(setting, folder, case, question, twin, hidden):
    """Part of the secrets that the user's fitted model does not absorb, and their full size, hPa rms."""
    model, arguments = question.model(folder, case.plan.aircraft), question.arguments(folder)
    flights = [simulate(setting, folder, case, part, question.without, hidden) for part in (0, 1)]
    residual = numpy.concatenate([strength.residual_of(setting.tool, flight, model, folder, arguments)
                                  for flight in flights])
    return strength.left_over(residual - twin.ideal, twin.columns)


def hide(setting, folder, case, question, twin):
    """Secrets with their sizes, and a description of each; effects are nearly linear in their size."""
    hidden, told = [], []
    for number, name in enumerate(case.secrets):
        secret = secret_effects.BY_NAME[name]
        left, whole = visible(setting, folder, case, question, twin, [(secret, secret.usual)])
        times = min(case.times, secret_effects.LARGEST / max(whole, 1e-9)) if secret.scalable else 1.0
        sign = -1 if secret.both_signs and (case.seed + number) % 2 else 1
        hidden.append((secret, sign * times * secret.usual))
        told.append({"effect": name, "strength": hidden[-1][1], "times_usual": times,
                     "snr": left * times / twin.noise})
    return hidden, told


def run_case(setting, case):
    """The facts of a case as a dictionary for JSON. An error of the tool is a fact, too."""
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
    """Processor time of this process and of its runs of the tool."""
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def run_hidden(setting, folder, case):
    tool, aircraft = setting.tool, case.plan.aircraft
    secrets = [secret_effects.BY_NAME[name] for name in case.secrets]
    question = question_of(secrets, aircraft)
    arguments = question.arguments(folder)
    twin = twin_of(setting, folder, case, question)
    hidden, told = hide(setting, folder, case, question, twin)
    improve = case.improve and setting.improve
    facts = {"hidden": told, "snr": min(each["snr"] for each in told), "noise_hpa": twin.noise,
             "static": all(secret.static for secret in secrets)}

    truth = folder / "truth.nc"
    flights = [simulate(setting, folder, case, part, question.without, hidden)
               for part in ((0, 1, 2) if improve else (0, 1))]
    for part, flight in enumerate(flights):
        record(case, part, flight, truth if part == 2 else None)
    user, fitted, best = question.model(folder, aircraft, case.start), folder / "fitted.toml", folder / "best.toml"
    facts["fit_hpa"] = tool.json_of("refit", *flights[:2], "-m", user, "-o", fitted, *arguments)["rms_hpa"]

    if setting.diagnose:
        begin = time.monotonic()
        diagnosis = tool.json_of("diagnose", *flights[:2], "-m", fitted, *arguments)
        facts["diagnose_seconds"] = round(time.monotonic() - begin, 2)
        facts["diagnosis"] = scoring.summary_of(diagnosis)
        facts["score"] = scoring.of_hidden(diagnosis, secrets)
    if improve:
        used = numpy.isfinite(twin.held_out)
        residual = strength.residual_of(tool, flights[2], fitted, folder, arguments)
        facts["held_out_before"] = rms_where(residual, used) / twin.rms
        facts["static_before"] = static_error(setting, folder, flights[2], truth, fitted, used)
        begin = time.monotonic()
        improvement = tool.json_of("improve", *flights[:2], "-m", user, "-o", best, *arguments)
        facts["improve_seconds"] = round(time.monotonic() - begin, 2)
        facts["added"] = [step["added"] for step in improvement["steps"] if step["added"]]
        residual = strength.residual_of(tool, flights[2], best, folder, arguments)
        facts["held_out_after"] = rms_where(residual, used) / twin.rms
        facts["static_after"] = static_error(setting, folder, flights[2], truth, best, used)
    return facts
