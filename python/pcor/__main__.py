"""Runs the tool: `python -m pcor refit ...`, or the command `pcor` of an environment."""

import os
import sys

from ._tool import tool


def main() -> None:
    os.execv(tool, ["pcor", *sys.argv[1:]])


if __name__ == "__main__":
    main()
