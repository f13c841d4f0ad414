#!/usr/bin/env python3
"""Adds parts to a copy of the sources, as CONTRIBUTING.md describes, and uses them.

    adding_test.py effect SOURCE_FOLDER SCRATCH_FOLDER COMPILER
    adding_test.py tool   SOURCE_FOLDER SCRATCH_FOLDER

No part may touch more files than CONTRIBUTING.md states. The effect is compiled into a sample loop, which needs headers alone.
The other parts (check, reference, derived variable, file format, sub-command) need one build of the whole tool, which takes
minutes.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

EFFECT = """#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct MyEffect {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "my-effect";
    info.title = "static-port error in proportion to the dynamic pressure";
    info.location = EffectLocation::static_defect;
    info.formula = "k * dynamic_pressure";
    info.parameters[0] = {"k", "1", 0.0, -0.1, 0.1, 0.01};
    info.needs = {Quantity::dynamic_pressure, Quantity::count, Quantity::count, Quantity::count};
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * state[Quantity::dynamic_pressure];
  }
};

}  // namespace pcor::effects
"""

USE_OF_EFFECT = """#include <cstdio>
#include <string>
#include <pcor/realtime/loop.hpp>

int main() {
  using pcor::Quantity;
  pcor::Model model;
  model.effects = {{"my-effect", {0.02}}};
  std::string error;
  auto loop = pcor::Loop::build(model, {Quantity::static_pressure, Quantity::dynamic_pressure}, 1.0, &error);
  if (!loop) return std::fprintf(stderr, "%s\\n", error.c_str()), 1;
  loop->state()[Quantity::static_pressure] = 700.0;
  loop->state()[Quantity::dynamic_pressure] = 50.0;
  loop->run(0.0);
  std::printf("%.3f", loop->state()[Quantity::corrected_static_pressure]);
}
"""

COMMAND = """#include <fmt/format.h>

#include "command.hpp"

namespace pcor::tool {

std::function<void()> add_my_command(CLI::App& program) {
  program.add_subcommand("my-command", "Says hello");
  return [] { fmt::print("hello\\n"); };
}

}  // namespace pcor::tool
"""


CHECK = """#include "checks/checks.hpp"
#include "checks/verdict.hpp"

namespace pcor::internal {

CheckResult check_my_check(const CheckedFlights& flights) {
  CheckResult result;
  set_verdict({test_statistic({flights.front().air.step(), 0.1}, 2.0, "s", "record interval")}, result);
  result.finding = "The record interval is short";
  result.limitations = "Insensitive to everything else.";
  return result;
}

}  // namespace pcor::internal
"""

REFERENCE = """#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <pcor/residuals/reference.hpp>
#include "residuals/reference_on_samples.hpp"

namespace pcor::internal {

class MyReferenceOnSamples final : public ReferenceOnSamples {
 public:
  void residuals(const Block& block, const double*, double* out) const override {
    std::fill_n(out, block.samples.size(), 0.25);
  }
  void residuals(const std::vector<std::size_t>& samples, const Jet*, Jet* out) const override {
    std::fill_n(out, samples.size(), Jet(0.25));
  }
  Mask why_missing(std::size_t) const override { return Mask::missing; }
};

class MyReference final : public Reference {
 public:
  std::string description() const override { return "a pressure 0.25 hPa above that of the model"; }
  std::string name() const override { return "my-reference"; }
  std::unique_ptr<ReferenceOnSamples> on(const FlightSamples&, const ModelOnSamples&) const override {
    return std::make_unique<MyReferenceOnSamples>();
  }
};

}  // namespace pcor::internal
"""

FORM = """    {"my-reference", "", "a constant residual",
     [](const std::string&, const ModelDefinition&) -> Pointer { return std::make_shared<MyReference>(); }},
"""

STAGE = """struct TotalPressure {
  static Quantities reads(const Correction&) {
    return {Quantity::corrected_static_pressure, Quantity::corrected_dynamic_pressure};
  }
  static Quantities writes(const Correction&) { return {Quantity::total_pressure}; }

  template <class S, class P, class Flags>
  static void compute(const Correction&, State<S>& state, const P*, Flags&) {
    state[Quantity::total_pressure] =
        state[Quantity::corrected_static_pressure] + state[Quantity::corrected_dynamic_pressure];
  }
};

"""

ROW = """       {"PTXC", Q::total_pressure, "Corrected Total Pressure", "", "Aircraft State",
        [](const Correction&) {
          return Quantities{Q::corrected_static_pressure, Q::corrected_dynamic_pressure};
        }},
"""

FORMAT = """#include <fstream>
#include <sstream>
#include <utility>

#include "flight/flight_file.hpp"

