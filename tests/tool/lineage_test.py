#!/usr/bin/env python3
"""Name and origin of a fitted model, and the origin that a report states.

    lineage_test.py TOOL SOURCE_DIRECTORY
"""

import re
import subprocess
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

TOOL = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()
MODEL = SOURCE / "data/scenarios/models/c130-psfd-eq18.toml"
NAME = "C-130 PSFD/QCF, equation 18"
FLIGHT = "SIMULATION c130-short 2011-11-17"


class Lineage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = Path(folder.name)
        for name, seed in (("one", "1"), ("two", "2"), ("three", "3")):
            cls.run_tool("simulate", SOURCE / "data/scenarios/c130-short.toml", "--seed", seed, "-o", f"{name}.nc")
        cls.run_tool("refit", "one.nc", "-m", MODEL, "-o", "first.toml", "--force")
        cls.run_tool("refit", "one.nc", "two.nc", "-m", "first.toml", "-o", "second.toml", "--force",
                     "--holdout", "three.nc", "--report", "refit.html")
        cls.run_tool("improve", "one.nc", "-m", "second.toml", "-o", "best.toml", "--force")

    @classmethod
    def run_tool(cls, *arguments):
        result = subprocess.run([TOOL, *arguments], capture_output=True, text=True, cwd=cls.path)
        assert result.returncode == 0, result.stderr
        return result.stdout

    def model(self, name):
        return tomllib.loads((self.path / name).read_text())

    def test_fitted_model_has_a_new_name(self):
        self.assertEqual(self.model("first.toml")["name"], f"{NAME}, fitted to {FLIGHT}")
        self.assertEqual(self.model("second.toml")["name"], f"{NAME}, fitted to {FLIGHT} and 1 more")
        self.assertEqual(self.model("best.toml")["name"], f"{NAME}, fitted to {FLIGHT}")

    def test_source_states_only_the_last_fit(self):
        for name in ("first.toml", "second.toml", "best.toml"):
            self.assertRegex(self.model(name)["law"]["source"], "^refit by pcor to [^;]*$")

    def test_earlier_sources_are_a_list(self):
        first, second, best = (self.model(name) for name in ("first.toml", "second.toml", "best.toml"))
        published = {"name": NAME, "source": self.model(MODEL)["law"]["source"]}
        of_first = {"name": first["name"], "date": first["provenance"]["date"], "source": first["law"]["source"]}
        of_second = {"name": second["name"], "date": second["provenance"]["date"], "source": second["law"]["source"]}
        self.assertEqual(first["provenance"]["before"], [published])
        self.assertEqual(second["provenance"]["before"], [published, of_first])
        self.assertEqual(best["provenance"]["before"], [published, of_first, of_second])

    def test_name_given_by_the_author_is_kept(self):
        own = self.path / "own.toml"
        own.write_text(MODEL.read_text().replace(NAME, "mine, fitted to my data"))
        self.run_tool("refit", "one.nc", "-m", "own.toml", "-o", "from_own.toml", "--force")
        self.assertEqual(self.model("from_own.toml")["name"], f"mine, fitted to my data, fitted to {FLIGHT}")

    def test_models_with_equal_names_are_distinguished_by_files(self):
        (self.path / "twin.toml").write_text((self.path / "first.toml").read_text())
        text = self.run_tool("compare", "one.nc", "-m", "first.toml", "-m", "twin.toml", "-m", MODEL)
        self.assertRegex(text, r"(?m)^first\.toml  +923 ")
        self.assertRegex(text, r"(?m)^twin\.toml  +923 ")
        self.assertRegex(text, f"(?m)^{re.escape(NAME)}  +923 ")

    def test_a_report_states_its_origin(self):
        html = (self.path / "refit.html").read_text()
        foot = html[html.index("<footer>"):html.index("</footer>")]
        for words in ("pcor refit one.nc two.nc -m first.toml", "by pcor 0.", "first.toml, second.toml",
                      "<dt>Fitted flights</dt>\n<dd>one.nc, two.nc</dd>", "<dt>Held-out flights</dt>\n<dd>three.nc</dd>"):
            self.assertIn(words, foot)
        self.assertRegex(foot, r"\d{4}-\d\d-\d\d \d\d:\d\d UTC")

    def test_every_report_has_its_command(self):
        for command in (["compare"], ["diagnose"], ["check"], ["improve", "-o", "more.toml", "--force"]):
            with self.subTest(command=command[0]):
                self.run_tool(command[0], "one.nc", "-m", "first.toml", *command[1:], "--report", "report.html")
                self.assertIn(f"pcor {command[0]} one.nc -m first.toml", (self.path / "report.html").read_text())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
