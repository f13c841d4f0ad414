"""Flights as xarray datasets."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Union

import numpy as np
import xarray as xr

from ._error import Error

PathLike = Union[str, "os.PathLike[str]"]


def open(path: PathLike) -> xr.Dataset:
    """The flight in a netCDF file, with missing values as NaN and times as datetime64, by the CF conventions.

    Variables keep the names, shapes and units of the file: `flight.PSFD.units`. Old files of nimbus, which state
    their time as `base_time` and `time_offset`, get a coordinate `Time`.
    """
    try:
        flight = xr.open_dataset(path, decode_times=False)
    except (OSError, ValueError) as error:
        raise Error(f"{os.fspath(path)}: not a netCDF file that can be read ({error}); the commands also take "
                    "ICARTT files by their path", "file") from error
    if {"base_time", "time_offset"} <= set(flight.variables) and "Time" not in flight.variables:
        offset = flight["time_offset"]
        time = xr.Variable(offset.dims, offset.values.astype(float) + float(flight["base_time"]),
                           {"units": "seconds since 1970-01-01 00:00:00 +0000", "standard_name": "time"})
        # Each would decode to a time of its own.
        flight = flight.drop_vars(["base_time", "time_offset"]).assign_coords(Time=time)
    try:
        flight = xr.decode_cf(flight)
    except ValueError as error:
        raise Error(f"{os.fspath(path)}: its times cannot be decoded ({error}); open it with "
                    "xarray.open_dataset(path, decode_times=False)", "file") from error
    flight.encoding["source"] = os.fspath(path)
    return flight


def write(flight: xr.Dataset, folder: Path) -> Path:
    """Writes a flight that is in memory to a file in the folder, named like the file that it was read from."""
    name = Path(flight.encoding.get("source", "flight.nc")).stem
    path = folder / f"{name}.nc"
    number = 1
    while path.exists():
        number += 1
        path = folder / f"{name}-{number}.nc"
    flight.to_netcdf(path)
    return path


def values(variable: Any) -> np.ndarray:
    """The values as contiguous doubles, without a copy where they are that already."""
    return np.ascontiguousarray(variable, dtype=np.float64)
