"""Runs the notebooks and the Python lines of README.md and docs/python.md."""

import os
import re
from pathlib import Path

import pytest
from conftest import SOURCE


REAL_FLIGHT = "GOTEX-rf06-C130-2004.nc"


def run_python_lines(page, count):
    blocks = re.findall(r"^```python\n(.*?)^```", (SOURCE / page).read_text(), flags=re.MULTILINE | re.DOTALL)
    assert len(blocks) == count
    names = {}
    exec(compile("".join(blocks), page, "exec"), names)
    return names


def test_code_of_the_documentation_runs(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    run_python_lines("docs/python.md", 3)
    assert (tmp_path / "compare.html").stat().st_size > 10_000


def test_code_of_the_readme_runs(tmp_path, monkeypatch):
    real = Path(os.environ.get("PCOR_FLIGHTS", "")) / REAL_FLIGHT
    if not real.is_file():
        pytest.skip(f"{REAL_FLIGHT} is not in the folder PCOR_FLIGHTS")
    monkeypatch.chdir(tmp_path)
    Path(REAL_FLIGHT).symlink_to(real.resolve())
    names = run_python_lines("README.md", 1)
    assert names["fit"].rms_hpa < names["fit"].rms_before_hpa
    assert names["corrected"].PSXC.attrs["units"] == "hPa"


@pytest.mark.parametrize("name", ["real_flight", "own_effect"])
def test_notebook_runs(tmp_path, name):
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    pytest.importorskip("matplotlib")
    import nbformat

    notebook = nbformat.read(SOURCE / f"python/notebooks/{name}.ipynb", as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
