"""Corrections to the static and dynamic pressure that a research aircraft measures.

Commands: `inspect`, `compare`, `refit`, `diagnose`, `improve`, `check`, `temperature`, `process`, `simulate`,
`effects`, `add`, with the options of the tool `pcor`; `help(pcor.refit)` lists options and result fields. Arrays:
`open`, `Model`, `Loop`. Pressures are in hPa, temperatures in K (degC in files), speeds in m/s, angles in degrees,
heights in metres. Delta-p is added to the measured static pressure and subtracted from the measured dynamic pressure.
"""

from ._commands import (add, check, compare, diagnose, effects, help, improve, inspect, process, refit, simulate,
                        temperature)
from ._error import Error
from ._flight import open
from ._model import Loop, Model, model, quality, quantities
from ._pcor import version as __version__
from ._result import Result
from ._tool import data, run

__all__ = ["Error", "Loop", "Model", "Result", "add", "check", "compare", "data", "diagnose", "effects", "help",
           "improve", "inspect", "model", "open", "process", "quality", "quantities", "refit", "run", "simulate",
           "temperature"]
