#!/usr/bin/env python3
"""Contradictory flights and models, and names with special characters of a shell.

    contradiction_test.py TOOL SOURCE_DIRECTORY
"""

import ctypes
import ctypes.util
import json
import os
import re
import resource
import shlex
import shutil
import subprocess
import sys
import unittest

import netCDF4
import numpy

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
import comparison_test  # noqa: E402
from comparison_test import ONE, PUBLISHED, SCENARIO, ComparisonTest  # noqa: E402
from long_tests import in_long_tests  # noqa: E402
from tool_test import TOOL  # noqa: E402

setUpModule, tearDownModule = comparison_test.setUpModule, comparison_test.tearDownModule

HOSTILE = ("x;touch pwned|touch pwned&$(touch pwned)`touch pwned`.nc", "-rf.nc", "--help.nc",
           "it's a \"flight\" *?.nc", "~.nc", "#.nc")
FAKE = '#!/bin/sh\nfor word; do printf "%s\\n" "$word"; done > "$FAKE_LOG"\n'


class ChangedTest(ComparisonTest):
    def changed(self, change, name="changed.nc"):
        """A copy of a flight after `change`."""
        path = self.path / name
        shutil.copy(ONE, path)
        with netCDF4.Dataset(path, "r+") as flight:
            flight.set_auto_maskandscale(False)
            change(flight)
        return path

    def with_units(self, units):
        def change(flight):
            flight["Time"].units = units
        return self.changed(change)


