#!/usr/bin/env python3
"""The order of an option that may be given several times changes no result.

    order_test.py TOOL SOURCE_DIRECTORY
"""

import json
import math
import re
import sys
import unittest

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
import comparison_test  # noqa: E402
from comparison_test import FLIGHTS, ONE, OTHER_SYSTEM, TWO, ComparisonTest, with_a0  # noqa: E402
from long_tests import in_long_tests  # noqa: E402
from scenarios import simulate  # noqa: E402
from tool_test import SOURCE, TOOL, replace  # noqa: E402

THREE, CLIMBS = FLIGHTS / "three.nc", FLIGHTS / "climbs.nc"

# Time and place of the computation of a result.
OF_THE_RUN = ("statistics_seconds", "date", "history", "created", "command")

REGIMES = ("turn", "climb", "descent")
REFERENCES = ("lams", f"static:{OTHER_SYSTEM}", f"total:{OTHER_SYSTEM}")
FORMULAS = ("k * ENGTRQ / 100", "k * mach^4")
HELD = replace(r"^parameters = \{ (a[12]) .*$", '\\g<0>\nfixed = ["\\1"]')

# By command and option: the values, and a change of the model.
CASES = {
    ("check", "--exclude"): (REGIMES, None),
    ("compare", "--exclude"): (REGIMES, None),
    ("compare", "--model"): ((), None),  # see `models`
    ("compare", "--reference"): (REFERENCES, None),
    ("diagnose", "--exclude"): (REGIMES[:2], None),
    ("diagnose", "--fix"): (("static-qp.a2", "static-alpha.a1"), None),
    ("diagnose", "--free"): (("static-qp.a2", "static-alpha.a1"), HELD),
    ("diagnose", "--not-variable"): (("ENGTRQ", "GGALT"), None),
    ("diagnose", "--reference"): (REFERENCES, None),
    ("diagnose", "--try"): (FORMULAS, None),
    ("improve", "--exclude"): (REGIMES[:2], None),
    ("improve", "--fix"): (("static-qp.a2", "static-alpha.a1"), None),
    ("improve", "--free"): (("static-qp.a2", "static-alpha.a1"), HELD),
    ("improve", "--holdout"): ((TWO, THREE), None),
    ("improve", "--reference"): (REFERENCES[:2], None),
    ("improve", "--try"): (FORMULAS, None),
    ("refit", "--exclude"): (REGIMES, None),
    ("refit", "--fix"): (("static-qp.a2", "static-alpha.a1"), None),
    ("refit", "--free"): (("static-qp.a2", "static-alpha.a1"), HELD),
    ("refit", "--holdout"): ((TWO, THREE), None),
    ("refit", "--reference"): (REFERENCES, None),
    ("refit", "--stage"): (("pitch manoeuvre: static-alpha", "speed run: static-qp"), None),
    ("temperature", "--exclude"): (REGIMES[:2], None),
    ("temperature", "--reference"): (("lams", "pressure:PS_A"), None),
}


def setUpModule():
    comparison_test.setUpModule()
    simulate(TOOL, THREE, comparison_test.SCENARIO, 9)
    simulate(TOOL, CLIMBS, (SOURCE / "data/scenarios/c130-climbs.toml").read_text(), 31)


tearDownModule = comparison_test.tearDownModule


def without_run(value):
    """The result without date and command, and with its models and flights sorted."""
    if isinstance(value, dict):
        return {key: without_run(each) for key, each in value.items() if key not in OF_THE_RUN}
    if isinstance(value, list):
        values = [without_run(each) for each in value]
        are_named = all(isinstance(each, dict) and "name" in each for each in values)
        return sorted(values, key=lambda each: json.dumps(each)) if are_named else values
    return value


class Order(ComparisonTest):
    def result(self, arguments):
        result = self.run_tool(*arguments, "--json", "-", "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        return without_run(json.loads(result.stdout))

    def assert_no_order(self, *arguments, option, values):
        """Rotations of the values give the same result: each value is once at each place and before each other
        value."""
        results = [self.result([*arguments, *(word for value in values[i:] + values[:i] for word in (option, value))])
                   for i in range(len(values))]
        for result in results[1:]:
            self.assert_same(results[0], result)

    def assert_same(self, one, other, place=""):
        """Equal except for rounding: sums over held-out flights follow the order of the command."""
        self.assertEqual(type(one), type(other), place)
        if isinstance(one, dict):
            self.assertEqual(list(one), list(other), place)
            for key in one:
                self.assert_same(one[key], other[key], f"{place}/{key}")
        elif isinstance(one, list):
            self.assertEqual(len(one), len(other), place)
            for number, (mine, yours) in enumerate(zip(one, other)):
                self.assert_same(mine, yours, f"{place}/{number}")
        elif isinstance(one, float):
            self.assertTrue(math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-12), f"{place}: {one} {other}")
        else:
            self.assertEqual(one, other, place)

    def arguments(self, command, option, change):
        model = ("-m", self.model(change or (lambda text: text)))
        output = ("-o", self.path / "out.toml", "--force")
        return {"check": ("check", ONE, *model),
                "compare": ("compare", ONE),
                "diagnose": ("diagnose", ONE, *model),
                "improve": ("improve", ONE, *model, *output),
                "refit": ("refit", ONE, *model, *output),
                "temperature": ("temperature", CLIMBS, *model, *output, *(("--iterate",) if option == "--reference" else ()))}[command]

    def models(self):
        """Laws of other air, and one whose mask leaves more samples."""
        shifted = self.model(with_a0(0.02), name="shifted.toml")
        without = self.model(lambda text: re.sub(r"\n\[\[effect\]\]\nid = \"static-alpha\"[^\[]*", "\n",
                                                 comparison_test.MODEL), name="without.toml")
        return self.model(), shifted, without

    @in_long_tests
    def test_order_of_option_values_does_not_change_results(self):
        for (command, option), (values, change) in CASES.items():
            with self.subTest(command=command, option=option):
                arguments = self.arguments(command, option, change)
                if option == "--model":
                    values = self.models()
                elif command == "compare":
                    arguments += ("-m", self.model())
                self.assert_no_order(*arguments, option=option, values=values)

    def test_every_repeatable_option_is_tested(self):
        repeat = set()
        for command in re.findall(r"^  ([a-z]+) ", self.done("--help").stdout, flags=re.MULTILINE):
            text = re.sub(r"\n {20,}", " ", self.run_tool(command, "--help").stdout)
            for line in text.splitlines():
                if "may be repeated" in line:
                    repeat.add((command, re.search(r"--[a-z-]+", line).group()))
        self.assertEqual(repeat, set(CASES))

    def test_order_of_references_when_fitting_both_systems(self):
        self.assert_no_order("refit", ONE, "-m", self.model(), "-o", self.path / "out.toml", "--force",
                             "--refit-reference", self.path / "other.toml",
                             option="--reference", values=("lams", f"static:{OTHER_SYSTEM}"))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
