"""The builder of text: a module has all that its parts call, from real files, and nothing else."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import desaxe
from desaxe.compiler.builder import HELPERS, module_text, source_of, with_sources
from desaxe.compiler.languages.numba.library import SOURCES
from desaxe.scenes.export.numba_module import FUNCTIONS, STEPS

SOURCE = '''"""Some functions."""

from __future__ import annotations

from math import cos, pi, sin
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Any

    def given(x: Any) -> float:
        """What a Program gives."""


# Half a turn.
HALF, WHOLE = pi, 2.0 * pi


def unused(x: float) -> float:
    """Nobody calls it."""
    return cos(x)


def wave(x: Any, of: Any) -> float:
    """It calls its argument."""
    return of(HALF * given(x))


def both(
    x: float,
) -> float:
    """It gives a function by keyword; unused(x) and sinh stand in words only."""
    return wave(x, of=shape)  # unused(x)


def shape(x: float) -> float:
    """A sine."""
    return sin(x)
'''
GIVEN = "def given(x):\n    return x + 0.5\n"


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "some.py"
    path.write_text(SOURCE)
    return path


def defined(text):
    """The names that a text defines, in order."""
    body = ast.parse(text).body
    names = [[node.name] if isinstance(node, ast.FunctionDef) else ast.unparse(node) for node in body]
    return [name for each in names if isinstance(each, list) for name in each]


def test_what_a_part_needs_goes_along_and_nothing_else(file):
    text = module_text("A module.", with_sources([GIVEN, "answer = both(1.0)"], [file]))
    assert defined(text) == ["wave", "both", "shape", "given"]
    assert "# Half a turn.\nHALF, WHOLE = pi, 2.0 * pi\n" in text
    assert "cos" not in text
    scope = {}
    exec(text, scope)
    assert scope["answer"] == -1.0


def test_the_first_file_that_has_a_name_gives_it(file, tmp_path):
    other = tmp_path / "other.py"
    other.write_text('"""Another."""\n\n\ndef shape(x):\n    """Ten."""\n    return 10.0\n')
    scope = {}
    exec(module_text("A module.", with_sources([GIVEN, "answer = both(1.0)"], [other, file])), scope)
    assert scope["answer"] == 10.0


def test_a_decorator_goes_before_functions_of_files_alone(file):
    text = module_text("A module.", with_sources([GIVEN, "f = both.py_func"], [file], "@jit\n"))
    assert text.count("@jit\ndef ") == 3
    assert "@jit\ndef given" not in text


def test_what_a_decorator_is_called_is_imported(file):
    group = with_sources([GIVEN, "f = both.py_func"], [file], "@njit()\n", {"njit": "numba"})
    assert "from numba import njit\n" in module_text("A module.", group)


def test_a_text_that_two_groups_have_stands_once(file):
    group = with_sources([GIVEN, "answer = both(1.0)"], [file])
    assert module_text("A module.", group, group) == module_text("A module.", group)


@pytest.mark.parametrize("path", [SOURCES, FUNCTIONS, STEPS], ids=lambda path: path.name)
def test_no_statement_of_a_file_is_lost(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    kept = [node for node in tree.body if not isinstance(node, (ast.ImportFrom, ast.If, ast.Expr))]
    result = ast.parse("\n".join(each.text for each in source_of(path).statements)).body
    assert list(map(ast.dump, result)) == list(map(ast.dump, kept))


@pytest.mark.parametrize("path", [SOURCES, FUNCTIONS, STEPS], ids=lambda path: path.name)
def test_a_source_can_be_imported_as_it_stands(path):
    package = Path(desaxe.__file__).parent
    module = ".".join(("desaxe", *path.relative_to(package).with_suffix("").parts))
    command = [sys.executable, "-W", "error", "-c", f"import {module}"]
    assert subprocess.run(command, check=False).returncode == 0


def test_helpers_are_plain_python():
    assert set(source_of(HELPERS).imports.values()) == {"math", "typing"}  # the latter for annotations
