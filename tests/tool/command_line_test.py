#!/usr/bin/env python3
"""The command line: options, outputs, hints, help, terminal and shell.

    command_line_test.py TOOL SOURCE_DIRECTORY
"""

import fcntl
import os
import pty
import re
import shutil
import struct
import subprocess
import sys
import termios
import tomllib
import unittest

import netCDF4

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
import comparison_test  # noqa: E402
from comparison_test import FLIGHTS, ONE, TWO, ComparisonTest  # noqa: E402
from scenarios import simulate  # noqa: E402
from tool_test import SOURCE, TOOL, replace  # noqa: E402

THREE = FLIGHTS / "three.nc"


def setUpModule():
    for output, seed in ((ONE, 3), (TWO, 4), (THREE, 5)):
        simulate(TOOL, output, comparison_test.SCENARIO, seed)


def tearDownModule():
    comparison_test.MADE.cleanup()


class Lists(ComparisonTest):
    """A repeatable option takes one value each time: the next argument is a flight."""

    def test_holdout_option_takes_one_flight(self):
        fit = self.json_of("refit", "--holdout", THREE, ONE, TWO, "-m", self.model(), "-o", self.path / "out.toml")
        self.assertEqual([(flight["name"], flight["holdout"]) for flight in fit["flights"]],
                         [("one.nc", False), ("two.nc", False), ("three.nc", True)])

    def test_every_list_option_takes_one_value(self):
        model, output = self.model(), self.path / "out.toml"
        for command, *option in (("refit", "--exclude", "turn"), ("refit", "--fix", "static-qp"),
                                 ("refit", "--free", "static-qp"), ("refit", "--reference", "lams"),
                                 ("refit", "--stage", "pitch manoeuvre: static-alpha"),
                                 ("compare", "--exclude", "turn"), ("diagnose", "--not-variable", "ENGTRQ"),
                                 ("diagnose", "--try", "k * ENGTRQ / 100")):
            with self.subTest(option):
                more = ("-o", output) if command == "refit" else ("--no-file-variables",) * (command == "diagnose")
                self.done(command, *option, ONE, "-m", model, *more, "--quiet")
        self.done("compare", "-m", model, ONE, "--quiet")

    def test_lists_are_given_by_repeating(self):
        fit = self.json_of("refit", ONE, "--holdout", TWO, "--holdout", THREE, "-m", self.model(), "-o",
                           self.path / "out.toml")
        self.assertEqual([flight["name"] for flight in fit["flights"] if flight["holdout"]], ["two.nc", "three.nc"])

    def test_held_out_flights_of_a_glob_are_not_fitted(self):
        """`refit one.nc --holdout t*.nc`: the shell expands the pattern to two names, and the second would be
        fitted."""
        for command in ("refit", "improve"):
            self.refused(command, ONE, "--holdout", THREE, TWO, "-m", self.model(), "-o", self.path / "out.toml",
                         words=["--holdout", f"--holdout {THREE} --holdout {TWO}"], status=2)


