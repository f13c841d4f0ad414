"""Flights that several tests use, simulated once, and the tool to compare with."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import pcor
from pcor._tool import tool

SOURCE = Path(__file__).parents[2]
sys.path.insert(0, str(SOURCE / "tests/tool"))
from scenarios import half_of_hidden  # noqa: E402
os.environ.setdefault("MPLBACKEND", "agg")


def run_tool(*words, folder=None):
    return subprocess.run(["pcor", *map(str, words)], executable=tool, cwd=folder, capture_output=True, text=True)


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("flights")
    scenario = folder / "hidden.toml"
    scenario.write_text(half_of_hidden(SOURCE))
    for name, seed in ("first", 101), ("second", 102), ("third", 103):
        pcor.simulate(scenario, seed=seed, output=folder / f"{name}.nc")
    (folder / "model.toml").write_text((SOURCE / "data/scenarios/models/c130-psfd-eq18.toml").read_text())
    (folder / "data").symlink_to(SOURCE / "data")
    return folder


@pytest.fixture
def in_folder(folder, monkeypatch):
    monkeypatch.chdir(folder)
    return folder