class Pasting(ChangedTest):
    """Every advised command has exactly the stated effect when it is pasted into a shell."""

    def setUp(self):
        super().setUp()
        programs = self.path / "programs"
        programs.mkdir()
        for name in ("gunzip", "ncatted", "ncks", "ncdump"):
            (programs / name).write_text(FAKE)
            (programs / name).chmod(0o755)
        (programs / "pcor").symlink_to(TOOL)
        self.log = self.path / "log"
        self.environment = os.environ | {"PATH": f"{programs}:{os.environ['PATH']}", "FAKE_LOG": str(self.log)}
        self.work = self.path / "work"
        self.work.mkdir()

    def here(self, *arguments):
        return subprocess.run(["pcor", *map(str, arguments)], cwd=self.work, env=self.environment,
                              capture_output=True, text=True)

    def paste(self, command):
        result = subprocess.run(command, shell=True, cwd=self.work, env=self.environment, capture_output=True,
                                text=True)
        self.assertFalse((self.work / "pwned").exists() or (self.work / "pwned.nc").exists(), command)
        return result

    def paste_all(self, text):
        """The commands of this program in a text."""
        commands = re.findall(r"(?<=: )pcor [a-z]+ .*$", text, flags=re.MULTILINE)
        for command in commands:
            result = self.paste(command.replace("corrected.nc", "corrected-anew.nc"))
            self.assertIn(result.returncode, (0, 1), f"{command}\n{result.stderr}")
        return len(commands)

    def test_printed_commands_quote_file_names(self):
        commands = 0
        for number, name in enumerate(HOSTILE):
            shutil.copy(ONE, self.work / name)
            model = f"-{number}; touch pwned.toml"
            (self.work / model).write_text(comparison_test.MODEL)
            for arguments in (("inspect", "--", name),
                              ("compare", f"--model={model}", "--", name),
                              ("refit", f"--model={model}", f"--output=-fitted {number}.toml", "--", name),
                              ("process", f"--model={model}", f"--output=-out {number}.nc", "--", name)):
                with self.subTest(name=name, command=arguments[0]):
                    result = self.here(*arguments)
                    self.assertEqual(result.returncode, 0, result.stderr)
                    commands += self.paste_all(result.stdout)
        self.assertGreaterEqual(commands, 2 * len(HOSTILE))

    def test_commands_of_studies_quote_file_names(self):
        name, model = "-$(touch pwned) 'x'; touch pwned.nc", "-`touch pwned`; touch pwned.toml"
        shutil.copy(ONE, self.work / name)
        biased = comparison_test.with_a0(0.03)(comparison_test.MODEL)
        (self.work / model).write_text(biased)
        scenario = "-;touch pwned.toml"
        (self.work / scenario).write_text(comparison_test.SCENARIO)
        commands = {}
        for arguments in (("check", f"--model={model}", "--", name),
                          ("diagnose", f"--model={model}", "--try=k * ENGTRQ / 100", "--", name),
                          ("improve", f"--model={model}", "--output=-best;touch pwned.toml", "--force", "--", name),
                          ("add", f"--model={model}", "--output=-more;touch pwned.toml", f"--flight={name}", "static-lag"),
                          ("simulate", "--output=-made;touch pwned.nc", "--", scenario)):
            with self.subTest(arguments[0]):
                result = self.here(*arguments)
                self.assertEqual(result.returncode, 0, result.stderr)
                text = result.stdout.replace("MODEL.toml", f"'./{model}'").replace("FLIGHT.nc", "'./-made;touch pwned.nc'")
                commands[arguments[0]] = self.paste_all(text)
        self.assertEqual([command for command, count in commands.items() if count == 0], [])

    def test_commands_quote_result_names(self):
        shutil.copy(ONE, self.work / "one.nc")
        result = self.here("process", "one.nc", "-m", PUBLISHED, "-o", "out.nc", "--suffix", "_X;touch pwned")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.paste(re.search(r": (ncdump .*) \| less$", result.stdout, flags=re.M).group(1))
        self.assertEqual(self.log.read_text().splitlines(), ["-v", "PCOR_X;touch pwned", "out.nc"])

    def test_commands_in_errors_quote_file_names(self):
        name = "x;touch pwned.nc"
        def change(flight):
            flight.renameVariable("PSFD", "ABSENT")
            for variable in flight.variables.values():
                if getattr(variable, "units", "") in ("hPa", "mbar"):
                    variable.units = "m"
        self.changed(change).rename(self.work / name)
        result = self.here("process", name, "-m", PUBLISHED, "-o", "out.nc")
        self.assertEqual(result.returncode, 1)
        self.paste(re.search(r"ncdump -h .*?(?=; )|$", result.stderr).group())

    def test_commands_in_json_quote_file_names(self):
        for name in HOSTILE[:4]:
            shutil.copy(ONE, self.work / name)
            result = self.here("inspect", "--json", "-", "--", name)
            commands = json.loads(result.stdout)["flights"][0]["next"]
            self.assertEqual(len(commands), 3)
            for command in commands:
                pasted = self.paste(command)
                self.assertEqual(pasted.returncode, 0, f"{command}\n{pasted.stderr}")

    def test_advised_outputs_are_no_inputs(self):
        biased = comparison_test.with_a0(0.03)(comparison_test.MODEL)
        shutil.copy(ONE, self.work / "corrected.nc")
        for model, text, arguments, advised in (
                ("fitted.toml", biased, ("compare",), "refit"),
                ("fitted.toml", comparison_test.MODEL, ("compare",), "process"),
                ("best.toml", biased, ("diagnose",), "improve"),
                ("improved.toml", comparison_test.MODEL, ("check",), "improve"),
                ("calibrated.toml", biased, ("check",), "temperature"),
                ("fitted.toml", comparison_test.MODEL, ("add", "static-mach", "-o", "more.toml", "--flight"), "refit")):
            with self.subTest(model=model, arguments=arguments):
                (self.work / model).write_text(text)
                result = self.here(*arguments, "corrected.nc", "-m", model)
                command = re.search(r": (pcor .*)$", result.stdout.rstrip().splitlines()[-1]).group(1)
                self.assertEqual(shlex.split(command)[1], advised)
                pasted = self.paste(command)
                self.assertEqual(pasted.returncode, 0, f"{command}\n{pasted.stderr}")
                self.assertEqual((self.work / model).read_text(), text)

    def test_a_total_pressure_fits_no_static_defect(self):
        def change(flight):
            flight["QCFR"][:] = numpy.where(flight["QCFR"][:] > 0.0, flight["QCFR"][:] + 1.0, flight["QCFR"][:])
        flight = self.changed(change)
        (self.work / "model.toml").write_text(PUBLISHED.read_text())
        (self.work / "zero.toml").write_text(PUBLISHED.read_text() + '\n[[effect]]\nid = "qcf-zero"\n')
        for model, is_fitted in (("model.toml", False), ("zero.toml", True)):
            result = self.here("compare", flight, "-m", model, "--reference", "total:PSFRD+QCFR")
            self.assertEqual((result.returncode, "pcor refit" in result.stdout), (0, is_fitted), result.stderr)

    def test_commands_for_other_programs_quote_file_names(self):
        for name in HOSTILE:
            with self.subTest(name):
                def text_scale(flight):
                    flight["PSFD"].scale_factor = "text"

                def no_year(flight):
                    flight["Time"].units = "seconds since 1850-01-01"

                def no_range(flight):
                    flight["PSFD"].valid_range = numpy.array([5.0], "f4")

                for change in (text_scale, no_year, no_range):
                    shutil.copy(self.changed(change), self.work / name)
                    result = self.here("process", "-m", PUBLISHED, "-o", "out.nc", "--", name)
                    self.assertEqual(result.returncode, 1)
                    advised = re.search(r"ncatted -a .*?(?=, or |$)", result.stderr.strip()).group()
                    self.paste(advised)
                    words = self.log.read_text().splitlines()
                    self.assertEqual(words[-1], f"./{name}" if name.startswith("-") else name)
                    self.assertEqual(len(words), 3, words)

    def test_the_command_that_unpacks_quotes_file_names(self):
        for name in HOSTILE:
            with self.subTest(name):
                name += ".gz"
                (self.work / name).write_bytes(b"\x1f\x8b")
                result = self.here("inspect", "--", name)
                self.assertEqual(result.returncode, 1)
                self.paste(re.search(r"gunzip -k .*(?=, and name)", result.stderr).group())
                self.assertEqual(self.log.read_text().splitlines(), ["-k", f"./{name}" if name.startswith("-") else name])


