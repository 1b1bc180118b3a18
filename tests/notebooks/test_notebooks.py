"""Every notebook runs as it is committed, quietly, with its pictures, and is committed with what it shows."""

import json
import re
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

FOLDER = Path(__file__).parents[2] / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
FIGURES = {"02_paper_a": range(9, 13), "03_paper_b": range(5, 19), "04_paper_c": range(5, 12)}


@pytest.mark.thorough
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_runs(path):
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": FOLDER}}).execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert [output.text for output in shown if output.get("name") == "stderr"] == []
    pictures = [output for output in shown if "image/png" in output.get("data", {})]
    drawn = sum(cell.source.count(".figure") for cell in notebook.cells if ends_in_a_figure(cell))
    assert len(pictures) == drawn


def test_it_runs_where_it_is_copied_to(tmp_path):
    """The papers' figures come from the package, not from a folder beside the notebook."""
    notebook = nbformat.read(FOLDER / "02_paper_a.ipynb", as_version=4)
    notebook.cells = [cell for cell in notebook.cells if cell.cell_type == "code"][:2]
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": tmp_path}}).execute()


def ends_in_a_figure(cell):
    last = cell.source.splitlines()[-1]
    return cell.cell_type == "code" and (last.endswith(".figure") or last == "figure")


@pytest.mark.parametrize(("name", "figures"), FIGURES.items())
def test_every_figure_of_a_paper_stands_beside_its_description(name, figures):
    """A heading, the paper's words as a quotation, then the figure."""
    cells = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4).cells
    for number in figures:
        (place,) = (k for k, cell in enumerate(cells) if cell.source.startswith(f"## Figure {number}\n"))
        assert re.search(r"^> \S", cells[place].source, re.MULTILINE)
        assert cells[place + 1].source == f"paper_{name[-1]}.draw({number}).figure"


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_is_committed_with_its_outputs(path):
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    shown = [output for cell in code for output in cell.outputs]
    assert len(shown) >= len(code) / 3
    assert not [o for o in shown if o.output_type == "error" or o.get("name") == "stderr"]
    assert path.stat().st_size < 3_000_000
    assert set(notebook.metadata) == {"kernelspec", "language_info"}
    raw = json.loads(path.read_text(encoding="utf-8"))
    assert all(isinstance(cell["source"], list) for cell in raw["cells"])  # line by line, for diffs
