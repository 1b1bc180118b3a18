"""Run the notebooks and store them with their outputs: `python notebooks/run.py [NAME ...]`.

Needs the extra `notebooks`: python -m pip install "desaxe[notebooks]".
"""

import sys
from pathlib import Path

try:
    import nbformat
    from nbclient import NotebookClient
except ModuleNotFoundError as error:
    sys.exit(f'{error}: python -m pip install "desaxe[notebooks]", in a clone -e ".[notebooks]"')

FOLDER = Path(__file__).parent


def run(path: Path) -> None:
    """Execute a notebook in a folder of its own kind, and write it with what it shows."""
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=600, resources={"metadata": {"path": FOLDER}}).execute()
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)  # times of day
    notebook.metadata = {
        "kernelspec": notebook.metadata["kernelspec"],
        "language_info": {"name": "python"},
    }
    nbformat.write(notebook, path)


if __name__ == "__main__":
    for name in sys.argv[1:] or sorted(p.stem for p in FOLDER.glob("*.ipynb")):
        run(FOLDER / f"{Path(name).stem}.ipynb")
        print(name)