class Frozen(ChangedTest):
    """GOTEX rf06 with one variable constant for a minute."""

    HELD = {"PSFD": slice(1500, 1560), "ATTACK": slice(2000, 2060)}

    def setUp(self):
        super().setUp()
        folder = os.environ.get("PCOR_FLIGHTS", "")
        self.original = os.path.join(folder, "GOTEX-rf06-C130-2004.nc")
        if not folder or not os.path.exists(self.original):
            self.skipTest("no GOTEX-rf06-C130-2004.nc in $PCOR_FLIGHTS")

    def test_frozen_minute_is_missing_and_flagged(self):
        model = self.write("attack.toml", PUBLISHED.read_text().replace("[variables]", '[variables]\nattack = "ATTACK"', 1)
                           + '\n[[effect]]\nid = "mine"\nwhere = "static"\nformula = "k * attack"\nunit = "hPa"\n'
                             'parameters = { k = 0.1 }\n')
        flight, output = self.path / "flight.nc", self.path / "out.nc"
        bit = 1 << 18
        clean = self.processed(self.original, model, output)
        shutil.copyfile(self.original, flight)
        with netCDF4.Dataset(flight, "r+") as file:
            for name, held in self.HELD.items():
                file[name][held] = file[name][held.start]
        for options in ((), ("--keep-frozen",)):
            pressure, flags = self.processed(flight, model, output, *options)
            frozen = numpy.zeros(len(flags), bool)
            for held in self.HELD.values():
                frozen[held] = True
            numpy.testing.assert_array_equal((flags & bit) != 0, frozen)
            numpy.testing.assert_array_equal(pressure[~frozen], clean[0][~frozen])
            self.assertEqual(numpy.isnan(pressure[frozen]).all(), not options)
        self.assertFalse((clean[1] & bit).any())

    def processed(self, flight, model, output, *options):
        self.done("process", flight, "-m", model, "-o", output, "--suffix", "_NEW", *options)
        with netCDF4.Dataset(output) as file:
            return numpy.ma.filled(file["PSXC_NEW"][:], numpy.nan), file["PCORFLAG_NEW"][:].astype(int)


