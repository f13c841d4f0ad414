"""The sub-commands of the tool as functions. Options have the names of the tool, with underscores: `min_airspeed=80` is
`--min-airspeed 80`, a list repeats the option, True is an option without a value, None and False are left out."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any, Optional, Sequence, Union

import xarray as xr

from . import _flight
from ._error import Error
from ._flight import PathLike
from ._model import Model
from ._result import Result
from ._tool import Progress, run

Flight = Union[PathLike, xr.Dataset, Result]
Flights = Union[Flight, Sequence[Flight]]
ModelLike = Union[PathLike, Model, Result]


def _word(value: Any, folder: Path) -> str:
    """A value as the tool takes it; what is in memory goes through a file in the folder."""
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
    text = run([command, *arguments, "--json=-"], progress).stdout
    return Result(command, arguments, text, files, written, progress)


def inspect(flights: Flights, **options: Any) -> Result:
    """What flights hold: aircraft, rates, the role of each variable, problems, and what their manoeuvres determine."""
    return _call("inspect", flights, options)


def compare(flights: Flights, *, model: Union[ModelLike, Sequence[ModelLike]], **options: Any) -> Result:
    """The residual of models against measurements of delta-p, by flight regime, hPa."""
    return _call("compare", flights, {"model": model, **options})


def refit(flights: Flights, *, model: ModelLike, output: Optional[PathLike] = None, **options: Any) -> Result:
    """Fits the free coefficients of a model. The result has the `fitted_model`; `output` keeps its file."""
    return _call("refit", flights, {"model": model, "output": output, **options}, "fitted.toml")


def diagnose(flights: Flights, *, model: ModelLike, **options: Any) -> Result:
    """Finds the physical effects that a fitted model lacks."""
    return _call("diagnose", flights, {"model": model, **options})


def improve(flights: Flights, *, model: ModelLike, output: Optional[PathLike] = None, **options: Any) -> Result:
    """Refits, diagnoses and adds missing effects in turn. The result has the `fitted_model`."""
    return _call("improve", flights, {"model": model, "output": output, **options}, "best.toml")


def check(flights: Flights, **options: Any) -> Result:
    """Tests a model by what it was not fitted to: redundant systems, manoeuvres, layers."""
    return _call("check", flights, options)


def temperature(flights: Flights, *, model: ModelLike, output: Optional[PathLike] = None, **options: Any) -> Result:
    """Calibrates the temperature, K, by GPS heights and the hydrostatic equation. The result has the `fitted_model`."""
    return _call("temperature", flights, {"model": model, "output": output, **options}, "fitted.toml")


def process(flights: Flights, *, output: Optional[PathLike] = None, **options: Any) -> Result:
    """Corrects flights by the real-time loop, with quality flags and uncertainties. Of one flight the result has the
    `dataset` with PCOR, PSXC, QCXC, MACHX, ATX, TASX and their units; several are written into the folder `output`."""
    several = isinstance(flights, (list, tuple)) and len(flights) > 1
    return _call("process", flights, {"output": output, **options}, "corrected" if several else "corrected.nc")


def simulate(scenario: PathLike, *, output: Optional[PathLike] = None, **options: Any) -> Result:
    """Simulates a flight whose true pressures are known. The result has the `dataset`."""
    name = "-".join([Path(scenario).stem, *(str(seed) for seed in [options.get("seed")] if seed is not None)])
    return _call("simulate", scenario, {"output": output, **options}, f"{name}.nc")


def effects(id: Optional[str] = None, **options: Any) -> Result:
    """The catalogue of effects, or all that is known of one."""
    return _call("effects", id, options)


def add(effects: Union[str, Sequence[str]], *, model: ModelLike, output: Optional[PathLike] = None,
        **options: Any) -> Result:
    """Adds effects to a model, with neutral coefficients: some of the catalogue, or with `formula` one of your own.
    The result has the `fitted_model`."""
    return _call("add", effects, {"model": model, "output": output, **options}, "extended.toml")


def help(command: str) -> str:
    """The help of the tool for a command, with all its options."""
    return run([command, "--help"]).stdout
