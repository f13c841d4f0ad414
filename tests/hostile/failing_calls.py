#!/usr/bin/env python3
"""Tests pcor with failing system calls: in each run one call fails.

    failing_calls.py TOOL SHIM SOURCE_DIRECTORY [--every N] [--kind KIND]

SHIM is the library built from failing_calls.cpp. It makes call n of a kind fail, for example as with a full disk. The run must
end with status 0 if the call does not matter, otherwise with status 1 and one line that names the failed object. Each output is
either unchanged or equal to the output of a run without failures, and no unfinished file remains. If memory allocation fails,
a signal may end the run, with the same requirements on the outputs, and the netCDF library may omit its attribute _NCProperties.
If a run is stopped before it renames output n, either all outputs are new or all are unchanged. n is 1, 2, 3, 12, 48 and so on
until a run makes fewer calls; with --every N, all numbers, but of allocations only 1, N + 1, 2 N + 1 and so on.
Exit status 1 if a requirement is violated; failures are printed.
"""

import argparse
import os
import re
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

KINDS = ("memory", "open", "read", "write", "sync", "rename", "close", "stop")
EARLIER = b"an earlier output"
# Objects that a message may name: a file, a stream, memory, or the database of UDUNITS. A library may print a message before.
NAMED = re.compile(r"pcor: [^\n]*(\.nc|\.toml|\.html|\.json|standard output|memory|UDUNITS|cannot be written)[^\n]*\n\Z")


class Command:
    """Command with a folder for its outputs."""

    def __init__(self, given, words, outputs):
        self.given = given
        self.words = words
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name)
        self.outputs = outputs
        self.report = self.path.parent / (self.path.name + ".report")
        self.run()
        self.good = {name: (self.path / name).read_bytes() for name in outputs}

    def run(self, **environment):
        for path in self.path.iterdir():
            path.unlink()
        for name in self.outputs:
            (self.path / name).write_bytes(EARLIER)
        self.report.unlink(missing_ok=True)
        return subprocess.run([self.given.tool, *self.words], capture_output=True, timeout=300, cwd=self.path,
                              env={**os.environ, "LD_PRELOAD": str(self.given.shim), **environment})

    def fail_call(self, kind, number):
        """Runs the command with one failing call. Returns the violated requirements (empty if all are met), or
        None if the run makes fewer calls."""
        done = self.run(FAILING_CALL=kind, FAILING_NUMBER=str(number), FAILING_REPORT=str(self.report))
        if not self.report.exists():
            return None
        call, message = self.report.read_text(), done.stderr.decode(errors="replace")
        self.report.unlink()
        wrong = []
        stopped_by_library = kind == "memory" and done.returncode in (-signal.SIGABRT, -signal.SIGSEGV)
        stopped = kind == "stop" and done.returncode == -signal.SIGTERM
        if done.returncode not in (0, 1) and not stopped_by_library and not stopped:
            wrong.append(f"exit status {done.returncode}")
        # A library may print a text without a line break before; an assertion of a library names the program, too.
        own = [line for line in message.splitlines() if "pcor: " in line and "Assertion" not in line]
        if done.returncode == 1 and (len(own) != 1 or not NAMED.search(message)):
            wrong.append(f"message {message!r}")
        if done.returncode == 0 and message:
            wrong.append(f"success with the message {message!r}")
        for name, good in self.good.items():
            path = self.path / name
            is_unchanged = done.returncode != 0 and path.exists() and path.read_bytes() == EARLIER
            if not is_unchanged and not (path.exists() and self.is_good(path, good, kind)):
                wrong.append(f"{name} is missing or different")
        if stopped and len({(self.path / name).read_bytes() == EARLIER for name in self.outputs}) == 2:
            wrong.append("only some outputs are new")
        left = {path.name for path in self.path.iterdir()} - set(self.outputs)
        if left:
            wrong.append(f"remaining files {', '.join(sorted(left))}")
        return f"({call}) {'; '.join(wrong)}" if wrong else ""

    def is_good(self, path, good, kind):
        """True if an output has the contents of a run without failures."""
        if path.read_bytes() == good:
            return True
        # The output names the flaps that could not be read; it has no bits and no missing uncertainties for them.
        without_flaps = kind == "read" and b"no quality bit: " in path.read_bytes()
        if path.suffix != ".nc" or not (kind == "memory" or without_flaps):
            return without_flaps
        reference = Path(f"{self.path}.good.nc")
        reference.write_bytes(good)
        # ncdump does not print _NCProperties.
        texts = [subprocess.run(["ncdump", "-n", "flight", *(["-v", "PCOR,PSXC,QCXC"] if without_flaps else []), file],
                                capture_output=True, check=True).stdout for file in (path, reference)]
        if without_flaps:  # the global attribute pcor_notes is different
            texts = [text[text.index(b"\ndata:"):] for text in texts]
        reference.unlink()
        return texts[0] == texts[1]


def numbers(step):
    """Every number of the given step; without a step, a sample."""
    number = 1
    while True:
        yield number
        number = number + step if step else number + 1 if number < 3 else number * 4


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("tool", type=Path)
    options.add_argument("shim", type=Path)
    options.add_argument("source", type=Path)
    options.add_argument("--every", type=int, metavar="N", help="all calls, and each N-th allocation; default: a sample")
    options.add_argument("--kind", choices=KINDS, action="append", help="only calls of this kind")
    given = options.parse_args()
    given.tool, given.shim = given.tool.resolve(), given.shim.resolve()
    data = given.source.resolve() / "data/scenarios"
    scenario, model = data / "c130-short.toml", data / "models/c130-psfd-eq18.toml"
    failures = runs = 0
    with tempfile.TemporaryDirectory() as name:
        flight = Path(name) / "flight.nc"
        subprocess.run([given.tool, "simulate", scenario, "-o", flight, "--quiet"], check=True)
        commands = (
            (("simulate", scenario, "-o", "out.nc", "--quiet"), ("out.nc",)),
            (("process", flight, "-m", model, "-o", "out.nc", "--report", "out.html", "--quiet"), ("out.nc", "out.html")),
            (("refit", flight, "-m", model, "-o", "out.toml", "--json", "out.json", "--quiet"), ("out.toml", "out.json")),
            (("check", flight, "-m", model, "--report", "out.html", "--quiet"), ("out.html",)),
        )
        for words, outputs in commands:
            command = Command(given, words, outputs)
            for kind in given.kind or KINDS:
                for number in numbers(given.every if kind == "memory" or not given.every else 1):
                    wrong = command.fail_call(kind, number)
                    if wrong is None:
                        break
                    runs += 1
                    if wrong:
                        failures += 1
                        print(f"{words[0]}, {kind} {number} {wrong}", flush=True)
    print(f"{runs} runs, {failures} failures")
    return 1 if failures or not runs else 0


if __name__ == "__main__":
    sys.exit(main())
