"""The notebooks and the lines of docs/python.md are run."""

import os
import re

import pytest
from conftest import SOURCE


def test_lines_of_the_documentation_run(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    text = (SOURCE / "docs/python.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)
    assert len(blocks) == 3
    exec(compile("".join(blocks), "docs/python.md", "exec"), {})
    assert (tmp_path / "compare.html").stat().st_size > 10_000


@pytest.mark.parametrize("name", ["real_flight", "own_effect"])
def test_notebook_runs(tmp_path, name):
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    pytest.importorskip("matplotlib")
    import nbformat

    if name == "real_flight" and not os.path.exists(
            os.path.join(os.environ.get("PCOR_FLIGHTS", ""), "GOTEX-rf06-C130-2004.nc")):
        pytest.skip("GOTEX-rf06-C130-2004.nc is not in the folder PCOR_FLIGHTS")
    notebook = nbformat.read(SOURCE / f"python/notebooks/{name}.ipynb", as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