class Outputs(ComparisonTest):
    def assert_no_file_called_dash(self):
        self.assertFalse((self.path / "-").exists())

    def test_a_model_goes_to_standard_output(self):
        for command in (("add", "static-lag"), ("refit", ONE), ("improve", ONE)):
            with self.subTest(command[0]):
                result = self.done(*command, "-m", self.model(), "-o", "-", cwd=self.path)
                self.assertEqual(tomllib.loads(result.stdout)["format"], "pcor-model/1")
                self.assertEqual(result.stderr, "")
                self.assert_no_file_called_dash()

    def test_a_calibrated_model_goes_to_standard_output(self):
        """Twenty minutes are too short for a thermometer: --force writes the model with a note."""
        model = self.model(lambda toml: toml)
        result = self.done("temperature", ONE, "-m", model, "-o", "-", "--force", cwd=self.path)
        self.assertIn("forced", tomllib.loads(result.stdout)["provenance"])
        self.assert_no_file_called_dash()

    def test_two_results_on_standard_output_are_refused(self):
        self.refused("refit", ONE, "-m", self.model(), "-o", "-", "--json", "-", words=["twice"])
        self.refused("refit", ONE, "-m", self.model(), "-o", "-", "--refit-reference", "-", words=["twice"])

    def test_other_files_do_not_go_to_standard_output(self):
        model, scenario = self.model(), SOURCE / "data/scenarios/c130-short.toml"
        for command in (("process", ONE, "-m", model, "-o", "-"), ("simulate", scenario, "-o", "-"),
                        ("compare", ONE, "-m", model, "--residuals", "-"), ("compare", ONE, "-m", model, "--report", "-")):
            with self.subTest(command[0]):
                result = self.run_tool(*command, cwd=self.path)
                self.assertEqual((result.returncode, result.stdout), (2, ""))
                self.assertRegex(result.stderr, r"^pcor: --\w+: .*'-'.*models and JSON")
                self.assert_no_file_called_dash()

    def test_every_file_is_announced(self):
        """For each command: its summary line lists exactly the files that it wrote."""
        model = self.model()
        before = set(os.listdir(self.path))
        report, result = ("--report", "r.html"), ("--json", "r.json")
        scenario = SOURCE / "data/scenarios/c130-short.toml"
        for command in (("compare", ONE, TWO, "-m", model, "--residuals", "res.nc", "--table", "t.csv", *report,
                         *result),
                        ("refit", ONE, "-m", model, "-o", "o.toml", "--table", "t.csv", *report, *result),
                        ("inspect", ONE, "--write-model", "o.toml", *report, *result),
                        ("refit", ONE, "-m", model, "-o", "o.toml", "--reference", f"static:{comparison_test.OTHER_SYSTEM}",
                         "--refit-reference", "second.toml"),
                        ("diagnose", ONE, "-m", model, *report, *result), ("effects", *result),
                        ("effects", "static-lag", *result), ("effects", "lams-fold", *result),
                        ("add", "static-lag", "-m", model, "-o", "o.toml", *result),
                        ("improve", ONE, "-m", model, "-o", "o.toml", *report, *result),
                        ("check", ONE, "-m", model, *report, *result),
                        ("temperature", ONE, "-m", model, "-o", "o.toml", "--force", *report, *result),
                        ("process", ONE, "-m", model, "-o", "o.nc", *result),
                        ("simulate", scenario, "-o", "o.nc", *result)):
            with self.subTest(command[0]):
                text = self.done(*command, cwd=self.path).stdout
                lines = " ".join(line for line in text.splitlines() if line.startswith("wrote "))
                written = set(os.listdir(self.path)) - before
                self.assertTrue(written)
                self.assertEqual(set(re.findall(r"[\w-]+\.(?:nc|toml|html|json|csv)", lines)), written)
                for name in written:
                    (self.path / name).unlink()

    def test_overwritten_files_are_announced_or_refused(self):
        command = ("refit", ONE, "-m", self.model(), "-o", "o.toml", "--json", "r.json")
        self.done(*command, "--no-clobber", cwd=self.path)
        (self.path / "r.json").unlink()
        text = self.done(*command, cwd=self.path).stdout
        self.assertIn("\noverwrote o.toml\n", text)
        self.assertIn("\nwrote r.json\n", text)
        self.refused("inspect", ONE, "--write-model", self.path / "o.toml", words=["o.toml", "coefficients"])
        before = comparison_test.contents(self.path)
        result = self.run_tool(*command, "--no-clobber", cwd=self.path)
        self.assertEqual((result.returncode, result.stdout, result.stderr.count("\n")), (1, "", 1))
        self.assertIn("o.toml", result.stderr)
        self.assertEqual(comparison_test.contents(self.path), before)

    def test_inspect_overwrites_only_a_model_without_coefficients(self):
        """An added effect gives a model its provenance, but no coefficient."""
        zero, more, law = (self.path / name for name in ("zero.toml", "more.toml", "law.toml"))
        self.done("inspect", ONE, "--write-model", zero)
        self.done("add", "static-mach", "-m", zero, "-o", more)
        self.done("inspect", ONE, "--write-model", more)
        self.assertEqual(more.read_bytes(), zero.read_bytes())
        shutil.copy(SOURCE / "data/models/c130-psfd-2014.toml", law)
        self.refused("inspect", ONE, "--write-model", law, words=["law.toml", "coefficients"])

    def test_an_output_has_fifteen_lines_and_details_with_verbose(self):
        model = self.model()
        for command in (("inspect", ONE), ("compare", ONE, TWO, "-m", model), ("refit", ONE, "-m", model, "-o", "o.toml"),
                        ("diagnose", ONE, "-m", model), ("improve", ONE, "-m", model, "-o", "o.toml"),
                        ("check", ONE, "-m", model), ("temperature", ONE, "-m", model, "-o", "o.toml", "--force"),
                        ("process", ONE, "-m", model, "-o", "o.nc")):
            with self.subTest(command[0]):
                lines = self.run_tool(*command, "--report", "r.html", cwd=self.path).stdout.splitlines()
                self.assertGreater(len(lines), 2)
                self.assertLessEqual(len(lines), 15, "\n".join(lines))
                details = self.run_tool(*command, "--verbose", cwd=self.path).stdout.splitlines()
                self.assertGreaterEqual(len(details), len(lines))

    def test_notes_on_details_are_printed_with_verbose(self):
        details = [note["text"] for note in self.compare()["notes"] if note["severity"] == "detail"]
        self.assertTrue(details)
        short, full = self.run_tool("compare", ONE, "-m", self.model()).stdout, self.done("compare", ONE, "-m", self.model()).stdout
        for text in details:
            self.assertNotIn(text[:60], short)
            self.assertIn(text, full)

    def test_files_of_a_refused_fit_are_announced(self):
        result = self.run_tool("temperature", ONE, "-m", self.model(), "-o", "o.toml", "--report", "r.html", cwd=self.path)
        self.assertEqual(result.returncode, 1)
        self.assertIn("no model was written", result.stderr)
        self.assertIn("\nwrote r.html\n", result.stdout)


