"""The exception of the package."""

from __future__ import annotations

from typing import Optional


class Error(Exception):
    """Error of a command, a model or a flight.

    `message` is one line: the problem, with values and units, and the action to take. `code` is for programs: "file",
    "variable", "unit", "model", "output", "usage" (options of a command), "crash" or "other". If a command failed,
    `status` is the exit status of the tool and `command` is its command line.
    """

    def __init__(self, message: str, code: str = "other", status: Optional[int] = None,
                 command: Optional[list[str]] = None):
        super().__init__(message)
        self.message = message
        self.code = code
        self.status = status
        self.command = command


Error.__module__ = "pcor"
