#!/usr/bin/env python3
"""Many flights in one command, repetition of stale outputs only, and models by name.

    many_flights_test.py TOOL SOURCE_DIRECTORY

Flights are made from the text of the example flight.
"""

import hashlib
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import netCDF4

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
sys.path.append(str(Path(sys.argv[2]).resolve() / "tests/hostile"))
from damaged_flights import cut_flight, damaged_heaps  # noqa: E402
from long_tests import in_long_tests  # noqa: E402

TOOL = Path(sys.argv[1]).resolve()
SOURCE = Path(sys.argv[2]).resolve()
NAME = "c130-psfd-qcr-2003"
MODEL = SOURCE / "data/models" / (NAME + ".toml")
CDL = subprocess.run([SOURCE / "tools/make_example_flight"], check=True, capture_output=True, text=True).stdout


class ManyFlightsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)
        self.out = self.path / "corrected"

    def flight(self, name):
        path = self.path / name
        path.parent.mkdir(exist_ok=True)
        subprocess.run(["ncgen", "-k", "classic", "-o", path, "-"], input=CDL, check=True, text=True)
        return path

    def flights(self, *names):
        return [self.flight(name) for name in names]

    def bad_flight(self, name="bad.nc"):
        path = self.path / name
        path.write_text("no flight")
        return path

    def run_tool(self, *arguments, **options):
        return subprocess.run([TOOL, *arguments], capture_output=True, text=True, **options)

    def process(self, flights, *more, model=MODEL, output=None):
        return self.run_tool("process", *flights, "-m", model, "-o", output or self.out, *more)

    def states(self, flights, *more, **options):
        """Result of each flight, by its name."""
        result = self.process(flights, "--json", "-", *more, **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return {Path(flight["input"]).name: flight["state"] for flight in json.loads(result.stdout)["flights"]}

    def made(self):
        return sorted(path.name for path in self.out.iterdir())


class Folder(ManyFlightsTest):
    def test_outputs_keep_the_names_of_flights(self):
        flights = self.flights("a.nc", "b.nc", "c.nc")
        result = self.process(flights)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(self.made(), ["a.nc", "b.nc", "c.nc"])
        for name in ("a.nc", "b.nc", "c.nc", "600"):
            self.assertIn(name, result.stdout)

    def test_outputs_equal_those_of_single_runs(self):
        flights = self.flights("a.nc", "b.nc")
        self.process(flights)
        self.process(flights[1:], output=self.path / "alone.nc")
        with netCDF4.Dataset(self.out / "b.nc") as one, netCDF4.Dataset(self.path / "alone.nc") as alone:
            self.assertTrue((one["PSXC"][:] == alone["PSXC"][:]).all())
            self.assertEqual(set(one.variables), set(alone.variables))
            self.assertIn(f"-o {self.out / 'b.nc'}", one.history)

    def test_one_flight_may_be_written_into_an_existing_folder(self):
        self.out.mkdir()
        self.assertEqual(self.process(self.flights("a.nc")).returncode, 0)
        self.assertEqual(self.made(), ["a.nc"])

    def test_json_has_the_keys_of_one_flight_for_each(self):
        flights = self.flights("a.nc", "b.nc")
        one = json.loads(self.process(flights[:1], "--json", "-", output=self.path / "one.nc").stdout)
        many = json.loads(self.process(flights, "--json", "-").stdout)
        self.assertEqual(many["processed"], 2)
        self.assertEqual([flight["input"] for flight in many["flights"]], [str(path) for path in flights])
        for flight in many["flights"]:
            self.assertEqual(set(flight), set(one))
            self.assertEqual(flight["records"], 600)

    def test_duplicate_output_names_are_an_error_before_the_run(self):
        result = self.process(self.flights("one/a.nc", "b.nc", "two/a.nc"))
        self.assertEqual(result.returncode, 1)
        self.assertIn("one/a.nc", result.stderr)
        self.assertIn("two/a.nc", result.stderr)
        self.assertFalse(self.out.exists())

    def test_several_flights_need_a_folder(self):
        flights = self.flights("a.nc", "b.nc")
        (self.path / "file").write_text("a file")
        for output in (self.path / "file", self.path / "out.nc"):
            result = self.process(flights, output=output)
            self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 1))
            self.assertIn("directory", result.stderr)
        self.assertFalse((self.path / "out.nc").exists())

    def test_an_empty_output_folder_is_removed(self):
        result = self.process([self.bad_flight("a.nc"), self.bad_flight("b.nc")])
        self.assertEqual(result.returncode, 1)
        self.assertFalse(self.out.exists())
        self.out.mkdir()
        self.process([self.path / "a.nc", self.path / "b.nc"])
        self.assertTrue(self.out.exists(), "it was there before")

    def test_output_folder_with_the_input_flights_is_refused(self):
        flights = self.flights("a.nc", "b.nc")
        before = [path.read_bytes() for path in flights]
        result = self.process(flights, output=self.path)
        self.assertEqual(result.returncode, 1)
        self.assertIn("a.nc", result.stderr)
        self.assertEqual([path.read_bytes() for path in flights], before)

    @unittest.skipIf(os.environ.get("PCOR_SANITIZED"), "a sanitizer keeps the memory that was given back")
    def test_memory_does_not_grow_with_the_flights(self):
        flight = self.flight("a.nc")
        flights = [flight]
        for number in range(60):
            flights.append(shutil.copy(flight, self.path / f"{number}.nc"))

        def memory(count):
            code = "import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True); " \
                   "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
            command = [TOOL, "process", *flights[:count], "-m", MODEL, "-o", f"{self.out}/", "--quiet"]
            return int(subprocess.run([sys.executable, "-c", code, *command], check=True, capture_output=True,
                                      text=True).stdout)

        # The heap of equal runs differs by up to 4 MiB; 200 KiB kept of each flight would be 11 MiB.
        self.assertLess(memory(61), memory(3) + 8192)  # KiB


