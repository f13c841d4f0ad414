#!/usr/bin/env python3
"""The order of an option that may be given several times changes no result.

    order_test.py TOOL SOURCE_DIRECTORY
"""

import itertools
import json
import sys
import unittest

sys.dont_write_bytecode = True  # no __pycache__ in the source directory
import comparison_test  # noqa: E402
from comparison_test import ONE, OTHER_SYSTEM, TWO, ComparisonTest  # noqa: E402

setUpModule, tearDownModule = comparison_test.setUpModule, comparison_test.tearDownModule

# What tells when a result was made, and where.
OF_THE_RUN = ("statistics_seconds", "date", "history", "created", "command")


def without_run(value):
    if isinstance(value, dict):
        return {key: without_run(each) for key, each in value.items() if key not in OF_THE_RUN}
    return [without_run(each) for each in value] if isinstance(value, list) else value


class OrderTest(ComparisonTest):
    def assert_no_order(self, *arguments, option, values, change=without_run):
        """Every order of the values gives the same result, or is refused in the same words."""
        results = []
        for order in itertools.permutations(values):
            more = [word for value in order for word in (option, value)]
            result = self.run_tool(*arguments, *more, "--json", "-", "--quiet")
            self.assertEqual(result.returncode, 0, result.stderr)
            results.append(change(json.loads(result.stdout)))
        for result in results[1:]:
            self.assertEqual(results[0], result)

    def test_references(self):
        values = ("lams", f"static:{OTHER_SYSTEM}", f"total:{OTHER_SYSTEM}")
        model, output = self.model(), self.path / "out.toml"
        for command in (("compare", ONE, "-m", model),
                        ("refit", ONE, "-m", model, "-o", output, "--force"),
                        ("diagnose", ONE, "-m", model)):
            with self.subTest(command[0]):
                self.assert_no_order(*command, option="--reference", values=values)
        with self.subTest("improve"):
            self.assert_no_order("improve", ONE, "-m", model, "-o", output, "--force",
                                 option="--reference", values=values[:2])

    def test_references_beside_a_fit_of_both_systems(self):
        self.assert_no_order("refit", ONE, "-m", self.model(), "-o", self.path / "out.toml", "--force",
                             "--refit-reference", self.path / "other.toml",
                             option="--reference", values=("lams", f"static:{OTHER_SYSTEM}"))

    def test_exclusions(self):
        model, output = self.model(), self.path / "out.toml"
        for command in (("compare", ONE, "-m", model), ("refit", ONE, "-m", model, "-o", output),
                        ("diagnose", ONE, "-m", model)):
            with self.subTest(command[0]):
                self.assert_no_order(*command, option="--exclude", values=("turn", "climb", "descent"))

    def test_models_and_names(self):
        model, output = self.model(), self.path / "out.toml"
        other = self.model(comparison_test.with_a0(0.005), name="other.toml")
        self.assert_no_order("compare", ONE, option="-m", values=(model, other),
                             change=lambda result: sorted((each["name"], each["samples"], round(each["rms_hpa"], 6))
                                          for each in result["models"]))
        self.assert_no_order("refit", ONE, "-m", model, "-o", output, option="--fix",
                             values=("static-qp.a2", "static-alpha.a1"))
        self.assert_no_order("diagnose", ONE, "-m", model, option="--not-variable", values=("ENGTRQ", "GGALT"))

    def test_held_out_flights(self):
        third = self.path / "third.nc"
        scenario = self.write("scenario.toml", comparison_test.SCENARIO)
        self.done("simulate", scenario, "-o", third, "--seed", "9", "--quiet")

        self.assert_no_order("refit", ONE, "-m", self.model(), "-o", self.path / "out.toml", "--force",
                             option="--holdout", values=(TWO, third),
                             change=lambda result: (result["effects"], result["rms_hpa"]))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])
