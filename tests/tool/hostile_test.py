#!/usr/bin/env python3
"""The tool under failures of the system: full disks, signals, closed streams, random texts.

    hostile_test.py TOOL SOURCE_DIRECTORY
"""

import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import unittest
from pathlib import Path

TOOL = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()
SCENARIO = SOURCE / "data/scenarios/c130-short.toml"
LAW = SOURCE / "data/scenarios/models/c130-psfd-eq18.toml"
MODEL = LAW.read_text()
INTERVALS = 'format = "pcor-intervals/1"\n'
FOLDER = tempfile.TemporaryDirectory()
FLIGHT = Path(FOLDER.name) / "flight.nc"


class HostileTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)

    def run_tool(self, *arguments, **options):
        return subprocess.run([TOOL, *arguments], capture_output=True, timeout=60, **options)

    def assert_refused(self, result, *words):
        """Status 1 and one line of at most 2000 characters without control sequences."""
        message = result.stderr.decode()
        self.assertEqual(result.returncode, 1, message[:300])
        self.assertRegex(message, r"\Apcor: [^\x00-\x1f\x7f-\x9f]*\n\Z")
        self.assertLess(len(message), 2100)
        for word in words:
            self.assertIn(word, message)


class Disks(HostileTest):
    def test_a_full_disk_is_an_error_without_a_crash(self):
        script = 'mount -t tmpfs -o size=300k none "$1" && "$0" simulate "$2" -o "$1/out.nc" --quiet; ' \
                 'echo "status $?, left: $(ls -A "$1")"'
        result = subprocess.run(["unshare", "-rm", "sh", "-c", script, TOOL, self.path, SCENARIO],
                                capture_output=True, text=True)
        if "status" not in result.stdout or "mount:" in result.stderr:
            self.skipTest("no disk can be made here")
        self.assertEqual(result.stdout, "status 1, left: \n")
        self.assertRegex(result.stderr, r"\Apcor: .*out\.nc.*full.*; make room or choose another output\n\Z")

    def test_refusal_on_a_full_disk_keeps_its_message(self):
        """At the end of the program HDF5 tries again to write what failed."""
        script = 'mount -t tmpfs -o size=300k none "$1" && head -c 100k /dev/zero > "$1/filled" && ' \
                 '"$0" process "$2" -m "$3" -o "$1/out.nc" --all --quiet; echo "status $?, left: $(ls -A "$1")"'
        result = subprocess.run(["unshare", "-rm", "sh", "-c", script, TOOL, self.path, FLIGHT, LAW],
                                capture_output=True, text=True)
        if "status" not in result.stdout or "mount:" in result.stderr:
            self.skipTest("no disk can be made here")
        self.assertEqual(result.stdout, "status 1, left: filled\n")
        self.assertRegex(result.stderr, r"\Apcor: .*it has a variable TASX already.*\n\Z")

    def test_a_limit_of_the_file_size_is_an_error(self):
        for command in (("simulate", SCENARIO), ("process", FLIGHT, "-m", LAW)):
            for most in (0, 4096, 100000):
                with self.subTest(command=command[0], most=most):
                    result = self.run_tool(*command, "-o", self.path / "out.nc", "--quiet",
                                           preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)))
                    self.assert_refused(result, "out.nc")
                    self.assertEqual(list(self.path.iterdir()), [])


class Signals(HostileTest):
    def begin(self):
        """A run that is writing."""
        run = subprocess.Popen([TOOL, "simulate", SOURCE / "data/scenarios/c130-hidden.toml", "-o", self.path / "out.nc"],
                               stdout=subprocess.DEVNULL)
        while not (parts := [path for path in self.path.iterdir() if path.name.endswith(".part")]):
            self.assertIsNone(run.poll())
            time.sleep(0.001)
        return run, parts[0]

    def test_no_temporary_file_remains(self):
        for stop in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGPIPE, signal.SIGALRM,
                     signal.SIGXCPU, signal.SIGUSR1):
            with self.subTest(signal=stop.name):
                run, _ = self.begin()
                run.send_signal(stop)
                self.assertEqual(run.wait(), -stop)
                self.assertEqual(list(self.path.iterdir()), [])

    def test_signal_ignored_by_the_caller_is_ignored(self):
        result = subprocess.run(["sh", "-c", 'trap "" HUP; "$0" effects > /dev/null & kill -HUP $!; wait $!', TOOL])
        self.assertEqual(result.returncode, 0)

    def test_the_next_run_removes_files_of_a_killed_run(self):
        run, part = self.begin()
        run.kill()
        run.wait()
        self.assertTrue(part.exists())
        living = part.with_name(part.name.replace(f"-{run.pid}.", f"-{os.getpid()}."))
        elsewhere = part.with_name(re.sub(r"\.nc\..*?-", ".nc.another-host-", part.name))
        others = {living, elsewhere, self.path / ".mine.part"}
        for other in others:
            other.touch()
        result = self.run_tool("add", "static-lag", "-m", LAW, "--flight", FLIGHT, "-o", self.path / "model.toml")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(set(self.path.iterdir()), others | {self.path / "model.toml"})