namespace pcor::internal {
namespace {

/// Names of the variables in the second line, their values in the following ones.
class MyFile final : public FlightFile {
 public:
  explicit MyFile(std::filesystem::path path) : path_(std::move(path)) {
    std::ifstream file(path_);
    std::string line;
    std::getline(file, line);
    std::getline(file, line);
    std::istringstream names(line);
    for (std::string name; names >> name;) names_.push_back(name);
    for (double value; file >> value;) values_.push_back(value);
  }

  const std::filesystem::path& path() const override { return path_; }
  int variable_count() const override { return static_cast<int>(names_.size()); }
  std::string variable_name(int variable) const override { return names_[static_cast<std::size_t>(variable)]; }
  std::vector<int> dimensions_of(int) const override { return {0}; }
  std::string dimension_name(int) const override { return "Time"; }
  std::size_t dimension_length(int) const override { return values_.size() / names_.size(); }
  std::vector<std::string> attribute_names(int variable) const override {
    return variable == whole_file ? std::vector<std::string>{} : std::vector<std::string>{"units"};
  }
  std::string text_attribute(int variable, const std::string& name) const override {
    if (variable == whole_file || name != "units") return "";
    return variable == 0 ? "seconds since 2004-02-18 00:00:00 +0000" : "hPa";
  }
  std::vector<double> number_attribute(int, const std::string&) const override { return {}; }
  void read(int variable, RecordBlock records, double* out) const override {
    for (std::size_t i = 0; i < records.count; ++i)
      out[i] = values_[(records.first + i) * names_.size() + static_cast<std::size_t>(variable)];
  }