class Unreadable(ManyFlightsTest):
    def test_the_first_bad_file_stops_the_run_and_outputs_remain(self):
        a, b = self.flights("a.nc", "b.nc")
        result = self.process([a, self.bad_flight(), b])
        self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 1))
        self.assertIn("bad.nc", result.stderr)
        self.assertIn("--skip-unreadable", result.stderr)
        self.assertEqual(self.made(), ["a.nc"])

    def test_bad_file_has_a_row_with_its_reason(self):
        a, b = self.flights("a.nc", "b.nc")
        bad = self.bad_flight()
        result = self.process([a, bad, b], "--skip-unreadable")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertRegex(result.stdout, r"(?m)^bad\.nc .*not a netCDF file")
        self.assertEqual(self.made(), ["a.nc", "b.nc"])
        summary = json.loads(self.process([a, bad, b], "--skip-unreadable", "--json", "-").stdout)
        self.assertEqual((summary["processed"], summary["unreadable"]), (2, 1))
        self.assertIn("netCDF", summary["flights"][1]["reason"])

    def test_flight_without_a_model_variable_is_unreadable(self):
        a, b = self.flights("a.nc", "b.nc")
        subprocess.run(["ncrename", "-v", "QCR,QCX", b], check=True, capture_output=True)
        self.assertEqual(self.states([b, a], "--skip-unreadable"), {"b.nc": "unreadable", "a.nc": "processed"})

    @unittest.skipIf(os.environ.get("PCOR_SANITIZED"), "a sanitizer reports invalid reads in HDF5")
    @in_long_tests
    def test_a_file_that_crashes_hdf5_is_named(self):
        model = SOURCE / "data/scenarios/models/c130-psfd-eq18.toml"
        a, b, whole = (self.path / name for name in ("a.nc", "b.nc", "whole.nc"))
        for seed, flight in (("1", a), ("2", b)):
            self.run_tool("simulate", SOURCE / "data/scenarios/c130-short.toml", "--seed", seed, "-o", flight)
        cut_flight(a, whole, "NETCDF4")
        crashes = 0
        for number, content in enumerate(damaged_heaps(whole.read_bytes())):
            bad = self.path / f"bad{number}.nc"
            bad.write_bytes(content)
            alone = self.process([bad], model=model)
            self.assertEqual(alone.returncode, 1)
            crashes += "the HDF5 library could not read it" in alone.stderr
            # Memory corruption may show at the next flight only, so the report may name another flight.
            together = self.run_tool("compare", a, bad, b, "-m", model, "--quiet")
            self.assertEqual(together.returncode, 1)
            self.assertRegex(together.stderr, f"{bad.name}|read before it")
        if not crashes:
            self.skipTest("this HDF5 library does not crash on such files")

    def test_a_run_without_output_has_status_1(self):
        result = self.process([self.bad_flight(), self.bad_flight("worse.nc")], "--skip-unreadable")
        self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 1))
        self.assertIn("worse.nc", result.stdout)

    def test_unwritable_output_is_not_skipped(self):
        flights = self.flights("a.nc", "b.nc")
        (self.out / "a.nc").mkdir(parents=True)
        result = self.process(flights, "--skip-unreadable")
        self.assertEqual(result.returncode, 1)
        self.assertIn("is a directory", result.stderr)