class Hints(ComparisonTest):
    def test_printed_commands_use_the_program_path_as_called(self):
        folder = self.path / "my tools"
        folder.mkdir()
        (folder / "pcor").symlink_to(TOOL)
        self.model()
        self.link(ONE, "one.nc")
        for command in (("compare", "one.nc", "-m", "model.toml"), ("diagnose", "one.nc", "-m", "model.toml"),
                        ("check", "one.nc", "-m", "model.toml"), ("effects",),
                        ("add", "static-lag", "-m", "model.toml", "--flight", "one.nc", "-o", "o.toml"),
                        ("refit", "one.nc", "-m", "model.toml", "-o", "o.toml")):
            with self.subTest(command[0]):
                result = subprocess.run(["my tools/pcor", *command], cwd=self.path, capture_output=True, text=True)
                hint = re.search(r": ('my tools/pcor' .*)\n$", result.stdout)
                self.assertTrue(hint, result.stdout[-300:])
                again = subprocess.run(hint.group(1), shell=True, cwd=self.path, capture_output=True, text=True)
                self.assertEqual(again.returncode, 0, again.stderr)
        for arguments in ((), ("refitt",), ("refit", "--modle"), ("refit",)):
            result = subprocess.run(["my tools/pcor", *arguments], cwd=self.path, capture_output=True, text=True)
            self.assertRegex(result.stderr, r": 'my tools/pcor' .*--help\n$")

    def test_another_name_has_the_right_one(self):
        compare = ("compare", ONE, "-m", self.model())
        for words, meant in ((("--figures",), "pcor-figures"), (("--processes", "2"), "pcor_mpi"), (("--html", "a.html"), "--report"),
                             (("--plot",), "--report"), (("--from", "14:30"), "--intervals")):
            self.assertIn(f"did you mean {meant}?", self.refused(*compare, *words, words=[words[0]], status=2))
        self.assertNotIn("--report", self.refused("add", "--html", words=["--html"], status=2))
        self.assertIn("did you mean compare?", self.refused("evaluate", ONE, words=["evaluate"], status=2))
        for reference, meant in (("static:PSFRD+QCFR", "total:PSFRD+QCFR"), ("PSFRD+QCFR", "total:PSFRD+QCFR"), ("gps", "height or wind"),
                                 ("laser", "lams"), ("PSFRD", "pressure:PSFRD"), ("winds", "wind"), ("static", "static:OTHER.toml"),
                                 ("other.toml", "static:other.toml"), ("c130-psfrd-2003", "static:c130-psfrd-2003")):
            message = self.refused(*compare, "--reference", reference, words=[meant])
            self.assertLessEqual(len(message), 160)

    def test_a_scenario_has_a_name(self):
        for number, scenario in enumerate(("c130-short", SOURCE / "data/scenarios/c130-short.toml")):
            self.done("simulate", scenario, "-o", self.path / f"{number}.nc")
        with netCDF4.Dataset(self.path / "0.nc") as named, netCDF4.Dataset(self.path / "1.nc") as given:
            self.assertTrue((named["PSFD"][:] == given["PSFD"][:]).all())
        self.refused("simulate", "c130-shortt", "-o", self.path / "2.nc", words=["c130-short"])
        self.assertIn("formula (unknown)", self.done("simulate", "c130-hidden", "-o", self.path / "3.nc").stdout)

    def test_each_command_prints_its_version(self):
        version = self.run_tool("--version").stdout
        self.assertRegex(version, r"^pcor \d")
        for command in ("compare", "refit", "diagnose", "effects", "add", "improve", "check", "process", "temperature",
                        "inspect", "simulate"):
            self.assertEqual(self.done(command, "--version").stdout, version)