class Streams(HostileTest):
    def test_closed_streams_are_tolerated(self):
        for close in ("2>&-", ">&- 2>&-", "<&- >&- 2>&-"):
            with self.subTest(close):
                refused = subprocess.run(["sh", "-c", f'"$0" process none.nc -m none.toml -o out.nc {close}', TOOL])
                self.assertEqual(refused.returncode, 1)
        output = self.path / "model.toml"
        done = subprocess.run(["sh", "-c", '"$0" add static-lag -m "$1" --flight "$2" -o "$3" --quiet <&- 2>&-', TOOL,
                               LAW, FLIGHT, output])
        self.assertEqual(done.returncode, 0)
        tomllib.loads(output.read_text())  # no message went into the file

    def test_the_error_names_the_kind_of_file(self):
        locked = self.path / "a\x1b[31m\nb"
        result = self.run_tool("process", FLIGHT, "-m", locked, "-o", self.path / "out.nc")
        self.assert_refused(result, r"a\x1b[31m\x0ab")


class Texts(HostileTest):
    def model(self, text):
        path = self.path / "model.toml"
        path.write_text(text)
        return self.run_tool("process", FLIGHT, "-m", path, "-o", self.path / "out.nc")

    def intervals(self, text):
        path = self.path / "intervals.toml"
        path.write_text(INTERVALS + text)
        return self.run_tool("compare", FLIGHT, "-m", LAW, "--intervals", path)

    def test_deep_nesting_is_refused(self):
        key = ".".join(["a"] * 1000000)
        for text in (f"{key} = 1", f"[{key}]", f"[[{key}]]", f"x = {{ {key} = 1 }}"):
            self.assert_refused(self.model(f"{MODEL}\n{text}\n"), "a key has more than 16 dots")
        for text in ("x = " + "[" * 1000000, "x = " + "{a = " * 1000000):
            self.assert_refused(self.model(f"{MODEL}\n{text}\n"), "256")
        self.assert_refused(self.intervals(f"{key} = 1"), "a key has more than 16 dots")

    def test_too_many_entries_are_refused(self):
        effect = '[[effect]]\nid = "my-{0}"\nwhere = "static"\nunit = "hPa"\nformula = "k * attack"\nparameters = {{ {1} }}\n'
        numbered = ", ".join(f"k{i} = 0.0" for i in range(20000))
        self.assert_refused(self.model(MODEL + effect.format(0, numbered)), "entries; give at most")
        self.assert_refused(self.model(MODEL + "".join(effect.format(i, "k = 0.0") for i in range(20000))),
                            "entries; give at most")
        span = 'begin = "20:10:00"\nend = "20:20:00"\n'
        for table in ('[[add]]\nregime = "level"\n', '[[exclude]]\nreason = "x"\n', "[[veto]]\n"):
            self.assert_refused(self.intervals((table + span) * 20000), "entries; give at most")
        scenario = self.path / "scenario.toml"
        scenario.write_text(SCENARIO.read_text() + '[[leg]]\nkind = "level"\nduration = 1\n' * 20000)
        self.assert_refused(self.run_tool("simulate", scenario, "-o", self.path / "out.nc"), "entries; give at most")

    def test_devices_and_pipes_are_refused(self):
        os.mkfifo(self.path / "pipe")
        for path in ("/dev/zero", self.path / "pipe"):
            self.assert_refused(self.run_tool("process", FLIGHT, "-m", path, "-o", self.path / "out.nc"),
                                "not a regular file")

    def test_long_names_are_refused(self):
        for name in ("x" * 1000000, "\u00e9" * 100000, r"\u001b[31m\u009b\n" * 1000, "a'" * 100000):
            self.assert_refused(self.intervals(f'[[add]]\nregime = "{name}"\n'
                                               'begin = "20:10:00"\nend = "20:20:00"\n'), "there is no regime")
            self.assert_refused(self.model(MODEL.replace('"PSFD"', f'"{name}"', 1)))
            self.assert_refused(self.model(MODEL.replace('id = "', f'id = "{name}', 1)))
            self.assert_refused(self.model(f'{MODEL}\n[units]\nPSFD = "{name}"\n'))
            self.assert_refused(self.model(f'{MODEL}\n["{name}"]\n'))
            self.assert_refused(self.intervals(f'[[exclude]]\nbegin = "{name}"\nend = "20:10:00"\nreason = "x"\n'),
                                "is not a time")


if __name__ == "__main__":
    subprocess.run([TOOL, "simulate", SCENARIO, "-o", FLIGHT, "--quiet"], check=True)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