class Stale(ManyFlightsTest):
    def test_only_stale_outputs_are_made_again(self):
        flights = self.flights("a.nc", "b.nc", "c.nc")
        everything = {"a.nc": "processed", "b.nc": "processed", "c.nc": "processed"}
        nothing = dict.fromkeys(everything, "up to date")
        self.assertEqual(self.states(flights, "--if-stale"), everything)
        self.assertEqual(self.states(flights, "--if-stale"), nothing)
        (self.out / "b.nc").unlink()
        self.assertEqual(self.states(flights, "--if-stale"), {**nothing, "b.nc": "processed"})
        self.assertEqual(self.states(flights), everything)

    def test_changed_content_makes_an_output_stale(self):
        flights = self.flights("a.nc", "b.nc")
        self.process(flights)
        before = flights[0].stat()
        with netCDF4.Dataset(flights[0], "a") as flight:
            flight["PSFD"][17] += 0.5
        os.utime(flights[0], ns=(before.st_atime_ns, before.st_mtime_ns))
        os.utime(flights[1])
        self.assertEqual(flights[0].stat().st_size, before.st_size)
        self.assertEqual(self.states(flights, "--if-stale"), {"a.nc": "processed", "b.nc": "up to date"})

    def test_changed_model_or_option_makes_all_outputs_stale(self):
        flights = self.flights("a.nc", "b.nc")
        model = self.path / "model.toml"
        model.write_text(MODEL.read_text())
        self.process(flights, model=model)
        self.assertEqual(set(self.states(flights, "--if-stale", model=model).values()), {"up to date"})
        model.write_text(MODEL.read_text().replace("[[effect]]", "[uncertainty]\nstatic_defect = 0.1\n\n[[effect]]", 1))
        self.assertEqual(set(self.states(flights, "--if-stale", model=model).values()), {"processed"})
        self.assertEqual(set(self.states(flights, "--if-stale", "--suffix", "_X", model=model).values()), {"processed"})
        self.assertEqual(set(self.states(flights, "--if-stale", "--suffix", "_X", model=model).values()), {"up to date"})
        self.assertEqual(set(self.states(flights, "--if-stale", model=model).values()), {"processed"})

    def test_a_file_of_another_program_is_stale(self):
        flights = self.flights("a.nc", "b.nc")
        self.out.mkdir()
        (self.out / "a.nc").write_text("something else")
        self.assertEqual(set(self.states(flights, "--if-stale").values()), {"processed"})

    def test_single_output_file_can_be_up_to_date(self):
        (flight,) = self.flights("a.nc")
        output = self.path / "out.nc"
        self.process([flight], "--if-stale", output=output)
        before = output.read_bytes()
        result = self.process([flight], "--if-stale", output=output)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("up to date", result.stdout)
        self.assertEqual(output.read_bytes(), before)

    def test_a_killed_run_continues(self):
        flight = self.flight("0.nc")
        flights = [flight] + [shutil.copy(flight, self.path / f"{number}.nc") for number in range(1, 40)]
        for how in (signal.SIGTERM, signal.SIGKILL):
            with self.subTest(signal=how):
                shutil.rmtree(self.out, ignore_errors=True)
                run = subprocess.Popen([TOOL, "process", *flights, "-m", MODEL, "-o", self.out, "--if-stale", "--quiet"])
                while run.poll() is None and len(list(self.out.glob("*.nc")) if self.out.exists() else []) < 3:
                    time.sleep(0.001)
                run.send_signal(how)
                self.assertEqual(run.wait(), -how, "the run ended before it could be stopped")
                done = {path.name for path in self.out.glob("[0-9]*.nc")}
                self.assertLess(len(done), len(flights))
                states = self.states(flights, "--if-stale")
                self.assertEqual({name for name, state in states.items() if state == "up to date"}, done)
                self.assertEqual(len(states), len(flights))

    def test_hash_equals_sha256_of_the_file(self):
        (flight,) = self.flights("a.nc")
        self.process([flight], output=self.path / "out.nc")
        with netCDF4.Dataset(self.path / "out.nc") as output:
            self.assertEqual(output.pcor_input_sha256, hashlib.sha256(flight.read_bytes()).hexdigest())
            self.assertEqual(output.pcor_model_sha256, hashlib.sha256(output.pcor_model_toml.encode()).hexdigest())