def commands_of(text):
    """The sub-commands in the help of the program."""
    return re.findall(r"^  (\w+) ", text[text.index("Subcommands:"):], flags=re.MULTILINE)


class Help(ComparisonTest):
    def test_every_help_ends_with_examples(self):
        for command in commands_of(self.done("--help").stdout):
            text = self.done(command, "--help").stdout
            examples = text[text.index("\nExamples:\n"):].strip().splitlines()[1:]
            self.assertIn(len(examples), (1, 2, 3))
            for example in examples:
                self.assertTrue(example.startswith(f"  {TOOL} {command}"), example)
            self.assertNotIn("\n\n\n", text)

    def test_help_precedes_or_follows_the_command(self):
        for word in ("help", "--help", "-h"):
            self.assertEqual(self.done(word, "refit").stdout, self.done("refit", "--help").stdout)
            self.assertEqual(self.done(word).stdout, self.done("--help").stdout)
            self.refused(word, "refitt", words=["'refitt'", "did you mean refit?"], status=2)

    def test_reference_of_temperature_needs_iterate(self):
        self.assertIn("with --iterate only", self.done("temperature", "--help").stdout)

    def test_old_names_work_and_print_the_new_names(self):
        second = comparison_test.OTHER_SYSTEM
        now = self.done("check", ONE, "-m", self.model(), "--reference", f"static:{second}")
        old = self.done("check", ONE, "-m", self.model(), "--second", second)
        self.assertEqual(now.stdout, old.stdout)
        self.assertEqual((now.stderr, old.stderr),
                         ("", "pcor: --second was renamed to --reference static:OTHER.toml; the old name is deprecated\n"))
        arguments = ("diagnose", ONE, "-m", self.model(), "--no-file-variables")
        brief, now, old = (self.done(*arguments, *more) for more in ((), ("--full",), ("--all",)))
        self.assertEqual(now.stdout, old.stdout)
        self.assertLess(len(brief.stdout), len(now.stdout))
        self.assertIn("--full", old.stderr)
        for command, name in (("check", "--second"), ("diagnose", "--all")):
            self.assertNotIn(name, self.done(command, "--help").stdout)

    def test_check_accepts_only_a_second_system_as_reference(self):
        self.refused("check", ONE, "-m", self.model(), "--reference", "lams", words=["'lams'", "static:OTHER.toml"], status=2)

    def test_the_documented_intervals_are_read(self):
        (example,) = re.findall(r"```toml\n(.*?)```", (SOURCE / "docs/intervals.md").read_text(), flags=re.DOTALL)
        example = example.replace("first.nc", ONE.name).replace("20:30", "20:11").replace("20:31", "20:12")
        intervals = self.write("intervals.toml", example)
        masks = self.compare("--intervals", intervals)["masks"]
        self.assertEqual(masks["excluded"], 60)


