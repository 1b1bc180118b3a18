"""The wheel is complete: unzipped anywhere, without the repository, it evaluates and checks itself."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("src", "derive", "generated")
FILES = ("pyproject.toml", "README.md", "LICENSE")
BUILD = "from hatchling.build import build_wheel; build_wheel('wheel')"


def copy_of_the_tree(folder):
    skipped = shutil.ignore_patterns("__pycache__", "*.egg-info", "*.nbi", "*.nbc")
    for name in ROOMS:
        shutil.copytree(ROOT / name, folder / name, ignore=skipped)
    for name in FILES:
        shutil.copyfile(ROOT / name, folder / name)
    (folder / "wheel").mkdir()


def output_of(command, **where):
    """Run a command and return its output; the test fails with its error output."""
    done = subprocess.run(command, capture_output=True, text=True, check=False, **where)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def unzipped(tmp_path_factory):
    """The wheel of a copy of the tree, unzipped: the folder to put on the path."""
    tree = tmp_path_factory.mktemp("tree")
    copy_of_the_tree(tree)
    output_of([sys.executable, "-c", BUILD], cwd=tree)
    (wheel,) = (tree / "wheel").glob("*.whl")
    site = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    return site


@pytest.fixture
def run(unzipped, tmp_path):
    """Run Python elsewhere, with the unzipped wheel first on its path."""

    def run(*arguments):
        environment = os.environ | {"PYTHONPATH": str(unzipped)}
        return output_of([sys.executable, *arguments], cwd=tmp_path, env=environment)

    return run


def sources(folder):
    return {
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*.py")
        if "__pycache__" not in path.parts
    }


@pytest.mark.parametrize(
    ("room", "place"),
    [("src/desaxe", "desaxe"), ("derive", "desaxe/derive"), ("generated", "desaxe/generated")],
)
def test_every_source_is_in_it(unzipped, room, place):
    assert sources(ROOT / room) <= sources(unzipped / place)


def test_the_data_is_in_it(unzipped):
    assert (unzipped / "desaxe" / "py.typed").is_file()
    page = {path.name for path in (ROOT / "src/desaxe/scenes/explorer/page").iterdir()}
    assert page == {path.name for path in (unzipped / "desaxe/scenes/explorer/page").iterdir()}


def test_nothing_else_is_in_it(unzipped):
    assert sorted(path.name.partition("-")[0] for path in unzipped.iterdir()) == ["desaxe", "desaxe"]


def test_the_licence_is_in_it(unzipped):
    assert [path.read_text() for path in unzipped.glob("*.dist-info/licenses/LICENSE")] == [
        (ROOT / "LICENSE").read_text()
    ]


def test_it_evaluates_a_point(run, unzipped):
    call = "desaxe.evaluate('V_B', theta=0.0, AB=0.5, omega0=-4.0)"
    where, answer = run("-c", f"import desaxe; print(desaxe.__file__, {call})").split()
    assert Path(where).is_relative_to(unzipped)
    assert float(answer) == 2.0
