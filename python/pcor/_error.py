"""The one exception of the package."""

from __future__ import annotations

from typing import Optional


class Error(Exception):
    """Work that cannot be done.

    `message` is one line for people: what is wrong, with values and units, and what to do about it. `code` is for
    programs: "file", "variable", "unit", "model", "output", "usage" (options of a command), "crash" or "other".
    `status` is the exit status of the tool and `command` its command line, where a command failed.
    """

    def __init__(self, message: str, code: str = "other", status: Optional[int] = None,
                 command: Optional[list[str]] = None):
        super().__init__(message)
        self.message = message
        self.code = code
        self.status = status
        self.command = command


Error.__module__ = "pcor"