class OpenFiles(ManyFlightsTest):
    def test_flights_are_not_held_open_together(self):
        """The number of open files is limited, and an open flight needs several MB in the HDF5 library."""
        flight = self.path / "0.nc"
        self.run_tool("simulate", SOURCE / "data/scenarios/c130-short.toml", "-o", flight)
        flights = [flight] + [Path(shutil.copy(flight, self.path / f"{number}.nc")) for number in range(1, 26)]

        def few_files():
            resource.setrlimit(resource.RLIMIT_NOFILE, (24, 24))

        for command in (["refit", "-o", self.path / "fitted.toml", "--force"], ["inspect"]):
            model = [] if command == ["inspect"] else ["-m", SOURCE / "data/scenarios/models/c130-psfd-eq18.toml"]
            result = self.run_tool(*command, *flights, *model, preexec_fn=few_files)
            self.assertEqual(result.returncode, 0, result.stderr)

    def test_skip_unreadable_excludes_unreadable_flights(self):
        flight = self.path / "0.nc"
        self.run_tool("simulate", SOURCE / "data/scenarios/c130-short.toml", "-o", flight)
        bad = self.bad_flight()
        model = ["-m", SOURCE / "data/scenarios/models/c130-psfd-eq18.toml"]
        for command in (["compare"], ["refit", "-o", self.path / "fitted.toml", "--force"], ["check"]):
            with self.subTest(command=command[0]):
                refused = self.run_tool(*command, flight, bad, *model)
                self.assertEqual(refused.returncode, 1)
                result = self.run_tool(*command, flight, bad, *model, "--skip-unreadable", "--json", "-")
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertRegex(result.stderr, "skipped: .*bad.nc")
                self.assertRegex(json.loads(result.stdout)["choices"][0], "skipped: .*bad.nc")
                self.assertEqual(self.run_tool(*command, bad, *model, "--skip-unreadable").returncode, 1)


