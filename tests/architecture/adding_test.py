#!/usr/bin/env python3
"""Adds a part to a copy of the sources, as CONTRIBUTING.md describes, and uses it.

    adding_test.py effect  SOURCE_FOLDER SCRATCH_FOLDER COMPILER
    adding_test.py command SOURCE_FOLDER SCRATCH_FOLDER

No more than two files may be touched. The effect is compiled into a sample loop, which needs headers alone; the
sub-command needs the whole tool, which takes minutes.
"""
import filecmp
import os
import pathlib
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


def touched(source, copy):
    """The production files that differ."""
    return sorted(str(path.relative_to(copy)) for part in ("include", "src", "tools") for path in (copy / part).rglob("*")
                  if path.is_file() and not (source / path.relative_to(copy)).exists()
                  or path.is_file() and not filecmp.cmp(path, source / path.relative_to(copy), shallow=False))


def output(*command):
    return subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True).stdout


def add_effect(copy, compiler):
    (copy / "include/pcor/effects/my_effect.hpp").write_text(EFFECT)
    catalogue = copy / "include/pcor/effects/catalogue.hpp"
    edited(catalogue, "#include <pcor/effects/pitot_angle.hpp>",
           "#include <pcor/effects/my_effect.hpp>\n#include <pcor/effects/pitot_angle.hpp>")
    edited(catalogue, "std::tuple<", "std::tuple<effects::MyEffect, ")
    program = copy / "program"
    program.with_suffix(".cpp").write_text(USE_OF_EFFECT)
    output(compiler, "-std=c++17", "-I", copy / "include", program.with_suffix(".cpp"), "-o", program)
    return output(program), "701.000"


def add_command(copy):
    (copy / "tools/pcor/my_command.cpp").write_text(COMMAND)
    commands = copy / "tools/pcor/commands.hpp"
    edited(commands, "AddCommand ", "AddCommand add_my_command, ")
    edited(commands, "commands{", "commands{&add_my_command, ")
    output("cmake", "--preset", "release", "-S", copy, "-DPCOR_TESTS=OFF")
    output("cmake", "--build", copy / "build/release", "--target", "pcor_tool", "-j", os.cpu_count())
    return output(copy / "build/release/tools/pcor", "my-command"), "hello\n"


part, source, scratch, *compiler = sys.argv[1:]
copy = copied(pathlib.Path(source), pathlib.Path(scratch))
said, expected = {"effect": add_effect, "command": add_command}[part](copy, *compiler)
files = touched(pathlib.Path(source), copy)
print(f"{part}: {' and '.join(files)} touched; output: {said.strip()}")
sys.exit(0 if said == expected and len(files) <= 2 else 1)
