"""Results of commands."""

from __future__ import annotations

import html
import json
import tempfile
from pathlib import Path
from typing import Any, Optional

import xarray as xr

from . import _flight
from ._error import Error
from ._flight import PathLike
from ._model import Model
from ._tool import Progress, run


class Fields(dict[str, Any]):
    """JSON object whose keys are also attributes: `result.models[0].rms_hpa`."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"there is no field '{name}'; the fields are {', '.join(self)}") from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]


def _rows(result: "Result", name: str) -> list[dict[str, Any]]:
    """Rows of a table: the list `name` of the result or of each of its models, or one row per coefficient or role."""
    if name == "coefficients":
        return [{"effect": effect["id"], "parameter": parameter, "value": value,
                 "stderr": effect["stderr"].get(parameter), "start": effect.get("start", {}).get(parameter)}
                for effect in result["effects"] for parameter, value in effect["parameters"].items()]
    if name == "roles":
        return [{"flight": flight["path"], "role": role, **variable}
                for flight in result["flights"] for role, variable in flight["roles"].items()]
    if name in result.fields and isinstance(result[name], list):
        return [dict(row) for row in result[name]]
    if any(name in model for model in result.fields.get("models", [])):
        return [{"model": model["name"], "reference": model["reference"], **row}
                for model in result["models"] for row in model[name]]
    raise Error(f"there is no table '{name}' in this result", "usage")


def _without_outputs(text: str) -> Any:
    """The result without the names of written files, which differ from run to run."""
    return json.loads(text, object_hook=lambda each: {key: value for key, value in each.items()
                                                      if key not in ("model", "output", "choices")})


_tables = {"compare": "regimes", "refit": "coefficients", "diagnose": "findings", "improve": "steps",
           "check": "checks", "inspect": "roles", "effects": "effects"}


class Result:
    """Result of a command: the fields of the tool's JSON as attributes and items; an unknown number is None.

    `text` is the text that the tool prints, `output` the path of the model or flight that the command wrote.
    """

    def __init__(self, command: str, arguments: list[str], files: tempfile.TemporaryDirectory[str],
                 output: Optional[Path], progress: Optional[Progress]):
        self.command = command
        self.output = output
        self._arguments = arguments
        self._files = files  # deleted with the result
        self._progress = progress
        self._json, self.text = self._run(arguments)
        self.fields: Fields = json.loads(self._json, object_hook=Fields)
        self._residuals: Optional[list[xr.Dataset]] = None

    def _run(self, arguments: list[str]) -> tuple[str, str]:
        """Runs the command. Returns the JSON and the text."""
        path = Path(self._files.name) / "result.json"
        lines = run([self.command, *arguments, f"--json={path}"], self._progress).stdout.splitlines()
        return path.read_text(), "\n".join(line for line in lines if str(path) not in line)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "fields":
            raise AttributeError(name)
        return getattr(self.fields, name)

    def __getitem__(self, name: str) -> Any:
        return self.fields[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.fields]

    def to_json(self) -> str:
        """The JSON of the tool, byte for byte."""
        return self._json

    def to_dict(self) -> dict[str, Any]:
        """The JSON of the tool as dicts and lists."""
        fields: dict[str, Any] = json.loads(self._json)
        return fields

    @property
    def fitted_model(self) -> Model:
        """The model that the command wrote (refit, improve, temperature, add)."""
        if self.output is None or self.output.suffix != ".toml":
            raise Error(f"{self.command} writes no model", "usage")
        return Model(self.output)

    @property
    def dataset(self) -> xr.Dataset:
        """The flight that the command wrote (process, simulate), loaded into memory."""
        if self.output is None or self.output.suffix != ".nc":
            raise Error(f"{self.command} writes no single flight", "usage")
        with _flight.open(self.output) as flight:
            return flight.load()

    def report(self, path: PathLike) -> None:
        """Writes the report, a self-contained HTML file. The command runs again on the same inputs."""
        self._again(f"--report={path}")

    def residuals(self) -> list[xr.Dataset]:
        """Residuals of a comparison, hPa, one dataset per flight: RESIDUAL_1, PCOR_1 and PCOR_REFERENCE_1 over time for
        the first of `models`, RESIDUAL_2 ... for the others. MASK is 0 where a sample is used. The command runs again.
        """
        if self.command != "compare":
            raise Error(f"{self.command} gives no residuals; compare does", "usage")
        if self._residuals is None:
            with tempfile.TemporaryDirectory() as folder:
                self._again(f"--residuals={folder}/residuals.nc")
                names = [Path(row["name"]).stem for row in self.models[0].flights]
                paths = [Path(folder) / f"residuals-{name}.nc" for name in names]
                if len(names) == 1:
                    paths = [Path(folder) / "residuals.nc"]
                self._residuals = []
                for path in paths:
                    with _flight.open(path) as flight:
                        self._residuals.append(flight.load())
        return self._residuals

    def _again(self, option: str) -> None:
        with tempfile.TemporaryDirectory() as folder:
            arguments = [word for word in self._arguments if not word.startswith("--output=")]
            if self.output is not None:
                arguments.append(f"--output={folder}/{self.output.name}")
            again, _ = self._run([*arguments, option])
        if _without_outputs(self._json) != _without_outputs(again):
            raise Error("the inputs changed after this result, so report and residuals would not belong to it; run the "
                        "command again", "file")

    def to_frame(self, table: Optional[str] = None) -> Any:
        """Table of the result as a pandas.DataFrame: a list of the JSON by name ("regimes", "bands", "flights",
        "findings", "steps", "checks"), "coefficients" of a fit, or "roles" of an inspection."""
        import pandas

        name = table or _tables.get(self.command)
        if name is None:
            raise Error(f"{self.command} has no default table; name one of {', '.join(self.fields)}", "usage")
        return pandas.DataFrame(_rows(self, name))

    def plot(self, kind: Optional[str] = None, **options: Any) -> Any:
        """Draws a picture with matplotlib and returns its axes, which are `ax` if given. The first kind is the default.

        compare: "regimes", residual by regime; "time", residual over time; "variable", residual against `variable`, a
        name in the flights. refit: "coefficients", before and after the fit, in standard errors; "flights", rms of each
        flight before and after. diagnose: "parts", rms of residual, noise, findings and unexplained structure.
        improve: "steps", rms after every step.
        """
        from . import _plots

        return _plots.draw(self, kind, **options)

    def __repr__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        picture = ""
        try:
            from . import _plots

            picture = _plots.as_html(self)
        except ImportError:  # without matplotlib
            pass
        return f"<pre>{html.escape(self.text)}</pre>{picture}"
