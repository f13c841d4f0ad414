#!/usr/bin/env python3
"""Tests that pcor reads or refuses any damaged flight file.

    damaged_flights.py TOOL SOURCE_DIRECTORY [--count N] [--seed N] [--keep FOLDER]

A simulated flight of 200 records, classic netCDF and HDF5, is damaged at random N times each. pcor inspect and pcor process
must end within 6 s of processor time with status 0 or 1 and at most 2,000 characters of messages. If they refuse the file, the
message is one line, the earlier output is unchanged, and no unfinished file remains. Equal seeds give equal damage. Exit status
1 if a requirement is violated; failures are printed, and their files are copied to FOLDER.
"""

import argparse
import os
import random
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import netCDF4

RECORDS = 200
MAX_SECONDS = 6.0  # processor time; the tool stops a library that hangs after 4 s
MAX_CHARACTERS = 2000
EARLIER = b"an earlier output"


def cut_flight(source, path, kind):
    """Writes RECORDS records of a flight as a netCDF file of the given format."""
    with netCDF4.Dataset(source) as whole, netCDF4.Dataset(path, "w", format=kind) as part:
        part.createDimension("Time", None)
        part.setncatts({name: whole.getncattr(name) for name in ("platform", "project", "FlightDate")})
        for name, variable in whole.variables.items():
            if variable.dimensions != ("Time",):
                continue
            attributes = {each: variable.getncattr(each) for each in variable.ncattrs()}
            copy = part.createVariable(name, variable.dtype, ("Time",), fill_value=attributes.pop("_FillValue", None),
                                       zlib=kind == "NETCDF4")
            copy.setncatts(attributes)
            copy[:] = variable[300:300 + RECORDS]


def damaged(content, chance):
    """Copy with some changed bytes, half of them in the header; sometimes truncated."""
    changed = bytearray(content)
    for _ in range(chance.choice((1, 2, 4, 16))):
        place = chance.randrange(min(len(changed), chance.choice((4096, len(changed)))))
        changed[place] = chance.choice((0, 255, chance.randrange(256), changed[place] ^ 1 << chance.randrange(8)))
    if chance.random() < 0.05:
        del changed[chance.randrange(len(changed)):]
    return bytes(changed)


def damaged_heaps(content):
    """HDF5 files with impossible sizes of variable-length attributes; libhdf5 1.10 crashes on most of them."""
    heap = content.find(b"GCOL")
    for item in (0, 12):
        changed = bytearray(content)
        changed[heap + 16 + 24 * item + 9] = 37  # byte of the size; items of this heap have 8 bytes
        yield bytes(changed)


def processor_time():
    """Processor time of all commands so far, s."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def failure_of(command, output):
    """Runs a command and returns the violated requirement, or None."""
    begin = processor_time()
    try:
        done = subprocess.run(command, capture_output=True, timeout=10 * MAX_SECONDS)
    except subprocess.TimeoutExpired:
        return "hangs"
    if done.returncode not in (0, 1):
        return f"exit status {done.returncode}"
    if processor_time() - begin > MAX_SECONDS:
        return f"processor time {processor_time() - begin:.1f} s (at most {MAX_SECONDS} s)"
    if len(done.stderr) > MAX_CHARACTERS:
        return f"message of {len(done.stderr)} characters (at most {MAX_CHARACTERS})"
    if done.returncode == 1 and done.stderr.count(b"\n") != 1:
        return f"refusal is not one line: {done.stderr.decode(errors='replace')}"
    if done.returncode == 1 and output.read_bytes() != EARLIER:
        return "earlier output changed"
    if b"internal error" in done.stderr:
        return done.stderr.decode(errors="replace").strip()
    return None


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("tool", type=Path)
    options.add_argument("source", type=Path)
    options.add_argument("--count", type=int, default=30, help="damaged files of each format")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--keep", type=Path, help="folder for files that cause failures")
    given = options.parse_args()
    tool = given.tool.resolve()
    model = given.source.resolve() / "data/scenarios/models/c130-psfd-eq18.toml"
    failures = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        simulated, flight, output = folder / "simulated.nc", folder / "flight.nc", folder / "out.nc"
        subprocess.run([tool, "simulate", given.source / "data/scenarios/c130-short.toml", "-o", simulated, "--quiet"],
                       check=True)
        commands = ([tool, "inspect", flight], [tool, "process", flight, "-m", model, "-o", output])
        for kind in ("NETCDF3_CLASSIC", "NETCDF4"):
            cut_flight(simulated, flight, kind)
            content = flight.read_bytes()
            chance = random.Random(f"{kind} {given.seed}")
            changes = [damaged(content, chance) for _ in range(given.count)]
            # HDF5 reads out of bounds in these files, which a sanitizer reports.
            if kind == "NETCDF4" and not os.environ.get("PCOR_SANITIZED"):
                changes += damaged_heaps(content)
            for number, change in enumerate(changes):
                flight.write_bytes(change)
                output.write_bytes(EARLIER)
                failed = [(command[1], failure_of(command, output)) for command in commands]
                left = {each.name for each in folder.iterdir()} - {simulated.name, flight.name, output.name}
                if left:
                    failed.append(("process", f"remaining files {', '.join(sorted(left))}"))
                for command, failure in failed:
                    if failure is None:
                        continue
                    failures += 1
                    print(f"{kind}, change {number}: {command}: {failure}")
                    if given.keep:
                        given.keep.mkdir(parents=True, exist_ok=True)
                        (given.keep / f"{kind}-{given.seed}-{number}.nc").write_bytes(flight.read_bytes())
    print(f"{failures} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
