"""Every notebook runs to its end, and is kept without output."""

import pytest

from conftest import ROOT

nbclient = pytest.importorskip("nbclient")
nbformat = pytest.importorskip("nbformat")

FOLDER = ROOT / "crates/python/notebooks"
NAMES = sorted(path.name for path in FOLDER.glob("*.ipynb"))


def test_there_are_five():
    assert len(NAMES) == 5


@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_runs(name):
    book = nbformat.read(FOLDER / name, as_version=4)
    assert not any(cell.get("outputs") for cell in book.cells), "clear the outputs before you commit a notebook"
    # A busy machine takes its time to start a kernel.
    nbclient.NotebookClient(
        book, timeout=500, startup_timeout=300, resources={"metadata": {"path": str(FOLDER)}}
    ).execute()
