"""Runs the tool. Each command is a separate process: other threads of Python continue, an interrupt leaves no unfinished
files, and a damaged flight that crashes the HDF5 library does not end the interpreter."""

from __future__ import annotations

import json
import os
import subprocess
import threading
import warnings
from pathlib import Path
from typing import Any, Callable, NamedTuple, Optional

from ._error import Error
from ._paths import DATA, TOOL

_here = Path(__file__).parent
tool = _here / TOOL

data = _here / DATA
"""Folder of the models and scenarios of the package."""

Progress = Callable[[str, int, int], None]


class Run(NamedTuple):
    """Exit status, standard output and standard error of a sub-command."""

    status: int
    stdout: str
    stderr: str


class _Bar:
    """Progress bar of tqdm for each task of a command; no bar if tqdm is not installed."""

    def __init__(self) -> None:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # warning without ipywidgets; the bar is then text
                from tqdm.auto import tqdm  # type: ignore[import-untyped]
        except ImportError:
            tqdm = None
        self._tqdm = tqdm
        self._task = ""
        self._bar: Any = None

    def __call__(self, task: str, done: int, total: int) -> None:
        if self._tqdm is None:
            return
        if self._bar is None or self._task != task:
            self.close()
            self._task, self._bar = task, self._tqdm(total=total, desc=task, leave=False, delay=0.5)
        self._bar.total = total
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None


def run(arguments: list[str], progress: Optional[Progress] = None) -> Run:
    """Runs a sub-command of the tool, such as `["refit", "first.nc", "-m", "model.toml", "-o", "fitted.toml"]`.

    `progress(task, done, total)` is called twice a second from another thread; by default tqdm shows a bar, if
    installed. An interrupt (Ctrl-C) stops the command, without unfinished files. Raises `Error` if the exit status is
    not 0. Messages on standard error become warnings.
    """
    bar = _Bar()
    show = bar if progress is None else progress
    failure: dict[str, str] = {}
    raised: list[Exception] = []

    def listen(descriptor: int) -> None:
        try:
            with os.fdopen(descriptor, encoding="utf-8") as lines:
                for line in lines:
                    event = json.loads(line)
                    if "error" in event:
                        failure.update(event)
                    else:
                        show(event["task"], event["done"], event["total"])
        except Exception as error:  # raised by `progress`; the closed pipe stops the command
            raised.append(error)

    receiver, sender = os.pipe()
    listener = threading.Thread(target=listen, args=(receiver,), daemon=True)
    try:
        process = subprocess.Popen(["pcor", *arguments], executable=tool, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, encoding="utf-8", errors="replace",
                                   pass_fds=(sender,), env={**os.environ, "PCOR_EVENTS": str(sender)})
    except OSError as error:
        os.close(receiver)
        raise Error(f"{tool}: {error.strerror}; install the package again", "file") from error
    finally:
        os.close(sender)
    listener.start()
    try:
        stdout, stderr = process.communicate()
    except BaseException:
        process.terminate()
        process.wait()
        raise
    finally:
        listener.join()
        bar.close()
    if raised:
        raise raised[0]
    lines = [line.removeprefix("pcor: ") for line in stderr.splitlines()]
    if process.returncode != 0:
        command = ["pcor", *arguments]
        message = failure.get("error") or "\n".join(lines) or f"the tool ended with status {process.returncode}"
        code = failure.get("code") or ("usage" if process.returncode == 2 else "crash")
        raise Error(message, code, process.returncode, command)
    for line in lines:
        warnings.warn(line, stacklevel=2)
    return Run(process.returncode, stdout, stderr)