class ModelNames(ManyFlightsTest):
    def test_a_shipped_model_is_found_by_its_name(self):
        (flight,) = self.flights("a.nc")
        by_name = self.process([flight], "--json", "-", model=NAME, output=self.path / "one.nc")
        self.assertEqual(by_name.returncode, 0, by_name.stderr)
        self.assertEqual(Path(json.loads(by_name.stdout)["model"]).resolve(), MODEL)

    def test_every_command_accepts_model_names(self):
        flight = self.path / "flight.nc"
        self.run_tool("simulate", SOURCE / "data/scenarios/c130-short.toml", "-o", flight)
        second = ["--reference", "static:c130-psfrd-eq18"]
        for command in (["compare", flight, *second], ["diagnose", flight, *second],
                        ["refit", flight, *second, "-o", self.path / "fitted.toml", "--force"],
                        ["check", flight, "--second", "c130-psfrd-eq18"],
                        ["add", "static-lag", "-o", self.path / "more.toml"]):
            with self.subTest(command=command[0]):
                result = self.run_tool(*command, "-m", "c130-psfd-eq18")
                self.assertEqual(result.returncode, 0, result.stderr)
                advised = result.stdout.rstrip().splitlines()[-1]
                self.assertNotIn("c130-psfd-eq18.toml", advised, "the name as given")
                self.assertNotIn("c130-psfrd-eq18.toml", advised)

    def test_the_folder_of_the_user_precedes_the_package(self):
        own = self.path / "own"
        own.mkdir()
        (own / "my-law.toml").write_text(MODEL.read_text().replace('name = "', 'name = "my own '))
        (flight,) = self.flights("a.nc")
        environment = {**os.environ, "PCOR_MODELS": f"{self.path / 'none'}:{own}"}
        result = self.run_tool("process", flight, "-m", "my-law", "-o", self.path / "one.nc", env=environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        with netCDF4.Dataset(self.path / "one.nc") as output:
            self.assertTrue(output.pcor_model.startswith("my own"))

    def test_a_file_precedes_a_name(self):
        (flight,) = self.flights("a.nc")
        (self.path / NAME).write_text(MODEL.read_text().replace('name = "', 'name = "here '))
        self.run_tool("process", flight, "-m", NAME, "-o", self.path / "one.nc", cwd=self.path)
        with netCDF4.Dataset(self.path / "one.nc") as output:
            self.assertTrue(output.pcor_model.startswith("here"))

    def test_an_unknown_name_gets_suggestions(self):
        (flight,) = self.flights("a.nc")
        own = self.path / "own"
        own.mkdir()
        shutil.copy(SOURCE / "data/models/c130-psfd-eq18.toml", own)
        result = self.run_tool("process", flight, "-m", "c130-psfd-eq81", "-o", self.path / "one.nc",
                               env={**os.environ, "PCOR_MODELS": str(own)})
        self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 1))
        self.assertRegex(result.stderr, "did you mean .*c130-psfd-eq18")
        self.assertEqual(result.stderr.count("c130-psfd-eq18"), 1, "a name is reported once")


