"""The exception of the package."""

from __future__ import annotations

from typing import Optional


class Error(Exception):
    """Error of a command, a model or a flight.

    `message` is one line: the problem, with values and units, and the action to take. `code` is for programs:

    - "file": a file cannot be read, or is damaged
    - "variable": a variable is absent, has no value or cannot be used
    - "unit": a unit is missing, unknown or not convertible
    - "time": a time is missing or ambiguous, or the times do not increase
    - "samples": the usable samples are too few, or their rate cannot be used
    - "definition": a model file, scenario, file of intervals or formula is not valid
    - "model": no model is determined, or the model cannot be used on the recorded variables
    - "fit": a fit has no solution, does not determine it, or gives a worse model
    - "usage": an option or argument is impossible, or contradicts another one
    - "output": an output cannot be written to its path
    - "system": memory, a process or another program is not available, or pcor has an internal error
    - "crash": the tool ended without a report of its error

    If a command failed, `status` is the exit status of the tool and `command` is its command line.
    """

    def __init__(self, message: str, code: str = "crash", status: Optional[int] = None,
                 command: Optional[list[str]] = None):
        super().__init__(message)
        self.message = message
        self.code = code
        self.status = status
        self.command = command


Error.__module__ = "pcor"