class Terminal(ComparisonTest):
    """Output on a terminal of a given width, simulated by a pseudo-terminal."""

    def shown(self, width, *arguments, stated="", **more):
        master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, width, 0, 0))
        environment = {key: value for key, value in os.environ.items() if key not in ("COLUMNS", "TERM", "NO_COLOR")}
        environment.update(more)
        if stated:
            environment["COLUMNS"] = stated
        with subprocess.Popen([TOOL, *arguments], stdout=slave, stderr=subprocess.DEVNULL, env=environment) as run:
            os.close(slave)
            text = b""
            while True:
                try:
                    part = os.read(master, 65536)
                except OSError:  # Linux says so that the other side is closed.
                    break
                if not part:
                    break
                text += part
        os.close(master)
        self.assertEqual(run.returncode, 0)
        return text.decode().replace("\r\n", "\n")

    def test_lines_are_folded_at_the_width(self):
        plain = self.done("refit", "--help").stdout
        self.assertGreater(max(map(len, plain.splitlines())), 300)
        for width, stated in ((80, ""), (100, ""), (200, "72")):
            text = self.shown(width, "refit", "--help", stated=stated)
            prose = text[: text.index("Examples:")]
            self.assertLessEqual(max(map(len, prose.splitlines())), int(stated or width))
            self.assertEqual(text.split(), plain.split())

    def test_rows_of_tables_are_broken_between_columns(self):
        plain = self.done("effects", "--verbose").stdout
        text = self.shown(80, "effects", "--verbose")
        self.assertLessEqual(max(map(len, text.splitlines()[:-1])), 80)
        self.assertEqual(text.split(), plain.split())
        self.assertRegex(text, r"(?m)^static-lag +lag +static-line +static-line\n +pneumatic lag of the static line\n")

    def test_verdicts_are_coloured_only_on_a_terminal(self):
        plain = self.done("check", ONE).stdout
        self.assertNotIn("\033", plain)
        self.assertRegex(self.shown(80, "check", ONE, "--verbose", TERM="xterm"), "\033\\[3[123]m(in)?consistent\033")
        coloured = self.shown(9000, "check", ONE, "--verbose", TERM="xterm")
        self.assertRegex(coloured, "(?m)^total-pressure +\033\\[3[123]m(in)?consistent\033\\[0m ")
        self.assertEqual(re.sub("\033\\[[0-9]+m", "", coloured), plain)
        for refused in ({"TERM": "xterm", "NO_COLOR": "1"}, {"TERM": "dumb"}, {}):
            self.assertEqual(self.shown(9000, "check", ONE, "--verbose", **refused), plain)

    def test_labels_of_notes_are_bold_on_a_terminal(self):
        late = self.model(replace(r"^valid_from = .*$", 'valid_from = "2012-01-01"'))
        numbered = self.shown(9000, "compare", ONE, "-m", late, TERM="xterm")
        self.assertIn("\n\033[1mwarning 1\033[0m: the law is valid", numbered)
        self.assertIn("\n\033[1mnote 2\033[0m: ", numbered)
        complete = self.shown(9000, "compare", ONE, "-m", late, "--verbose", TERM="xterm")
        self.assertIn("\n\033[1mWarning\033[0m: the law is valid", complete)
        self.assertIn("\n\033[1mNote\033[0m: ", complete)

    def test_a_printed_command_is_not_wrapped(self):
        model = self.model()
        text = self.shown(60, "compare", ONE, "-m", model)
        command = text.strip().splitlines()[-1]
        self.assertRegex(command, rf"^  {re.escape(str(TOOL))} (process|refit) ")
        self.assertEqual(command.strip(), self.done("compare", ONE, "-m", model).stdout.strip().splitlines()[-1].split(": ")[-1])
        commands = [line for line in self.done("inspect", ONE).stdout.splitlines() if line.startswith(f"  {TOOL} ")]
        self.assertGreater(len(commands), 1)
        self.assertLessEqual(set(commands), set(self.shown(60, "inspect", ONE).splitlines()))


