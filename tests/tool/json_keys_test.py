#!/usr/bin/env python3
"""Each key of the JSON results is explained by --json-keys, and each explained key is written.

    json_keys_test.py TOOL SOURCE_DIRECTORY
"""

import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
from scenarios import half_of_hidden, simulate  # noqa: E402

TOOL = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()
MODEL = SOURCE / "data/scenarios/models/c130-psfd-eq18.toml"
OTHER = SOURCE / "data/models/c130-psfrd-eq18.toml"

FLIGHTS = ["first.nc", "damaged.nc", "--skip-unreadable"]

# Keys that these flights do not show: each depends on a fault or on an ambiguity.
RARE = {
    "inspect": r"choices|flights\[\]\.(frozen|problems|notes)",
    "refit": r"worse|warnings|surfaces|effects\[\]\.at_bound",
    "diagnose": r"unexplained\.(steps|computed)|findings\[\]\.(alias|variants|scaling)",
    # the keys of a diagnosis are those of diagnose
    "improve": r"unexplained\.(steps|computed)|steps\[\]\.(aliases|rivals|diagnosis\.)",
    "process": r"choices|reason|notes|flights\[\]\.notes",
    "temperature": r"law_errors|flights\[\]\.left_out",
    # a surface has neither coefficients nor scalings
    "effects": r"surfaces\[\]\.(parameters|scalings)",
    "add": r"choices",
}


def written(value, known, path=""):
    """Paths of the leaves of a result: NAME for keys that are not known."""
    if isinstance(value, dict):
        for key, child in value.items():
            own = f"{path}.{key}".lstrip(".")
            is_known = any(each == own or each.startswith((own + ".", own + "[")) for each in known)
            yield from written(child, known, own if is_known else f"{path}.NAME")
    elif isinstance(value, list):
        for child in value:
            yield from written(child, known, path + "[]")
    else:
        yield path


class JsonKeys(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = Path(cls.scratch.name)
        hidden = half_of_hidden(SOURCE)
        (cls.folder / "hidden.toml").write_text(hidden)
        climbs, short = ((SOURCE / f"data/scenarios/c130-{name}.toml").read_text() for name in ("climbs", "short"))
        for scenario, seed, name in ((hidden, 101, "first"), (hidden, 102, "second"), (climbs, 31, "climbs"),
                                     (short, 3, "short")):
            simulate(TOOL, cls.folder / f"{name}.nc", scenario, seed)
        (cls.folder / "damaged.nc").write_bytes(b"CDF\x01 damaged")
        cls.run_tool("refit", "first.nc", "second.nc", "-m", MODEL, "-o", "both.toml")

    @classmethod
    def run_tool(cls, *words):
        done = subprocess.run([TOOL, *map(str, words)], cwd=cls.folder, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def check(self, command, *runs):
        keys, remark = self.run_tool(command, "--json-keys").split("\n\n")
        self.assertIn("null", remark)
        lines = keys.splitlines()
        starts = [lines[0].index(head) for head in ("key", "type", "unit", "meaning")]
        rows = [[line[start:end].strip() for start, end in zip(starts, [*starts[1:], None])] for line in lines[1:]]
        for path, kind, unit, meaning in rows:
            self.assertTrue(meaning, path)
            self.assertTrue(unit or kind != "number", path)
        objects = {path for path, kind, *_ in rows if kind == "object"}
        known = {path for path, *_ in rows} - objects
        found = set()
        for words in runs:
            found |= set(written(json.loads(self.run_tool(command, *words, "--json", "-")), known))
        self.assertLessEqual(found, known | objects)  # an object may be null
        rare = RARE.get(command, "no key")
        self.assertEqual({path for path in known - found if not re.match(rare, path)}, set())

    def test_inspect(self):
        self.check("inspect", ["first.nc", "damaged.nc"], ["climbs.nc"])

    def test_compare(self):
        self.check("compare", [*FLIGHTS, "-m", MODEL],
                   ["first.nc", "-m", MODEL, "--reference", f"static:{OTHER}", "--reference", "wind"])

    def test_refit(self):
        self.check("refit", [*FLIGHTS, "--holdout", "second.nc", "-m", MODEL, "-o", "fitted.toml",
                             "--fix", "static-qp.a2", "--reference", "lams", "--reference", "wind", "--force"],
                   ["first.nc", "-m", MODEL, "-o", "fitted.toml", "--force"])

    def test_diagnose(self):
        self.check("diagnose", [*FLIGHTS, "second.nc", "-m", "both.toml", "--training-share", "0.8"],
                   ["first.nc", "second.nc", "-m", "both.toml", "--try", "k * (ENGTRQ - 50) / 100"])

    def test_improve(self):
        self.check("improve", [*FLIGHTS, "--holdout", "second.nc", "-m", MODEL, "-o", "best.toml", "--force"])

    def test_check(self):
        self.check("check", [*FLIGHTS, "second.nc", "-m", MODEL])

    def test_process(self):
        self.check("process", ["first.nc", "-m", MODEL, "-o", "corrected.nc"], [*FLIGHTS, "-m", MODEL, "-o", "folder"])

    def test_temperature(self):
        self.check("temperature", ["climbs.nc", "short.nc", *FLIGHTS[1:], "-m", MODEL, "-o", "calibrated.toml", "--iterate",
                                   "--force"])

    def test_simulate(self):
        self.check("simulate", ["hidden.toml", "-o", "hidden.nc"])

    def test_effects(self):
        self.check("effects", [], ["load-factor"], ["lams-fold"])

    def test_add(self):
        self.check("add", ["static-lag", "-m", MODEL, "--flight", "first.nc", "-o", "lag.toml"],
                   ["my-thrust", "--formula", "k * ENGTRQ / 100", "-m", MODEL, "-o", "thrust.toml"],
                   ["load-factor:dynamic_pressure=1", "-m", MODEL, "-o", "scaled.toml"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
