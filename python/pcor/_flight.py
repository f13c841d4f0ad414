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
    """Opens the flight in a netCDF file. Missing values are NaN, times are datetime64, by the CF conventions.

    Variables keep the names, shapes and units of the file: `flight.PSFD.units`. The result has a coordinate `Time` also
    for old files of nimbus, which have `base_time` and `time_offset`. Raises `Error` if the file cannot be read.
    """
    try:
        flight = xr.open_dataset(path, decode_times=False)
    except (OSError, ValueError) as error:
        raise Error(f"{os.fspath(path)}: cannot be read as netCDF ({error}); commands read ICARTT files, "
                    "give them the path", "file") from error
    if {"base_time", "time_offset"} <= set(flight.variables) and "Time" not in flight.variables:
        offset = flight["time_offset"]
        time = xr.Variable(offset.dims, offset.values.astype(float) + float(flight["base_time"]),
                           {"units": "seconds since 1970-01-01 00:00:00 +0000", "standard_name": "time"})
        # Otherwise each variable would be decoded as a time.
        flight = flight.drop_vars(["base_time", "time_offset"]).assign_coords(Time=time)
    try:
        flight = xr.decode_cf(flight)
    except ValueError as error:
        raise Error(f"{os.fspath(path)}: the times cannot be decoded ({error}); open the file with "
                    "xarray.open_dataset(path, decode_times=False)", "file") from error
    flight.encoding["source"] = os.fspath(path)
    return flight


def write(flight: xr.Dataset, folder: Path) -> Path:
    """Writes a flight in memory to a file in the folder, with the name of the file from which it was read."""
    name = Path(flight.encoding.get("source", "flight.nc")).stem
    path = folder / f"{name}.nc"
    number = 1
    while path.exists():
        number += 1
        path = folder / f"{name}-{number}.nc"
    flight.to_netcdf(path)
    return path


def values(variable: Any) -> np.ndarray:
    """The values as contiguous doubles; contiguous doubles are not copied."""
    return np.ascontiguousarray(variable, dtype=np.float64)