class Times(ChangedTest):
    def test_impossible_times_are_refused(self):
        with netCDF4.Dataset(ONE) as flight:
            day = flight["Time"].units.split("since ")[1][:10]
        for of_day in (" 00:00:00 +25:00", " 00:00:00 -99", " 00:00:00 +9999", " 00:60:00", " 25:00:00", " 00:00:00 +05:75",
                       "-99", "-05", "+05:00", " -1:00:00", " +0030"):
            with self.subTest(of_day):
                flight = self.with_units(f"seconds since {day}{of_day}")
                self.refused("process", flight, "-m", PUBLISHED, "-o", self.path / "out.nc", words=[of_day, "ncatted"])
                flight.unlink()

    def test_an_impossible_begin_is_refused(self):
        def change(flight):
            flight["Time"].units = "seconds"
            flight["Time"][:] = flight["Time"][:] - flight["Time"][0]
            flight.TimeInterval = "99:99:99-99:99:99"
        self.refused("process", self.changed(change), "-m", PUBLISHED, "-o", self.path / "out.nc", words=["ncatted"])

    def test_possible_times_are_read_correctly(self):
        with netCDF4.Dataset(ONE) as flight:
            units = flight["Time"].units
        day = units.split("since ")[1][:10]
        for of_day, hours in (("00:00:00", 0), ("00:00:00 +0000", 0), ("00:00:00 UTC", 0), ("00:00", 0), ("", 0),
                              ("T00:00:00Z", 0), ("00:00:00.0", 0), ("00:00:00 +01:00", -1), ("01:00:00 +0", 1), ("+0000", 0),
                              ("00:00:00,0 UTC", 0), (", 00:00:00 UTC", 0)):
            with self.subTest(of_day):
                flight = self.with_units(f"seconds since {day} {of_day}".replace(" T", "T"))
                begins = self.json_of("inspect", flight)["flights"][0]["begin"]
                with netCDF4.Dataset(ONE) as original:
                    expected = original["Time"][0] + 3600 * hours
                from datetime import datetime, timedelta
                self.assertEqual(begins[:19], (datetime.fromisoformat(day) + timedelta(seconds=int(expected))).isoformat()[:19])

    def test_milliseconds_are_kept(self):
        def change(flight):
            values = flight["Time"][:].astype("f8")
            units = flight["Time"].units
            flight.renameVariable("Time", "seconds_of_day")
            milliseconds = flight.createVariable("Time", "f8", ("Time",))
            epoch = netCDF4.num2date(0, units).isoformat()[:10]
            since_1970 = (numpy.datetime64(epoch) - numpy.datetime64("1970-01-01")) / numpy.timedelta64(1, "s")
            milliseconds.units = "milliseconds since 1970-01-01 00:00:00 +0000"
            milliseconds[:] = 1000.0 * (since_1970 + values)
        ours = self.json_of("inspect", self.changed(change))["flights"][0]
        theirs = self.json_of("inspect", ONE)["flights"][0]
        self.assertEqual((ours["begin"], ours["end"]), (theirs["begin"], theirs["end"]))


class Attributes(ChangedTest):
    def packed(self, unsigned):
        def change(flight):
            values = flight["PSFD"][:]
            flight.renameVariable("PSFD", "PSFD_AS_IT_WAS")
            packed = flight.createVariable("PSFD", "i2", ("Time",))
            packed.units, packed.scale_factor, packed.add_offset = "hPa", 0.02, 0.0
            packed.setncattr("_Unsigned", unsigned)
            packed[:] = numpy.nan_to_num(values / 0.02).astype("u2").astype("i2")
        return self.changed(change)

    def test_unsigned_attribute_must_be_true_or_false(self):
        for word in ("yes", "1", "t", " true", 1):
            with self.subTest(word):
                self.refused("process", self.packed(word), "-m", PUBLISHED, "-o", self.path / "out.nc",
                             words=["_Unsigned of PSFD", "expected true or false"])
                (self.path / "changed.nc").unlink()
        self.done("process", self.packed("True"), "-m", PUBLISHED, "-o", self.path / "out.nc")

    def test_the_rate_follows_from_the_dimension(self):
        def change(flight):
            values = flight["PSFD"][:]
            flight.renameVariable("PSFD", "PSFD_AS_IT_WAS")
            flight.createDimension("sps25", 5)
            flight.createVariable("PSFD", "f4", ("Time", "sps25")).units = "hPa"
            flight["PSFD"][:] = numpy.repeat(values[:, None], 5, 1)
        self.refused("process", self.changed(change), "-m", PUBLISHED, "-o", self.path / "out.nc", words=["PSFD(Time, sps25 = 5)"])

    def test_a_formula_has_a_coefficient(self):
        model = self.model(comparison_test.with_effect('id = "mine"\nwhere = "static"\nformula = "PSFD / 1000"\nunit = "hPa"\nparameters = {}\n'))
        self.refused("process", ONE, "-m", model, "-o", self.path / "out.nc", words=["mine", "no coefficient"])

    @unittest.skipIf(os.environ.get("PCOR_SANITIZED"), "a sanitizer reserves more addresses than the limit")
    def test_small_file_does_not_use_gigabytes_of_memory(self):
        path = self.path / "large.nc"
        with netCDF4.Dataset(path, "w") as flight:
            flight.createDimension("Time", 3000000)
            seconds = flight.createVariable("Time", "i4", ("Time",), zlib=True, complevel=9, shuffle=True)
            seconds.units = "seconds since 2011-11-17 00:00:00 +0000"
            seconds[:] = numpy.arange(3000000)
            for name in ("PSFD", "QCF", "TTRR", "VLAMS"):
                flight.createVariable(name, "f4", ("Time",), zlib=True).units = "hPa"
        self.assertLess(path.stat().st_size, 500000)
        result = subprocess.run([TOOL, "inspect", path], capture_output=True, text=True,
                                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (600 << 20, 600 << 20)))
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"3000000 records in \d+ bytes")

    @unittest.skipIf(os.environ.get("PCOR_SANITIZED"), "a sanitizer reserves more addresses than the limit")
    def test_a_small_file_cannot_declare_many_samples(self):
        path = self.path / "large.nc"
        with netCDF4.Dataset(path, "w") as flight:
            flight.createDimension("Time", 190000)
            flight.createDimension("sps1000", 1000)
            seconds = flight.createVariable("Time", "i4", ("Time",), zlib=True, complevel=9, shuffle=True)
            seconds.units = "seconds since 2011-11-17 00:00:00 +0000"
            seconds[:] = numpy.arange(190000)
            for name, unit, value in (("PSFD", "hPa", 700), ("QCF", "hPa", 60), ("QCR", "hPa", 60), ("ADIFR", "hPa", 5),
                                      ("TTRR", "degC", 5), ("EDPC", "hPa", 5)):
                variable = flight.createVariable(name, "f4", ("Time", "sps1000"), zlib=True, chunksizes=(100, 1000))
                variable.units = unit
                variable[:100] = value
        self.assertLess(path.stat().st_size, 1000000)
        result = subprocess.run([TOOL, "process", path, "-m", PUBLISHED, "-o", self.path / "out.nc"],
                                capture_output=True, text=True,
                                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (600 << 20, 600 << 20)))
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"190000000 samples in a file of \d+ bytes")


