#!/usr/bin/env python3
"""Flights with damaged bytes: whatever is in a file, pcor reads it or refuses it.

    damaged_flights.py TOOL SOURCE_DIRECTORY [--count N] [--seed N] [--keep FOLDER]

A simulated flight of 200 records, classic and HDF5, is changed at random N times each; pcor inspect and pcor process
then end within 6 s of processor time with status 0 or 1, say no more than 2,000 characters, which are one line where
they refuse, and leave an earlier output whole and nothing unfinished. The same seed makes the same changes. Exit status
1: something did not hold; what did not is printed, and the files that did it are put into FOLDER.
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
LONGEST = 6.0  # s of processor time; a library that never comes back is given up after four
MOST_CHARACTERS = 2000
EARLIER = b"an earlier output"


def cut_flight(source, path, kind):
    """A few records of a flight, as a netCDF file of some kind."""
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
    """The bytes with some of them changed, half of these in the header, or cut off."""
    changed = bytearray(content)
    for _ in range(chance.choice((1, 2, 4, 16))):
        place = chance.randrange(min(len(changed), chance.choice((4096, len(changed)))))
        changed[place] = chance.choice((0, 255, chance.randrange(256), changed[place] ^ 1 << chance.randrange(8)))
    if chance.random() < 0.05:
        del changed[chance.randrange(len(changed)):]
    return bytes(changed)


def damaged_heaps(content):
    """HDF5 files whose variable-length attributes have impossible sizes: libhdf5 1.10 crashes on most."""
    heap = content.find(b"GCOL")
    for item in (0, 12):
        changed = bytearray(content)
        changed[heap + 16 + 24 * item + 9] = 37  # of the size, in a heap whose items have 8 bytes
        yield bytes(changed)


def processor_time():
    """Processor time of all commands so far, s; independent of other load on the machine."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def what_is_wrong(command, output):
    """Runs a command; None if it ends as it should."""
    begin = processor_time()
    try:
        done = subprocess.run(command, capture_output=True, timeout=10 * LONGEST)
    except subprocess.TimeoutExpired:
        return "it hangs"
    if done.returncode not in (0, 1):
        return f"exit status {done.returncode}"
    if processor_time() - begin > LONGEST:
        return f"it takes {processor_time() - begin:.1f} s"
    if len(done.stderr) > MOST_CHARACTERS:
        return f"its message has {len(done.stderr)} characters"
    if done.returncode == 1 and done.stderr.count(b"\n") != 1:
        return f"it refuses in other than a line: {done.stderr.decode(errors='replace')}"
    if done.returncode == 1 and output.read_bytes() != EARLIER:
        return "the earlier output is lost"
    if b"internal error" in done.stderr:
        return done.stderr.decode(errors="replace").strip()
    return None


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("tool", type=Path)
    options.add_argument("source", type=Path)
    options.add_argument("--count", type=int, default=30, help="changed files of each kind")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--keep", type=Path, help="where files go that did what they should not")
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
            # HDF5 reads beyond its memory there, and a sanitizer reports the read.
            if kind == "NETCDF4" and not os.environ.get("PCOR_SANITIZED"):
                changes += damaged_heaps(content)
            for number, change in enumerate(changes):
                flight.write_bytes(change)
                output.write_bytes(EARLIER)
                wrong = [(command[1], what_is_wrong(command, output)) for command in commands]
                left = {each.name for each in folder.iterdir()} - {simulated.name, flight.name, output.name}
                if left:
                    wrong.append(("process", f"it leaves {', '.join(sorted(left))}"))
                for command, what in wrong:
                    if what is None:
                        continue
                    failures += 1
                    print(f"{kind}, change {number}: {command}: {what}")
                    if given.keep:
                        given.keep.mkdir(parents=True, exist_ok=True)
                        (given.keep / f"{kind}-{given.seed}-{number}.nc").write_bytes(flight.read_bytes())
    print(f"{failures} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
