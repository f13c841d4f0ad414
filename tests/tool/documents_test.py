#!/usr/bin/env python3
"""README.md, CONTRIBUTING.md and docs: commands run, printed numbers hold, programs are compiled examples, links resolve.

    documents_test.py TOOL SOURCE_DIRECTORY

The pcor commands of a page run in their order in one folder, which has the flights and models that the pages name. Pages on the
GOTEX flight need its folder in PCOR_FLIGHTS and are skipped otherwise.
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
GOTEX = "GOTEX-rf06-C130-2004.nc"
FLIGHTS = os.environ.get("PCOR_FLIGHTS", "")
PAGES = [SOURCE / "README.md", SOURCE / "CONTRIBUTING.md", SOURCE / "CHANGELOG.md", *sorted((SOURCE / "docs").glob("*.md"))]
# Other documents with links.
LINKED = PAGES + [path for folder in ("data", "tests") for path in sorted((SOURCE / folder).rglob("*.md"))]
# The scenario and options of each simulated flight that pages name.
SIMULATED = {"first.nc": ["c130-hidden"], "second.nc": ["c130-hidden", "--seed", "102"], "third.nc": ["c130-hidden", "--seed", "103"],
             "flights/a.nc": ["c130-short", "--seed", "1"], "flights/b.nc": ["c130-short", "--seed", "2"]}


def blocks(text):
    """(language, content) of every fenced block."""
    found = re.findall(r"^( *)```(\w*)\n(.*?)^\1```", text, flags=re.MULTILINE | re.DOTALL)
    return [(language, re.sub(rf"^{indent}", "", content, flags=re.MULTILINE)) for indent, language, content in found]


def commands_of(content):
    """Commands that a test can run: pcor, pcor-figures, copies of data, and tools of the checkout."""
    lines = content.replace("\\\n", "").splitlines()
    return [line for line in lines if re.match(r"pcor |pcor-figures |cp data/|tools/reference_pages ", line)]


def numbers(line):
    return [float(number) for number in re.findall(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?![\w.]*\w)", line)]


def label(line):
    """The text of a line before its numbers."""
    return re.split(r"\s{2,}[-+]?\d", line)[0].strip()


class PageTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        for name in ("data", "tools", "examples"):
            (self.folder / name).symlink_to(SOURCE / name)
        (self.folder / "flights").mkdir()
        path = self.folder / "build/release/tools"
        path.mkdir(parents=True)
        (path / "pcor").symlink_to(TOOL)
        (path / "pcor-figures").symlink_to(TOOL.parent / "pcor-figures")
        self.environment = {**os.environ, "PATH": f"{path}:{os.environ['PATH']}", "PCOR_MODELS": str(SOURCE / "data/models")}

    def run_command(self, command):
        result = subprocess.run(["bash", "-c", command], cwd=self.folder, env=self.environment, capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, f"{command}: {result.stderr}")
        return result.stdout

    def prepare(self, text):
        """Makes the files that a page uses but does not write."""
        for name, words in SIMULATED.items():
            used = ("flights/*.nc" if name.startswith("flights/") else name) in text
            if used and f"-o {name}" not in text:
                self.run_command(f"pcor simulate data/scenarios/{words[0]}.toml {' '.join(words[1:])} -o {name} --quiet")
        (self.folder / "model.toml").write_bytes((SOURCE / "data/scenarios/models/c130-psfd-eq18.toml").read_bytes())
        for language, content in blocks(text):
            if content.startswith('format = "pcor-intervals/1"'):
                (self.folder / "intervals.toml").write_text(content)
        if FLIGHTS:
            (self.folder / GOTEX).symlink_to(Path(FLIGHTS) / GOTEX)

    def check_output(self, page, output, shown):
        """Each line shown is in the output. Numbers may differ by a tenth, or by 0.05 hPa: fits change with the compiler."""
        lines = [(label(line), numbers(line)) for line in output.splitlines()]
        for line in shown.splitlines():
            candidates = [values for name, values in lines if name == label(line)]
            self.assertTrue(candidates, f"{page}: the output has no line '{label(line)}'")
            expected = numbers(line)
            close = [len(values) == len(expected) and all(abs(a - b) <= 0.05 + 0.1 * abs(b) for a, b in zip(values, expected))
                     for values in candidates]
            self.assertTrue(any(close), f"{page}: '{line}' is printed as {candidates}")

    def check_page(self, path):
        text = path.read_text()
        if GOTEX in text and not FLIGHTS:
            self.skipTest(f"PCOR_FLIGHTS is not set, so there is no {GOTEX}")
        self.prepare(text)
        outputs = []
        for language, content in blocks(text):
            if language == "sh":
                outputs += [self.run_command(command) for command in commands_of(content)]
            elif language == "text":
                self.check_output(path.name, "\n".join(outputs), content)
            elif language == "toml" and 'id = "my-thrust"' in content:
                self.assertIn(re.sub(r" +#.*", "", content), (self.folder / "my-model.toml").read_text())
            elif language == "toml" and content.startswith("[variables]\n"):
                (self.folder / "part.toml").write_text('format = "pcor-model/1"\nname = "part of a model"\n' + content.replace(
                    "[variables]\n", '[variables]\nstatic_pressure = "PSFD"\ndynamic_pressure = "QCF"\nrecovery_temperature = "TTRR"\n'))
                self.run_command("pcor add static-qp -m part.toml -o extended.toml")
        page = self.folder / "build/reference/output-variables.md"
        if page.exists():
            results = (SOURCE / "data/models/FORMAT.md").read_text().split("\n## [output]\n")[1].split("\n## ")[0]
            pattern = r"(?m)^\| `(\w+)` \|"
            self.assertEqual(re.findall(pattern, page.read_text()), re.findall(pattern, results))


class Pages(PageTest):
    """A test for each page with commands."""


def page_test(path):
    return lambda self: self.check_page(path)


for page in PAGES:
    if any(language == "sh" and commands_of(content) for language, content in blocks(page.read_text())):
        setattr(Pages, f"test_{page.stem.lower().replace('-', '_')}", page_test(page))


class Help(PageTest):
    def test_examples_run_on_short_flights(self):
        self.prepare("")
        for seed, name in enumerate(("first", "second", "third"), 1):
            self.run_command(f"pcor simulate data/scenarios/c130-short.toml --seed {seed} -o {name}.nc --quiet")
        for command in ("simulate data/scenarios/c130-climbs.toml -o climbs.nc", "refit first.nc second.nc -m model.toml -o fitted.toml",
                        "improve first.nc second.nc -m model.toml -o best.toml", "process third.nc -m best.toml -o corrected.nc"):
            self.run_command(f"pcor {command}")
        for command in re.findall(r"^  (\w+) ", self.run_command("pcor --help").split("Subcommands:")[1], flags=re.MULTILINE):
            for example in self.run_command(f"pcor {command} --help").split("\nExamples:\n")[1].strip().splitlines():
                self.run_command(example)


class Text(unittest.TestCase):
    def test_programs_are_parts_of_compiled_examples(self):
        sources = [path.read_text() for path in (SOURCE / "examples").rglob("*.cpp")]
        for path in PAGES:
            for language, content in blocks(path.read_text()):
                if language == "cpp":
                    self.assertTrue(any(content in source for source in sources), f"{path.name}: {content}")

    def test_build_files_are_those_of_examples(self):
        lines = {re.sub(r"\(\w+ PRIVATE", "(my_program PRIVATE", line)
                 for path in (SOURCE / "examples").rglob("CMakeLists.txt") for line in path.read_text().splitlines()}
        for path in PAGES:
            for language, content in blocks(path.read_text()):
                if language == "cmake":
                    self.assertLessEqual({re.sub(r" +#.*", "", line) for line in content.splitlines()}, lines, path.name)

    def test_set_up_commands_are_those_of_continuous_integration(self):
        for command in ("tools/demo", "tools/check"):
            self.assertTrue(os.access(SOURCE / command, os.X_OK), command)
            self.assertRegex((SOURCE / "README.md").read_text(), rf"(?m)^{command} ")
            self.assertIn(f"\n{command}\n", (SOURCE / ".ci/run").read_text())

    def test_links_resolve(self):
        def anchors(path):
            headings = re.findall(r"^#+ (.*)$", path.read_text(), flags=re.MULTILINE)
            return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}

        for path in LINKED:
            text = re.sub(r"^( *)```.*?^\1```|`[^`\n]*`", "", path.read_text(), flags=re.MULTILINE | re.DOTALL)
            for target in re.findall(r"\]\(([^)\s]+)\)", text):
                if "://" in target:
                    continue
                file, _, anchor = target.partition("#")
                linked = path.parent / file if file else path
                self.assertTrue(linked.exists(), f"{path.relative_to(SOURCE)}: {target}")
                if anchor:
                    self.assertIn(anchor, anchors(linked), f"{path.relative_to(SOURCE)}: {target}")

    def test_pages_are_short(self):
        """Limits on the lengths of the first page and of the documents."""
        first = (SOURCE / "README.md").read_text().split("## For the developer")[0]
        self.assertLessEqual(len(first.split()), 400)
        self.assertLess(sum(len(path.read_text().split()) for path in (SOURCE / "docs").glob("*.md")), 12000)
        changes = (SOURCE / "CHANGELOG.md").read_text().split("\n## ")[1]
        self.assertLessEqual(len(changes.split()), 800)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)  # which gives the reason of a test that is skipped
