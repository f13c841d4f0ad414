#!/usr/bin/env python3
"""What the README says is what the project does.

    readme_test.py TOOL SOURCE_DIRECTORY

Its commands are run in their order, its model snippet is what they write and is used, its program is the compiled
example. The two set-up commands are run by continuous integration itself.
"""

import os
import re
import shlex
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOOL = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()
README = (SOURCE / "README.md").read_text()


def blocks(language):
    found = re.findall(rf"^( *)```{language}\n(.*?)^\1```", README, flags=re.MULTILINE | re.DOTALL)
    return [re.sub(rf"^{indent}", "", text, flags=re.MULTILINE) for indent, text in found]


class Readme(unittest.TestCase):
    def test_set_up_commands_can_be_run(self):
        commands = [block.split("#")[0].strip() for block in blocks("sh")[:2]]
        self.assertEqual(commands, ["tools/demo", "tools/check"])
        for command in commands:
            self.assertTrue(os.access(SOURCE / command, os.X_OK), command)
            self.assertIn(f"\n{command}\n", (SOURCE / ".ci/run").read_text())

    def test_tool_commands_work(self):
        commands = re.findall(r"^(?:(?:build/release/tools/)?pcor|cp) .*$", "\n".join(blocks("sh")).replace("\\\n", ""),
                              flags=re.MULTILINE)
        commands += re.findall(r"`(pcor [^`]+)`", README)
        self.assertGreaterEqual(len(commands), 10)
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "data").symlink_to(SOURCE / "data")
            for command in commands:
                words = [str(TOOL) if word.endswith("pcor") else word for word in shlex.split(command)]
                result = subprocess.run(words, cwd=folder, capture_output=True, text=True)
                self.assertEqual(result.returncode, 0, f"{command}: {result.stderr}")
            (snippet,) = blocks("toml")
            self.assertIn(re.sub(r" +#.*", "", snippet), (Path(folder) / "my-model.toml").read_text())
            self.examples_of_the_help_work(folder)

    def examples_of_the_help_work(self, folder):
        """On the flights that the commands of the README made."""
        def text(*words):
            return subprocess.run([TOOL, *words], cwd=folder, check=True, capture_output=True, text=True).stdout

        for command in re.findall(r"^  (\w+) ", text("--help").split("Subcommands:")[1], flags=re.MULTILINE):
            for example in text(command, "--help").split("\nExamples:\n")[1].strip().splitlines():
                result = subprocess.run(example, shell=True, cwd=folder, capture_output=True, text=True)
                self.assertEqual(result.returncode, 0, f"{example}: {result.stderr}")

    def test_model_snippet_is_a_model(self):
        (snippet,) = blocks("toml")
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder)
            cdl = subprocess.run([SOURCE / "tools/make_example_flight"], check=True, capture_output=True, text=True)
            text = cdl.stdout.replace("GGALT", "ENGTRQ")
            subprocess.run(["ncgen", "-o", path / "in.nc", "-"], input=text, check=True, text=True)
            model = (SOURCE / "data/models/c130-psfd-eq18.toml").read_text()
            (path / "model.toml").write_text(model + "\n" + snippet)
            subprocess.run([TOOL, "process", path / "in.nc", "-m", path / "model.toml", "-o", path / "out.nc"],
                           check=True, capture_output=True)

    def test_program_is_the_compiled_example(self):
        (program,) = blocks("cpp")
        self.assertEqual(program, (SOURCE / "examples/realtime/sample_loop.cpp").read_text())

    def test_links_lead_somewhere(self):
        for target in re.findall(r"\]\(([^)#]+)\)", README):
            self.assertTrue((SOURCE / target).exists(), target)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])
