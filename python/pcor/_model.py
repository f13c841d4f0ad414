"""Models over arrays and sample by sample."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Iterable, Mapping, Optional, Union

import numpy as np
import xarray as xr

from . import _pcor
from ._error import Error
from ._flight import PathLike, values
from ._tool import data

quantities: dict[str, tuple[str, str, bool]] = _pcor.quantities
"""Quantities by name: unit, description, and True for a recorded quantity (a role)."""

quality: dict[str, tuple[int, str]] = _pcor.quality
"""Quality flags by name: bit and meaning."""

standard_names = {
    "corrected_static_pressure": "air_pressure",
    "ambient_temperature": "air_temperature",
    "lams_temperature": "air_temperature",
    "corrected_airspeed": "platform_speed_wrt_air",
}


def model_folders() -> list[Path]:
    """Folders of models that have names: the folders in the environment variable PCOR_MODELS, then the package."""
    own = [Path(folder) for folder in os.environ.get("PCOR_MODELS", "").split(":") if folder]
    return [*own, data / "models"]


def _find(source: str) -> Path:
    if os.path.exists(source) or "/" in source or source.endswith(".toml"):
        return Path(source)
    for folder in model_folders():
        if (folder / f"{source}.toml").is_file():
            return folder / f"{source}.toml"
    known = sorted({path.stem for folder in model_folders() for path in folder.glob("*.toml")})
    raise Error(f"there is no model file or model named '{source}'; models by name: {', '.join(known)}",
                "file")


class Model:
    """Model of delta-p, the correction that is added to the static and subtracted from the dynamic pressure.

    `source` is a name ("c130-psfd-eq18"), the path of a model file, or the text of a model file. Raises `Error` with
    code "file" if there is no such model, and "definition" if the text is not valid.
    """

    _definition: _pcor.ModelDefinition

    def __init__(self, source: Union[PathLike, "Model"]):
        self.path: Optional[Path] = None
        if isinstance(source, Model):
            self.path, self._definition = source.path, source._definition
        elif isinstance(source, str) and "\n" in source:
            self._definition = _pcor.ModelDefinition.parse(source, "model")
        else:
            self.path = _find(os.fspath(source))
            self._definition = _pcor.ModelDefinition.read(str(self.path))

    @property
    def name(self) -> str:
        return self._definition.name

    @property
    def variables(self) -> dict[str, str]:
        """The netCDF variable of each role."""
        return self._definition.variables

    @property
    def parameters(self) -> dict[str, float]:
        """Coefficients by name, e.g. "static-qp.a2", in the units of the model file."""
        return self._definition.parameters

    @property
    def text(self) -> str:
        """Text of the model file, without comments; it restores the model exactly."""
        return self._definition.text()

    def with_parameters(self, parameters: Mapping[str, float]) -> "Model":
        """Copy of the model with other values of the named coefficients."""
        changed = Model.__new__(Model)
        changed.path = None
        changed._definition = self._definition.with_parameters(dict(parameters))
        return changed

    def save(self, path: PathLike) -> None:
        """Writes the model file atomically."""
        self._definition.save(os.fspath(path))

    def delta_p(self, flight: Optional[xr.Dataset] = None, *, roles: Optional[Mapping[str, str]] = None,
                **recorded: Any) -> Union[np.ndarray, xr.DataArray]:
        """Delta-p, hPa, an array of the shape of the inputs: the result `static_defect` of `correct`."""
        return self.correct(flight, roles=roles, outputs=["static_defect"], **recorded)["static_defect"]

    def correct(self, flight: Optional[xr.Dataset] = None, *, roles: Optional[Mapping[str, str]] = None,
                outputs: Optional[Iterable[str]] = None, out: Optional[Mapping[str, np.ndarray]] = None,
                correct_with: str = "model", **recorded: Any) -> Union[dict[str, np.ndarray], xr.Dataset]:
        """Corrected pressures, and the quantities that follow from them, for arrays of samples.

        Give either a dataset `flight` or arrays. The model names the variables of the dataset by role; `roles`,
        {role: variable}, overrides it. Units are converted according to the attribute `units`. Arrays have one shape and
        the units of `pcor.quantities`; give recorded quantities by role and variables of formulas by name:

            model.correct(static_pressure=ps, dynamic_pressure=qc, recovery_temperature=tr)

        Contiguous doubles are not copied. NaN is missing. The results have the shape of the inputs: a dict of arrays, or
        for a flight a dataset with units and CF names. `outputs` are names of `pcor.quantities`; by default delta-p
        ("static_defect"), corrected pressures, Mach number, ambient temperature, airspeed, and the same quantities from
        the laser, if the inputs determine them. Results are written into the arrays of `out`, by name, if given: contiguous
        doubles of that shape that are not inputs. `correct_with` is "model" or "lams".

        There are no quality flags; effects of rates of change need the rates as inputs; `pcor.process` computes both.
        Raises `Error` if an input is absent, has another shape, or has a unit that cannot be converted.
        """
        if (flight is None) == (not recorded):
            raise Error("give either a flight or the recorded quantities as arrays", "usage")
        if flight is not None:
            names, recorded = self._recorded(flight, roles or {})
        batch = _pcor.ArrayModel(self._definition, list(recorded), correct_with)
        absent = [name for name in batch.inputs if name not in recorded]
        if flight is not None:
            for name in absent:
                recorded[name] = values(_variable(flight, name))
                names.append(name)
        for name, array in (out or {}).items():
            if not (isinstance(array, np.ndarray) and array.dtype == np.float64 and array.flags.carray
                    and all(array.shape == np.shape(each) and not np.may_share_memory(array, each)
                            for each in recorded.values())):
                raise Error(f"out['{name}'] is not a contiguous float64 array of the shape of the inputs that shares "
                            "no memory with them; make it by numpy.empty(shape)", "usage")
        results = batch.run(recorded, list(outputs) if outputs is not None else batch.outputs, out or {})
        return results if flight is None else _as_dataset(results, flight, names[0], self.name)

    correct.__doc__ = f"{correct.__doc__}\n        Recorded quantities:\n" + "".join(
        f"            {name}: {unit}, {text}\n" for name, (unit, text, is_recorded) in quantities.items() if is_recorded)

    def _recorded(self, flight: xr.Dataset, roles: Mapping[str, str]) -> tuple[list[str], dict[str, np.ndarray]]:
        names: list[str] = []
        recorded: dict[str, np.ndarray] = {}
        stated = self._definition.units
        for role, name in {**self.variables, **roles}.items():
            if role not in quantities or not quantities[role][2]:
                raise Error(f"there is no role '{role}'; pcor.quantities lists them", "variable")
            variable = _variable(flight, name)
            if names and variable.dims != flight[names[0]].dims:
                raise Error(f"'{name}' has the dimensions {variable.dims}, not those of '{names[0]}'; "
                            "pcor.process takes variables of several rates", "variable")
            names.append(name)
            if role == "date":
                days = (variable.data - np.datetime64("2000-01-01")) / np.timedelta64(1, "D")
                recorded[role] = values(days)
                continue
            scale, offset = _pcor.conversion(stated.get(role) or str(variable.attrs.get("units", "")),
                                             quantities[role][0], name)
            column = values(variable.data)
            recorded[role] = column if (scale, offset) == (1.0, 0.0) else column * scale + offset
        if not recorded:
            raise Error(f"model '{self.name}' names no variables; give roles={{'static_pressure': 'PSFD', ...}}",
                        "model")
        return names, recorded

    def __repr__(self) -> str:
        return f"<pcor.Model '{self.name}'>"


def _variable(flight: xr.Dataset, name: str) -> xr.DataArray:
    if name not in flight:
        raise Error(f"the flight has no variable '{name}'; give roles={{role: variable}}", "variable")
    return flight[name]


def _as_dataset(results: Mapping[str, np.ndarray], flight: xr.Dataset, like: str, model: str) -> xr.Dataset:
    template = flight[like]
    dataset = xr.Dataset(coords=template.coords, attrs={"source": f"pcor, model {model}"})
    for name, array in results.items():
        unit, description, _ = quantities[name]
        attributes = {"units": unit, "long_name": description}
        if name in standard_names:
            attributes["standard_name"] = standard_names[name]
        dataset[name] = xr.DataArray(array, dims=template.dims, attrs=attributes)
    return dataset


def model(source: Union[PathLike, Model]) -> Model:
    """The model with this name, path or text: `Model(source)`."""
    return Model(source)


class Loop:
    """Real-time loop: corrects sample by sample, with quality flags and uncertainties.

        loop = pcor.Loop("c130-psfd-eq18", rate=25)
        result = loop.run(0.04, static_pressure=700.0, dynamic_pressure=67.6, recovery_temperature=280.0)

    `rate` is in samples per second; `recorded` names the roles, by default those of the model. If the model has effects
    of rates of change, results belong to the sample of `delay` runs before.
    """

    def __init__(self, model: Union[PathLike, Model], rate: float, recorded: Optional[Iterable[str]] = None,
                 correct_with: str = "model"):
        definition = Model(model)._definition
        names = definition.variables if recorded is None else recorded
        self._loop = _pcor.NamedLoop(definition, list(names), rate, correct_with)

    @property
    def delay(self) -> int:
        """Number of runs between a sample and its results."""
        return self._loop.delay

    def run(self, time: float, **recorded: float) -> dict[str, float]:
        """Results of the sample at `time`, s, by the names of `pcor.quantities`, and the `quality` bits.

        Values are in the units of `pcor.quantities`, by role; a value that is not given is missing.
        """
        return self._loop.run(time, recorded)

    def reset(self) -> None:
        """Discards all previous samples."""
        self._loop.reset()

    @staticmethod
    def flags(bits: int) -> list[str]:
        """Names of the quality flags that are set."""
        return [name for name, (bit, _) in quality.items() if bits & bit]