class Shell(ComparisonTest):
    def completed(self, *words, end="printf '%s\\n' \"${COMPREPLY[@]}\""):
        """Completions by bash of the last word of a command line; or the output of `end`."""
        script = self.write("pcor.bash", self.done("completion", "bash").stdout)
        subprocess.run(["bash", "-n", script], check=True)
        line = " ".join(f"'{word}'" for word in ("pcor", *words))
        ask = f"source {script}; COMP_WORDS=({line}); COMP_CWORD={len(words)}; _pcor; {end}"
        result = subprocess.run(["bash", "-c", ask], cwd=self.path, check=True, capture_output=True, text=True)
        self.assertEqual(result.stderr, "")
        return [word for word in result.stdout.split("\n") if word]

    def test_sub_commands_are_completed(self):
        commands = commands_of(self.done("--help").stdout)
        self.assertLessEqual(set(commands), set(self.completed("")))
        self.assertEqual(self.completed("ref"), ["refit"])

    def test_options_are_completed(self):
        self.assertEqual(self.completed("refit", "--ho"), ["--holdout"])
        for command in commands_of(self.done("--help").stdout):
            known = re.findall(r"^ +(?:-\w,)?(--[\w-]+)", self.done(command, "--help").stdout, flags=re.MULTILINE)
            self.assertLessEqual(set(known), set(self.completed(command, "-")))
        self.assertNotIn("--second", self.completed("check", "-"))

    def test_values_are_completed(self):
        self.assertEqual(self.completed("refit", "--loss", "hu"), ["huber"])
        self.assertEqual(self.completed("refit", "--exclude", "pitch"), ["pitch manoeuvre"])
        self.assertEqual(self.completed("effects", "static-qp"), ["static-qp"])
        self.assertIn("total:", self.completed("compare", "one.nc", "--reference", ""))
        self.assertEqual(self.completed("refit", "--min-airspeed", ""), [])
        self.assertEqual(self.completed("refit", "--loss", "=", "hu"), ["huber"])

    def test_files_are_completed(self):
        for name in ("one.nc", "two.nc", "law.toml", "page.html", "notes.txt"):
            self.write(name, "")
        (self.path / "flights").mkdir()
        self.assertEqual(set(self.completed("refit", "")), {"one.nc", "two.nc", "flights"})
        self.assertEqual(set(self.completed("refit", "one.nc", "-m", "")), {"law.toml", "flights"})
        self.assertEqual(self.completed("refit", "one.nc", "--holdout", "t"), ["two.nc"])
        self.assertEqual(self.completed("refit", "--reference", "static", ":", "l"), ["law.toml"])
        self.assertEqual(self.completed("process", "one.nc", "--json", "no"), ["notes.txt"])
        self.assertEqual(self.completed("process", "one.nc", "--models", ""), ["flights"])

    def test_completion_does_not_quote_a_colon(self):
        """Readline quotes file names, as needed for names with blanks."""
        for words, quotes in (("check", "--reference", "st"), False), (("refit", "--exclude", "pit"), True):
            told = self.completed(*words, end='compopt() { echo "$*"; }; _pcor')
            self.assertEqual("filenames" in told, quotes, words)

    def test_manual_pages(self):
        self.done("man", "--folder", self.path)
        pages = {f"pcor-{command}.1" for command in commands_of(self.done("--help").stdout)} | {"pcor.1"}
        self.assertEqual(set(os.listdir(self.path)), pages)
        self.assertEqual(self.done("man", "refit").stdout, (self.path / "pcor-refit.1").read_text())
        refit = (self.path / "pcor-refit.1").read_text()
        for words in ("\\fB\\-m\\fR, \\fB\\-\\-model\\fR \\fIMODEL.toml\\fR", ".SH EXAMPLES", "  pcor refit first.nc"):
            self.assertIn(words, refit)
        for checker in (["groff", "-man", "-ww", "-z"], ["mandoc", "-Tlint", "-Wwarning"]):
            if shutil.which(checker[0]):
                for page in pages:
                    result = subprocess.run([*checker, self.path / page], capture_output=True, text=True)
                    self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""), page)

    def test_no_manual_page_of_an_unknown_sub_command(self):
        self.refused("man", "refitt", words=["refitt"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
