"""Imports point one way: derive -> compiler, library -> compiler, generated -> math, numpy, numba.

Read from the source text, so that an import inside a function counts too.
"""

import ast
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ROOMS = {
    "desaxe": ROOT / "src" / "desaxe",
    "desaxe.derive": ROOT / "derive",
    "desaxe.generated": ROOT / "generated",
}


def imported(source, module, is_package):
    """The modules that the text of a module imports, relative ones by their full names."""
    package = module if is_package else module.rpartition(".")[0]
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = package.rsplit(".", node.level - 1)[0] if node.level > 1 else package
            start = ".".join(part for part in ((base if node.level else ""), node.module) if part)
            found |= {f"{start}.{alias.name}" for alias in node.names}
    return found


def modules(room):
    """Every module of a room: its name, its path."""
    for path in sorted(ROOMS[room].rglob("*.py")):
        parts = path.relative_to(ROOMS[room]).with_suffix("").parts
        yield ".".join((room, *(part for part in parts if part != "__init__"))), path


def imports_of(room, inside=""):
    """Each import of each module of a room: (importing module, imported name)."""
    for module, path in modules(room):
        if module.startswith(inside):
            for name in imported(path.read_text(encoding="utf-8"), module, path.name == "__init__.py"):
                yield module, name


def is_in(name, *rooms):
    return any(name == room or name.startswith(f"{room}.") for room in rooms)


def is_standard(name):
    return name.partition(".")[0] in sys.stdlib_module_names


@pytest.mark.parametrize("room", ["desaxe", "desaxe.generated"])
def test_sympy_and_the_derivation_are_imported_by_derive_alone(room):
    assert not [pair for pair in imports_of(room) if is_in(pair[1], "sympy", "derive", "desaxe.derive")]


def test_generated_imports_only_math_numpy_and_numba():
    assert not [
        pair for pair in imports_of("desaxe.generated") if not is_in(pair[1], "math", "numpy", "numba")
    ]


def test_the_compiler_imports_nothing_above_it_and_nothing_that_must_be_installed():
    pairs = imports_of("desaxe", inside="desaxe.compiler")
    assert not [pair for pair in pairs if not (is_standard(pair[1]) or is_in(pair[1], "desaxe.compiler"))]


def test_the_oracle_shares_nothing_with_what_it_judges():
    """Only with the other two files of it."""
    rooms = [f"desaxe.audit.{name}" for name in ("jet", "truth", "force_truth")]
    pairs = [pair for pair in imports_of("desaxe", inside="desaxe.audit") if pair[0] in rooms]
    assert {pair[0] for pair in pairs} == set(rooms)
    assert not [
        pair for pair in pairs if not (is_standard(pair[1]) or is_in(pair[1], "mpmath", "flint", *rooms))
    ]


def test_families_are_drawn_without_a_look_at_the_package():
    pairs = [pair for pair in imports_of("desaxe") if pair[0] == "desaxe.audit.families"]
    assert pairs
    assert not [pair for pair in pairs if not (is_standard(pair[1]) or is_in(pair[1], "mpmath"))]


@pytest.mark.parametrize("name", ["_evaluate", "_program", "catalogue", "inputs", "extras"])
def test_what_one_point_loads_imports_the_standard_library_and_its_own_kind(name):
    tree = ast.parse((ROOMS["desaxe"] / f"{name}.py").read_text(encoding="utf-8"))
    at_top = [node for node in tree.body if isinstance(node, (ast.Import, ast.ImportFrom))]
    found = imported("\n".join(map(ast.unparse, at_top)), f"desaxe.{name}", is_package=False)
    assert not [other for other in found if not (is_standard(other) or is_in(other, "desaxe"))]
    assert not [other for other in found if is_in(other, "desaxe._arrays", "desaxe._kernels", "desaxe.units")]


@pytest.mark.parametrize(
    ("source", "names"),
    [
        ("import sympy as sp", {"sympy"}),
        ("def f():\n    from sympy import sin, cos", {"sympy.sin", "sympy.cos"}),
        ("from . import loop", {"desaxe.compiler.loop"}),
        ("from .text import INDENT", {"desaxe.compiler.text.INDENT"}),
        ("from ..inputs import LEAST", {"desaxe.inputs.LEAST"}),
        ("if x:\n    import numpy.linalg", {"numpy.linalg"}),
    ],
)
def test_the_check_sees_an_import(source, names):
    assert imported(source, "desaxe.compiler.kernel", is_package=False) == names


def test_the_check_knows_a_package():
    assert imported("from .passes import fold", "desaxe.compiler", is_package=True) == {
        "desaxe.compiler.passes.fold"
    }