 private:
  std::filesystem::path path_;
  std::vector<std::string> names_;
  std::vector<double> values_;
};

}  // namespace

std::unique_ptr<FlightFile> open_my_format(const std::filesystem::path& path) {
  return std::make_unique<MyFile>(path);
}

}  // namespace pcor::internal
"""


def copied(source, scratch):
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    for part in ("CMakeLists.txt", "CMakePresets.json", "LICENSE", "cmake", "data", "include", "src", "tools"):
        copy = shutil.copytree if (source / part).is_dir() else shutil.copy
        copy(source / part, scratch / part)
    return scratch


def edited(path, before, after):
    text = path.read_text()
    assert before in text, f"{path} has no '{before}'"
    path.write_text(text.replace(before, after, 1))


def contents(copy):
    """Production files and what they hold."""
    return {str(path.relative_to(copy)): path.read_bytes() for part in ("data", "include", "src", "tools")
            for path in (copy / part).rglob("*") if path.is_file()}


def touched_by(add, copy):
    before = contents(copy)
    add(copy)
    return sorted(name for name, content in contents(copy).items() if before.get(name) != content)


def output(*command):
    return subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True).stdout


def add_effect(copy):
    (copy / "include/pcor/effects/my_effect.hpp").write_text(EFFECT)
    catalogue = copy / "include/pcor/effects/catalogue.hpp"
    edited(catalogue, "#include <pcor/effects/pitot_angle.hpp>",
           "#include <pcor/effects/my_effect.hpp>\n#include <pcor/effects/pitot_angle.hpp>")
    edited(catalogue, "std::tuple<", "std::tuple<effects::MyEffect, ")


def add_check(copy):
    (copy / "src/checks/my_check.cpp").write_text(CHECK)
    checks = copy / "src/checks/checks.hpp"
    edited(checks, "\nstruct NamedCheck", "CheckResult check_my_check(const CheckedFlights& flights);\n\nstruct NamedCheck")
    edited(checks, "all_checks{", 'all_checks{\n    NamedCheck{"my-check", check_my_check},')


def add_reference(copy):
    (copy / "src/residuals/references/my_reference.hpp").write_text(REFERENCE)
    references = copy / "src/residuals/reference.cpp"
    edited(references, '#include "residuals/references/pressure.hpp"',
           '#include "residuals/references/my_reference.hpp"\n#include "residuals/references/pressure.hpp"')
    edited(references, "forms[]{\n", "forms[]{\n" + FORM)


def add_variable(copy):
    quantities = copy / "include/pcor/model/quantity.hpp"
    edited(quantities, "  height_step,\n", "  total_pressure,\n  height_step,\n")
    edited(quantities, '    {"height_step"',
           '    {"total_pressure", "hPa", "corrected total pressure", Quantity::total_pressure},\n    {"height_step"')
    stages = copy / "include/pcor/realtime/stages.hpp"
    edited(stages, "template <class... Stage>\n", STAGE + "template <class... Stage>\n")
    edited(stages, ", LamsAir>", ", LamsAir, TotalPressure>")
    edited(copy / "src/model_io/output_table.cpp", '       {"HYDSTEP"', ROW + '       {"HYDSTEP"')
    pages = copy / "data/models/FORMAT.md"
    edited(pages, "| `HYDSTEP` |", "| `PTXC` | hPa | corrected total pressure |\n| `HYDSTEP` |")
    edited(pages, "| `height_step` |", "| `total_pressure` | hPa | corrected total pressure |\n| `height_step` |")


def add_format(copy):
    (copy / "src/flight/my_format.cpp").write_text(FORMAT)
    files = copy / "src/flight/flight_file.cpp"
    edited(files, "// icartt_file.cpp", "std::unique_ptr<FlightFile> open_my_format(const std::filesystem::path& path);\n\n"
           "// icartt_file.cpp")
    edited(files, "  if (is_netcdf(path))", '  if (path.extension() == ".my") return open_my_format(path);\n  if (is_netcdf(path))')


def add_command(copy):
    (copy / "tools/pcor/my_command.cpp").write_text(COMMAND)
    commands = copy / "tools/pcor/commands.hpp"
    edited(commands, "AddCommand ", "AddCommand add_my_command, ")
    edited(commands, "commands{", "commands{&add_my_command, ")


def use_effect(copy, compiler):
    program = copy / "program"
    program.with_suffix(".cpp").write_text(USE_OF_EFFECT)
    output(compiler, "-std=c++17", "-I", copy / "include", program.with_suffix(".cpp"), "-o", program)
    return output(program) == "701.000"


def use_check(pcor, flight):
    check = json.loads(output(pcor, "check", flight, "--json", "-", "--quiet"))["checks"][0]
    return (check["name"], check["verdict"]) == ("my-check", "consistent")


def use_reference(pcor, flight):
    result = json.loads(output(pcor, "compare", flight, "-m", "c130-psfd-eq18", "--reference", "my-reference", "--json", "-", "--quiet"))
    return abs(result["models"][0]["bias_hpa"] - 0.25) < 1e-9


def use_variable(pcor, flight):
    corrected = flight.with_name("corrected.nc")
    output(pcor, "process", flight, "-m", "c130-psfd-eq18", "-o", corrected, "--quiet")
    text = output("ncdump", "-v", "PSXC,QCXC,PTXC", corrected)
    static, dynamic, total = ([float(value.replace("_", "nan")) for value in re.search(rf"\n {name} =([^;]*);", text).group(1).split(",")]
                              for name in ("PSXC", "QCXC", "PTXC"))
    sums = [(p + q, t) for p, q, t in zip(static, dynamic, total) if p + q == p + q]
    return len(sums) > 1000 and all(abs(p - t) < 0.01 for p, t in sums)  # ncdump prints seven digits


def use_format(pcor, flight):
    mine = flight.with_name("flight.my")
    mine.write_text("my format\nTime PSFD QCF\n" + "".join(f"{time} {700 - 0.01 * time} 60\n" for time in range(600)))
    inspected = json.loads(output(pcor, "inspect", mine, "--json", "-", "--quiet"))["flights"][0]
    return inspected["roles"]["static_pressure"]["variable"] == "PSFD"


def use_command(pcor, _):
    return output(pcor, "my-command") == "hello\n"


def built_tool(copy):
    # Without optimisation, which would take longer than the programs run.
    output("cmake", "--preset", "release", "-S", copy, "-DPCOR_TESTS=OFF", "-DCMAKE_CXX_FLAGS_RELEASE=-O0")
    output("cmake", "--build", copy / "build/release", "--target", "pcor_tool", "-j", os.cpu_count())
    pcor = copy / "build/release/tools/pcor"
    flight = copy / "flight.nc"
    output(pcor, "simulate", copy / "data/scenarios/c130-short.toml", "-o", flight, "--quiet")
    return pcor, flight


what, source, scratch, *compiler = sys.argv[1:]
copy = copied(pathlib.Path(source), pathlib.Path(scratch))
# How to add a part, how to use it, and the number of files that it may touch.
parts = {"effect": (add_effect, use_effect, 2)} if what == "effect" else {
    "check": (add_check, use_check, 2), "reference": (add_reference, use_reference, 2),
    "derived variable": (add_variable, use_variable, 4), "file format": (add_format, use_format, 2),
    "sub-command": (add_command, use_command, 2)}
files = {name: touched_by(add, copy) for name, (add, _, _) in parts.items()}
arguments = (copy, *compiler) if what == "effect" else built_tool(copy)
failed = False
for name, (_, use, most) in parts.items():
    works = use(*arguments)
    failed |= not works or len(files[name]) > most
    print(f"{name}: {' and '.join(files[name])} touched; it {'works' if works else 'does not work'}")
sys.exit(failed)
