"""Pictures of results, with matplotlib."""

from __future__ import annotations

import base64
import io
import textwrap
from pathlib import Path
from typing import Any, Callable, Optional

import numpy as np

from . import _flight
from ._error import Error


def _regimes(result: Any, ax: Any, model: int = 0) -> None:
    comparison = result.models[model]
    rows = [row for row in comparison.regimes if row.samples > 0 and row.bias_hpa is not None]
    places = np.arange(len(rows))
    bias = np.array([row.bias_hpa for row in rows])
    error = np.array([row.bias_stderr_hpa or np.nan for row in rows])
    ax.errorbar(bias, places, xerr=error, fmt="o", capsize=3, label="bias with standard error")
    ax.plot([row.rms_hpa for row in rows], places, "|", ms=12, label="rms")
    ax.plot([row.noise_rms_hpa or np.nan for row in rows], places, "k.", label="noise rms")
    ax.axvline(0, color="0.7", lw=0.8, zorder=0)
    ax.set_yticks(places, [row.name for row in rows])
    ax.invert_yaxis()
    ax.set(xlabel=f"residual against {comparison.reference}, hPa", title=textwrap.fill(comparison.name, 60))
    ax.legend(fontsize="small")


def _time(result: Any, ax: Any, model: int = 0) -> None:
    for flight, residuals in zip(result.models[model].flights, result.residuals()):
        residual = residuals[f"RESIDUAL_{model + 1}"]
        used = residual.where(residuals.MASK == 0)
        ax.plot(used[used.dims[0]], used, ".", ms=1, label=flight.name)
    ax.axhline(0, color="0.7", lw=0.8, zorder=0)
    ax.set(xlabel="time, UTC", ylabel="residual, hPa", title=textwrap.fill(result.models[model].name, 60))
    ax.legend(fontsize="small", markerscale=8)


def _variable(result: Any, ax: Any, variable: str = "", model: int = 0, bins: int = 12) -> None:
    x, y = [], []
    paths = {Path(word).name: word for word in result._arguments if not word.startswith("--")}
    for row, residuals in zip(result.models[0].flights, result.residuals()):
        with _flight.open(paths[row.name]) as flight:
            if variable not in flight:
                raise Error(f"{row.name} has no variable '{variable}'; give variable=NAME", "variable")
            used = residuals.MASK.values == 0
            values = flight[variable].values.astype(float)
            ax.set_xlabel(f"{variable}, {flight[variable].attrs.get('units', '')}")
        residual = residuals[f"RESIDUAL_{model + 1}"].values
        if values.shape != residual.shape:
            raise Error(f"'{variable}' has a different rate from the residuals; choose a variable of the same rate",
                        "variable")
        x.append(values[used])
        y.append(residual[used])
    allx, ally = np.concatenate(x), np.concatenate(y)
    valid = np.isfinite(allx) & np.isfinite(ally)
    allx, ally = allx[valid], ally[valid]
    if allx.size == 0:
        raise Error(f"no sample has both a residual and '{variable}'", "variable")
    ax.plot(allx, ally, ",", color="0.6", rasterized=True)
    edges = np.unique(np.quantile(allx, np.linspace(0, 1, bins + 1)))
    inside = np.clip(np.searchsorted(edges, allx, "right") - 1, 0, max(edges.size - 2, 0))
    means = [(allx[inside == i].mean(), ally[inside == i].mean()) for i in np.unique(inside)]
    ax.plot(*np.transpose(means), "o-", label=f"means of {len(means)} bins with equal numbers of samples")
    ax.axhline(0, color="0.7", lw=0.8, zorder=0)
    ax.set(ylabel="residual, hPa", title=textwrap.fill(result.models[model].name, 60))
    ax.legend(fontsize="small")


