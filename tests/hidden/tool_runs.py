"""Runs the tool as a program."""

import json
import subprocess
from pathlib import Path


class ToolError(Exception):
    """A run of the tool failed; the text has its message."""


class Tool:
    def __init__(self, path):
        self.path = str(Path(path).resolve())

    def run(self, *arguments, timeout=300):
        words = [self.path, *map(str, arguments)]
        try:
            result = subprocess.run(words, capture_output=True, text=True, timeout=timeout)
        except subprocess.TimeoutExpired:
            raise ToolError(f"{arguments[0]}: no answer within {timeout} s") from None
        if result.returncode != 0:
            raise ToolError(f"{arguments[0]}: exit status {result.returncode}: {result.stderr.strip()[:500]}")
        return result.stdout

    def json_of(self, *arguments):
        return json.loads(self.run(*arguments, "--json", "-", "--quiet"))

    def version(self):
        return self.run("--version").strip()