class ModelsByDate(ManyFlightsTest):
    """A folder of models, of which each flight gets the one of its aircraft and date."""

    def setUp(self):
        super().setUp()
        self.models = self.path / "models"
        self.models.mkdir()
        for name, window in (("early", 'valid_to = "2003-12-31"'), ("late", 'valid_from = "2004-01-01"')):
            self.model(name, window)
        self.early = self.flight("early.nc")
        self.late = self.flight("late.nc", begin="1086091200")  # 2004-06-01 12:00

    def model(self, name, law):
        text = re.sub(r'valid_(from|to) = .*\n', '', MODEL.read_text())
        text = text.replace("[law]\n", f"[law]\n{law}\n").replace('name = "', f'name = "{name} ', 1)
        (self.models / f"{name}.toml").write_text(text)

    def flight(self, name, begin="1054468800"):  # 2003-06-01 12:00
        path = self.path / name
        subprocess.run(["ncgen", "-k", "classic", "-o", path, "-"], input=CDL.replace("1054468800", begin), check=True,
                       text=True)
        return path

    def process(self, *more, flights=None):
        return self.run_tool("process", *(flights or (self.early, self.late)), "--models", self.models, "-o", self.out,
                             *more)

    def model_of(self, name):
        with netCDF4.Dataset(self.out / name) as output:
            return output.pcor_model.split()[0]

    def test_each_flight_gets_the_model_of_its_date(self):
        result = self.process()
        self.assertEqual(result.returncode, 0)
        self.assertEqual(result.stderr.splitlines(),
                         [f"{name}.nc: corrected by {name} C-130 PSFD/QCR, trailing cone 2003 "
                          f"({self.models / name}.toml)" for name in ("early", "late")])
        self.assertEqual((self.model_of("early.nc"), self.model_of("late.nc")), ("early", "late"))
        self.assertRegex(result.stdout, "early.nc .* early C-130")
        again = json.loads(self.process("--if-stale", "--json", "-").stdout)
        self.assertEqual(again["up_to_date"], 2)
        self.model("late", 'valid_from = "2004-01-02"')
        again = json.loads(self.process("--if-stale", "--json", "-").stdout)
        self.assertEqual([flight["state"] for flight in again["flights"]], ["up to date", "processed"])

    def test_ambiguous_models_are_refused(self):
        self.model("other", 'valid_to = "2003-12-31"')
        result = self.process()
        self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 1))
        self.assertRegex(result.stderr, "early, other match equally well")
        broken = self.models / "broken.toml"
        broken.write_text("no model")
        self.assertRegex(self.process().stderr, "broken.toml:1")
        broken.unlink()
        self.model("other", 'valid_to = "2003-12-31"\nin_processing = true')
        self.assertEqual(self.process().returncode, 0)
        self.assertEqual(self.model_of("early.nc"), "other")

    def test_flight_without_a_model_has_a_row_with_its_reason(self):
        (self.models / "late.toml").unlink()
        result = self.process("--json", "-", "--skip-unreadable")
        self.assertEqual(result.returncode, 0, result.stderr)
        done, left = json.loads(result.stdout)["flights"]
        self.assertEqual((done["state"], left["state"]), ("processed", "unreadable"))
        self.assertRegex(left["reason"], "early is valid for other dates")

    def test_a_law_for_other_flights_is_refused(self):
        self.model("late", 'valid_from = "2004-01-01"\nin_processing = true')
        late = (self.models / "late.toml").read_text()
        self.model("plain", 'valid_from = "2004-01-01"')
        (self.models / "late.toml").write_text(late + '[[effect]]\nid = "mine"\nformula = "k * NOT_THERE"\n'
                                               'parameters = { k = 1.0 }\nunit = "hPa"\nwhere = "static"\n')
        result = self.process()
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.model_of("late.nc"), "plain")
        self.assertRegex(result.stderr, "late.nc: .* does not apply to this flight: late.*NOT_THERE")

    def test_model_files_are_not_overwritten(self):
        model = self.models / "late.toml"
        before = model.read_bytes()
        self.assertEqual(self.process("--json", model).returncode, 1)
        self.assertEqual(model.read_bytes(), before)

    def test_model_and_models_exclude_each_other(self):
        self.assertEqual(self.process("-m", MODEL).returncode, 2)
        self.assertEqual(self.run_tool("process", self.early, "-o", self.path / "out.nc").returncode, 2)
        (self.path / "empty").mkdir()
        result = self.run_tool("process", self.early, "--models", self.path / "empty", "-o", self.path / "out.nc")
        self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 1))

    def test_the_report_shows_all_flights(self):
        report = self.path / "report.html"
        (self.path / "bad.nc").write_text("no flight")
        result = self.process("--skip-unreadable", "--report", report,
                              flights=(self.early, self.path / "bad.nc", self.late))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn(f"wrote {report}", result.stdout)
        page = report.read_text()
        rows = re.findall(r"<tr><td[^>]*>(\w+\.nc)</td><td[^>]*>(.*?)</td><td[^>]*>([\w ]+)", page)
        self.assertEqual([(name, state) for name, _, state in rows],
                         [("early.nc", "processed"), ("bad.nc", "not corrected"), ("late.nc", "processed")])
        self.assertTrue(rows[0][1].startswith("early C-130"))
        self.assertTrue("Delta-p in time" in page)
        self.assertTrue("late.nc: corrected by late C-130" in page)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