def _coefficients(result: Any, ax: Any) -> None:
    rows = [(f"{effect.id}.{name}", effect.start[name], value, effect.stderr.get(name))
            for effect in result.effects for name, value in effect.parameters.items()]
    rows = [row for row in rows if row[3]]
    places = np.arange(len(rows))
    ax.errorbar(np.zeros(len(rows)), places, xerr=1, fmt="o", capsize=3, label="fitted, with standard error")
    ax.plot([(start - value) / error for _, start, value, error in rows], places, "x", label="start")
    ax.set_yticks(places, [f"{name} = {value:.4g} ± {error:.2g}" for name, _, value, error in rows])
    ax.invert_yaxis()
    ax.margins(y=0.3)  # room for the legend
    ax.set_xlabel("difference from the fitted value, standard errors")
    ax.legend(fontsize="small")


def _steps(result: Any, ax: Any) -> None:
    steps = [step for step in result.steps if not step.get("refused")]
    places = np.arange(len(steps) + 1)
    for key, label in (("rms_train_hpa", "fitted flights"), ("rms_holdout_hpa", "held-out flights")):
        rms = [result.as_it_came.get(key), *(step.get(key) for step in steps)]
        if any(value is not None for value in rms):
            ax.plot(places, [np.nan if value is None else value for value in rms], "o-", label=label)
    ax.plot(places[1:], [step.noise_rms_hpa for step in steps], "k:", label="noise")
    ax.set_xticks(places, ["input model", *(step.added or "refitted" for step in steps)], rotation=20, ha="right")
    ax.set(ylabel="rms residual, hPa", ylim=(0, None))
    ax.legend(fontsize="small")


def _flights(result: Any, ax: Any) -> None:
    places = np.arange(len(result.flights))
    ax.plot([flight.before.rms_hpa for flight in result.flights], places, "x", label="before")
    ax.plot([flight.after.rms_hpa for flight in result.flights], places, "o", label="after")
    ax.plot([flight.after.noise_rms_hpa for flight in result.flights], places, "k.", label="noise")
    ax.set_yticks(places, [f"{flight.name}{' (held out)' if flight.holdout else ''}" for flight in result.flights])
    ax.invert_yaxis()
    ax.margins(y=0.3)  # room for the legend
    ax.set(xlabel="rms residual, hPa", xlim=(0, None))
    ax.legend(fontsize="small")


def _parts(result: Any, ax: Any) -> None:
    parts = [("residual", result.rms_given_hpa), ("noise", result.noise_rms_hpa),
             *((finding.effect, finding.rms_hpa) for finding in result.findings)]
    if result.unexplained.significant:
        parts.append(("unexplained", result.unexplained.rms_hpa))
    ax.barh([name for name, _ in parts], [rms or 0.0 for _, rms in parts], height=0.5)
    ax.invert_yaxis()
    ax.set(xlabel="rms, hPa", title=f"verdict: {result.verdict}")


_pictures: dict[str, dict[str, Callable[..., None]]] = {
    "compare": {"regimes": _regimes, "time": _time, "variable": _variable},
    "refit": {"coefficients": _coefficients, "flights": _flights},
    "diagnose": {"parts": _parts},
    "improve": {"steps": _steps},
}


def draw(result: Any, kind: Optional[str] = None, ax: Any = None, **options: Any) -> Any:
    pictures = _pictures.get(result.command, {})
    if not pictures or (kind is not None and kind not in pictures):
        raise Error(f"{result.command} has no picture {kind or ''}{'; choose ' + ' or '.join(pictures) if pictures else ''}; "
                    "report(path) has all pictures", "usage")
    if ax is None:
        from matplotlib import pyplot

        _, ax = pyplot.subplots(layout="constrained")
    pictures[kind or next(iter(pictures))](result, ax, **options)
    return ax


def as_html(result: Any) -> str:
    """The default picture of the result as an image for a notebook; empty if the command has no picture."""
    if result.command not in _pictures:
        return ""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 3.5), layout="constrained")
    draw(result, ax=figure.subplots())
    png = io.BytesIO()
    figure.savefig(png, format="png", dpi=100)
    return f'<img src="data:image/png;base64,{base64.b64encode(png.getvalue()).decode()}">'
