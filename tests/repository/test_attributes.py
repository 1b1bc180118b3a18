"""git, and those who read its attributes, know what is generated; every file of it is made by `derive`."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from desaxe.derive.write import render
from tests.derive.derived import derivation

ROOT = Path(__file__).resolve().parents[2]
GENERATED = sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "generated").glob("*.py"))


@pytest.fixture(scope="module")
def attribute(tmp_path_factory):
    """The value of an attribute in git, by this repository's .gitattributes alone."""
    folder = tmp_path_factory.mktemp("attributes")
    plain = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    subprocess.run(["git", "init", "--quiet"], cwd=folder, env=plain, check=True)
    shutil.copyfile(ROOT / ".gitattributes", folder / ".gitattributes")

    def ask(name, path):
        command = ["git", "check-attr", name, path]
        answer = subprocess.run(command, cwd=folder, env=plain, capture_output=True, text=True, check=True)
        return answer.stdout.strip().rpartition(": ")[2]

    return ask


@pytest.mark.parametrize("path", GENERATED)
def test_a_generated_file_is_marked(attribute, path):
    assert attribute("linguist-generated", path) == "true"


@pytest.mark.parametrize(
    "path", ["derive/loop.py", "src/desaxe/compiler/text.py", "tests/generated/test_fresh.py"]
)
def test_a_written_file_is_not(attribute, path):
    assert attribute("linguist-generated", path) == "unspecified"


def test_lines_end_alike_everywhere(attribute):
    """So that the bytes of generated/ are the same on every machine."""
    assert attribute("eol", GENERATED[0]) == "lf"


def test_every_generated_file_is_made_by_derive():
    assert [f"generated/{name}" for name in sorted(render(derivation()))] == GENERATED
