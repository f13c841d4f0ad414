"""The sub-commands of the tool as functions. Options have the names of the tool, with underscores: `min_airspeed=80` is
`--min-airspeed 80`. A list repeats the option, True is an option without a value, None and False omit the option."""

from __future__ import annotations

import os
import tempfile
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, Optional, Sequence, Union

import xarray as xr

from . import _flight
from ._descriptions import descriptions
from ._error import Error
from ._flight import PathLike
from ._model import Model
from ._result import Result
from ._tool import Progress, run

Flight = Union[PathLike, xr.Dataset, Result]
Flights = Union[Flight, Sequence[Flight]]
ModelLike = Union[PathLike, Model, Result]


def _word(value: Any, folder: Path) -> str:
    """The value as an argument of the tool. Models and flights in memory are written to files in the folder."""
    if isinstance(value, Result):
        if value.output is None:
            raise Error(f"the result of {value.command} is neither a model nor a flight", "usage")
        value = value.output
    if isinstance(value, str) and "\n" in value:
        value = Model(value)
    if isinstance(value, Model):
        if value.path is not None:
            return str(value.path)
        path = folder / f"model-{len(list(folder.iterdir()))}.toml"
        value.save(path)
        return str(path)
    if isinstance(value, xr.Dataset):
        return str(_flight.write(value, folder))
    return os.fspath(value) if isinstance(value, os.PathLike) else str(value)


def _call(command: str, inputs: Any, options: dict[str, Any], output: str = "") -> Result:
    files = tempfile.TemporaryDirectory(prefix="pcor-")
    folder = Path(files.name)
    progress: Optional[Progress] = options.pop("progress", None)
    given = [] if inputs is None else inputs if isinstance(inputs, (list, tuple)) else [inputs]
    arguments = [_word(value, folder) for value in given]
    written: Optional[Path] = None
    if output:
        place = options.pop("output", None)
        written = folder / "output" / output if place is None else Path(place)
        if place is None:
            written.parent.mkdir()
        arguments.append(f"--output={written}" + ("/" if str(place).endswith("/") else ""))
    for name, value in options.items():
        option = "--" + name.rstrip("_").replace("_", "-")
        for each in value if isinstance(value, (list, tuple)) else [value]:
            if each is True:
                arguments.append(option)
            elif each is not None and each is not False:
                arguments.append(f"{option}={_word(each, folder)}")
    return Result(command, arguments, files, written, progress)


def inspect(flights: Flights, **options: Any) -> Result:
    """Shows the content of flights: aircraft, rates, roles of the variables, problems, manoeuvres."""
    return _call("inspect", flights, options)


def compare(flights: Flights, *, model: Union[ModelLike, Sequence[ModelLike]], **options: Any) -> Result:
    """Compares models with measurements of delta-p, by flight regime. Residuals are in hPa, reference minus model."""
    return _call("compare", flights, {"model": model, **options})


def refit(flights: Flights, *, model: ModelLike, output: Optional[PathLike] = None, **options: Any) -> Result:
    """Fits the free coefficients of a model. `fitted_model` of the result is the new model; `output` is its file."""
    return _call("refit", flights, {"model": model, "output": output, **options}, "fitted.toml")


def diagnose(flights: Flights, *, model: ModelLike, **options: Any) -> Result:
    """Finds the physical effects that a fitted model lacks."""
    return _call("diagnose", flights, {"model": model, **options})


def improve(flights: Flights, *, model: ModelLike, output: Optional[PathLike] = None, **options: Any) -> Result:
    """Refits, diagnoses and adds missing effects, one at a time. `fitted_model` of the result is the new model."""
    return _call("improve", flights, {"model": model, "output": output, **options}, "best.toml")


def check(flights: Flights, **options: Any) -> Result:
    """Tests a model with data outside its fit: redundant systems, manoeuvres, layers."""
    return _call("check", flights, options)


def temperature(flights: Flights, *, model: ModelLike, output: Optional[PathLike] = None, **options: Any) -> Result:
    """Calibrates the temperature, K, with GPS heights and the hydrostatic equation. `fitted_model` of the result is the
    new model."""
    return _call("temperature", flights, {"model": model, "output": output, **options}, "fitted.toml")


def process(flights: Flights, *, output: Optional[PathLike] = None, **options: Any) -> Result:
    """Corrects flights with the real-time loop, with quality flags and uncertainties. For one flight, `dataset` of the
    result has PCOR, PSXC, QCXC, MACHX, ATX, TASX with units; several flights are written to the folder `output`."""
    several = isinstance(flights, (list, tuple)) and len(flights) > 1
    return _call("process", flights, {"output": output, **options}, "corrected" if several else "corrected.nc")


def simulate(scenario: PathLike, *, output: Optional[PathLike] = None, **options: Any) -> Result:
    """Simulates a flight with known true pressures. `dataset` of the result is the flight."""
    name = "-".join([Path(scenario).stem, *(str(seed) for seed in [options.get("seed")] if seed is not None)])
    return _call("simulate", scenario, {"output": output, **options}, f"{name}.nc")


def effects(id: Optional[str] = None, **options: Any) -> Result:
    """Lists the catalogue of effects, or describes one effect."""
    return _call("effects", id, options)


def add(effects: Union[str, Sequence[str]], *, model: ModelLike, output: Optional[PathLike] = None,
        **options: Any) -> Result:
    """Adds effects to a model, with neutral coefficients: effects of the catalogue, or a new effect with `formula`.
    `fitted_model` of the result is the new model."""
    return _call("add", effects, {"model": model, "output": output, **options}, "extended.toml")


def help(command: str) -> str:
    """The help of the tool for a command, with all options."""
    return run([command, "--help"]).stdout


def _describe() -> None:
    """Sets docstring and signature of each command, so that editors complete the options."""
    for name, (text, options) in descriptions.items():
        command = globals()[name]
        command.__doc__ = text
        own = [each for each in signature(command).parameters.values() if each.kind is not Parameter.VAR_KEYWORD]
        added = [Parameter(each, Parameter.KEYWORD_ONLY, default=None) for each in (*options, "progress")]
        command.__signature__ = signature(command).replace(parameters=own + added)


_describe()
