"""What a command found."""

from __future__ import annotations

import html
import json
import tempfile
from pathlib import Path
from typing import Any, Callable, Optional

import xarray as xr

from . import _flight
from ._error import Error
from ._flight import PathLike
from ._model import Model
from ._tool import Progress, run


class Fields(dict):
    """A JSON object whose keys are attributes too: `result.models[0].rms_hpa`."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"there is no field '{name}'; the fields are {', '.join(self)}") from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]


def _rows(result: "Result", name: str) -> list[dict[str, Any]]:
    """The rows of a table: the list of that name, or of a part of each model, flight or effect."""
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
    """A result without the names of what was written, which differ from run to run."""
    return json.loads(text, object_hook=lambda each: {key: value for key, value in each.items()
                                                      if key not in ("model", "output", "choices")})


_tables = {"compare": "regimes", "refit": "coefficients", "diagnose": "findings", "improve": "steps",
           "check": "checks", "inspect": "roles", "effects": "effects"}

_summaries: dict[str, Callable[[Any], str]] = {
    "inspect": lambda r: "; ".join(f"{f.path}: {f.aircraft}, {f.begin} to {f.end}, {len(f.roles)} roles"
                                   for f in r.flights),
    "compare": lambda r: "; ".join(f"{m.name} against {m.reference}: rms {m.rms_hpa:.3f} hPa, bias {m.bias_hpa:+.3f} "
                                   f"hPa, noise {m.noise_rms_hpa:.3f} hPa, {m.samples} samples" for m in r.models),
    "refit": lambda r: f"rms {r.rms_before_hpa:.3f} hPa before, {r.rms_hpa:.3f} hPa after the fit, noise "
                       f"{r.noise_rms_hpa:.3f} hPa, {r.samples} samples",
    "diagnose": lambda r: f"verdict: {r.verdict}; " + ("missing: " + ", ".join(f.effect for f in r.findings)
                                                       if r.findings else "no effect of the catalogue was found"),
    "improve": lambda r: f"added: {', '.join(s.added for s in r.steps if s.added and not s.get('refused')) or 'nothing'}; "
                         f"{r.why_stopped}",
    "process": lambda r: "; ".join(f"{f.input}: {f.corrected} of {f.samples} samples corrected"
                                   for f in r.get("flights", [r]) if f.state == "processed"),
    "check": lambda r: "; ".join(f"{c.name}: {c.verdict}" for c in r.checks if c.ran),
}


class Result:
    """The result of a command: the fields of the tool's JSON as attributes and items.

    `to_json()` is the tool's JSON, `to_dict()` the same as plain Python; NaN is None there.
    """

    def __init__(self, command: str, arguments: list[str], text: str, files: tempfile.TemporaryDirectory[str],
                 output: Optional[Path], progress: Optional[Progress]):
        self.command = command
        self.fields: Fields = json.loads(text, object_hook=Fields)
        self.output = output
        self._arguments = arguments
        self._text = text
        self._files = files  # deleted with the result
        self._progress = progress
        self._residuals: Optional[list[xr.Dataset]] = None

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "fields":
            raise AttributeError(name)
        return getattr(self.fields, name)

    def __getitem__(self, name: str) -> Any:
        return self.fields[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.fields]

    def to_json(self) -> str:
        """The JSON of the tool, to the last byte."""
        return self._text

    def to_dict(self) -> dict[str, Any]:
        """The JSON of the tool as dicts and lists."""
        return json.loads(self._text)

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
        """Writes the report, a self-contained HTML file. The command runs once more for it, on the same inputs."""
        self._again(f"--report={path}")

    def residuals(self) -> list[xr.Dataset]:
        """Residuals of a comparison: of each flight a dataset with RESIDUAL_1, PCOR_1, PCOR_REFERENCE_1, hPa, by time
        for the first of `models`, RESIDUAL_2 ... for the others; MASK is 0 at the samples that take part. The
        command runs once more for it."""
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
            stdout = run([self.command, *arguments, "--json=-", option], self._progress).stdout
        if _without_outputs(self._text) != _without_outputs(stdout):
            raise Error("the inputs have changed since this result: it is not that of the report or the residuals; "
                        "run the command again", "file")

    def to_frame(self, table: Optional[str] = None) -> Any:
        """A table of the result as a pandas.DataFrame: a list of the JSON by its name ("regimes", "bands", "flights",
        "findings", "steps", "checks"), "coefficients" of a fit or "roles" of an inspection."""
        import pandas  # type: ignore[import-untyped]

        name = table or _tables.get(self.command)
        if name is None:
            raise Error(f"{self.command} has no table of its own; name one of {', '.join(self.fields)}", "usage")
        return pandas.DataFrame(_rows(self, name))

    def plot(self, kind: Optional[str] = None, **options: Any) -> Any:
        """Draws a picture with matplotlib and returns its axes, those of `ax` if given.

        "regimes": residual by regime (compare). "variable": residual against `variable`, a name in the flights
        (compare). "coefficients": fitted coefficients beside their starts, in standard errors (refit). "ladder": rms
        after every step (improve). "holdout": rms of each flight before and after (refit). The default is the first
        that the command has.
        """
        from . import _plots

        return _plots.draw(self, kind, **options)

    def summary(self) -> str:
        """The result in one line."""
        line = _summaries.get(self.command)
        return line(self.fields) if line else f"{self.command}: {', '.join(self.fields)}"

    def __repr__(self) -> str:
        return f"<pcor.Result of {self.command}: {self.summary()}>"

    def _repr_html_(self) -> str:
        parts = [f"<p><b>pcor {self.command}</b>: {html.escape(self.summary())}</p>"]
        try:
            from . import _plots

            parts.append(_plots.as_html(self))
        except ImportError:
            pass
        try:
            table = self.to_frame()
            narrow = [name for name in table if not table[name].map(lambda cell: isinstance(cell, (dict, list))).any()]
            parts.append(table[narrow[:8]].to_html(index=False, na_rep="", float_format="%.4g", max_rows=30))
        except (ImportError, Error):
            pass
        return "".join(parts)
