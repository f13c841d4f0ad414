"""Functions that the benchmarks share."""

import os
import pathlib
import statistics
import subprocess
import sys
import time
from typing import NamedTuple

ROOT = pathlib.Path(__file__).resolve().parent.parent

median = statistics.median


class Usage(NamedTuple):
    """What a command needed."""

    wall: float  # s
    processor: float  # s, of all threads
    memory: float  # MiB, peak


def run(command):
    """Runs a command without its output. Returns its Usage."""
    begin = time.monotonic()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.monotonic() - begin
    if status != 0:
        sys.exit(f"failed: {' '.join(map(str, command))}")
    return Usage(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)


class Targets:
    """Prints figures with their targets."""

    missed = False

    def check(self, text, value, met, target):
        self.missed |= not met
        print(f"  {text:<46} {value:8.3g}, target {target}: {'met' if met else 'missed'}")