class Reports(ChangedTest):
    def test_reports_have_no_control_characters(self):
        signs = "\x1b[31m\x07\u202e\u2066\u2028\ufeff"
        model = self.model(lambda text: re.sub(r'^name = ".*"$', lambda _: f'name = "law \\u001b\\u0007{signs[6:]}"', text,
                                               count=1, flags=re.M))

        def change(flight):
            flight.setncattr("ProjectName", f"project {signs}")
        table = self.path / "table.csv"
        self.done("compare", ONE, "-m", model, "--table", table)
        self.assertEqual([sign for sign in signs[:2] + "\u202e\u2066\u2028\ufeff"
                          if sign in table.read_text(encoding="utf-8") and sign != "["], [])
        for arguments in (("compare", self.changed(change), "-m", model), ("inspect", self.changed(change))):
            page = self.path / "page.html"
            self.done(*arguments, "--report", page)
            text = page.read_text().split("<body>")[1].split("<script>")[0]
            self.assertEqual([sign for sign in ("\x1b", "\x07", "\0", "\u202e", "\u2066", "\u2028", "\ufeff",
                                                "\\u001b", "\\u0007", "\\u202e") if sign in text], [])


class Inspect(ChangedTest):
    @staticmethod
    def flight_of_four_seconds(path):
        flight = netCDF4.Dataset(path, "w")
        flight.createDimension("Time", 4)
        seconds = flight.createVariable("Time", "i4", ("Time",))
        seconds.units = "seconds since 2011-11-17 00:00:00 +0000"
        seconds[:] = range(4)
        return flight

    @in_long_tests
    def test_a_link_to_a_pipe_does_not_hang(self):
        library = ctypes.util.find_library("hdf5_serial") or ctypes.util.find_library("hdf5")
        if library is None:
            self.skipTest("no library of HDF5 to make a link with")
        hdf5 = ctypes.CDLL(library)
        hdf5.H5Fopen.restype = ctypes.c_int64
        hdf5.H5Fopen.argtypes = [ctypes.c_char_p, ctypes.c_uint, ctypes.c_int64]
        hdf5.H5Lcreate_external.argtypes = [ctypes.c_char_p, ctypes.c_char_p, ctypes.c_int64, ctypes.c_char_p,
                                            ctypes.c_int64, ctypes.c_int64]
        hdf5.H5Fclose.argtypes = [ctypes.c_int64]
        path, pipe = self.path / "linked\n\x1b[31m.nc", self.path / "pipe"
        with self.flight_of_four_seconds(path) as flight:
            for number in range(5000):  # the reader works before it waits
                flight.createVariable(f"V{number}", "f4", ("Time",)).units = "hPa"
        os.mkfifo(pipe)
        file = hdf5.H5Fopen(os.fsencode(path), 1, 0)
        self.assertGreaterEqual(file, 0)
        self.assertGreaterEqual(hdf5.H5Lcreate_external(os.fsencode(pipe), b"/x", file, b"ZZZ", 0, 0), 0)
        hdf5.H5Fclose(file)
        result = self.run_tool("inspect", path, timeout=90)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"linked\\x0a\\x1b\[31m\.nc.*pipe")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
