"""Imports point one way: down the floors of the library; derive and generated have rules of their own.

Read from the source text, so that an import inside a function counts too.
"""

import ast
import re
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
    result = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            result |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = package.rsplit(".", node.level - 1)[0] if node.level > 1 else package
            start = ".".join(part for part in ((base if node.level else ""), node.module) if part)
            result |= {f"{start}.{alias.name}" for alias in node.names}
    return result


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


def test_generated_imports_numpy_numba_and_the_standard_library_only():
    assert not [
        pair
        for pair in imports_of("desaxe.generated")
        if not is_in(
            pair[1], "math", "os", "inspect", "concurrent", "numpy", "numba", "desaxe.generated._helpers"
        )
    ]


# A room imports rooms of lower floors only; `support` is open to all.
FLOORS = {
    "support": 0,
    "compiler": 1,
    "oracle": 1,
    "units": 2,
    "mechanism": 3,
    "loads": 4,
    "definitions": 4,
    "runtime": 4,
    "evaluation": 5,
    "enclosure": 6,
    "peaks": 6,
    "plot": 6,
    "simulation": 7,
    "sweeps": 8,
    "design": 8,
    "crankshaft": 9,
    "scenes": 10,
    "machine": 11,
    "cli": 12,
}
CLOSED = {
    "compiler": {"support"},
    "units": {"support"},
    "mechanism": {"compiler", "support", "units"},
    "oracle": set(),
}
BELOW_DERIVE = {"compiler", "mechanism", "support", "units"}


def room_of(name):
    """The room of a module of the library, "" for the package itself."""
    return name.split(".")[1] if name.count(".") else ""


def arrows():
    """Each import of one module of the library by another: (importing module, imported name)."""
    for module, name in imports_of("desaxe"):
        if is_in(name, "desaxe") and module not in ("desaxe", "desaxe.__main__", "desaxe.typed"):
            yield module, name


def test_every_room_has_its_floor():
    rooms = {path.parent.name for path in ROOMS["desaxe"].glob("*/__init__.py")}
    assert rooms <= set(FLOORS)


def test_the_readme_has_the_floors():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    rows = re.findall(r"^  (\w+)/ +(\d+)  \S", text, re.MULTILINE)
    assert {room: int(floor) for room, floor in rows} == FLOORS


def test_a_room_imports_lower_floors_only():
    wrong = []
    for module, name in arrows():
        room, other = room_of(module), room_of(name)
        if room == other or other in ("generated", "derive"):
            continue
        if other not in FLOORS or FLOORS[other] >= FLOORS[room] or other not in CLOSED.get(room, FLOORS):
            wrong.append((module, name))
    assert not wrong


def test_there_is_no_circle_of_modules():
    """Imports inside functions count too."""
    known = {module for module, _ in modules("desaxe")}
    graph = {module: set() for module in known}
    for module, name in arrows():
        other = name if name in known else name.rpartition(".")[0]
        graph[module] |= {other} & known - {module}
    while graph:
        leaves = {module for module, others in graph.items() if not others}
        assert leaves, f"a circle among {sorted(graph)}"
        graph = {module: others - leaves for module, others in graph.items() if module not in leaves}


def test_the_compiler_imports_nothing_that_must_be_installed_but_llvmlite():
    pairs = [pair for pair in imports_of("desaxe", inside="desaxe.compiler") if not is_in(pair[0], *COPIED)]
    others = {pair for pair in pairs if not (is_standard(pair[1]) or is_in(pair[1], "desaxe"))}
    assert others == {("desaxe.compiler.llvm.machine", "llvmlite.binding")}


# Sources of functions whose text goes into numba modules: they are read, never imported.
COPIED = ("desaxe.compiler.languages.numba.sources",)


def test_nobody_imports_what_is_copied():
    assert not [pair for pair in imports_of("desaxe") if is_in(pair[1], *COPIED)]


def test_derive_imports_compiler_mechanism_and_support_only():
    own = {path.stem for path in ROOMS["desaxe.derive"].glob("*.py")}
    pairs = [pair for pair in imports_of("desaxe.derive") if is_in(pair[1], "desaxe")]
    assert pairs
    assert {room_of(name) for _, name in pairs} <= {*BELOW_DERIVE, "derive", "generated"}, own


def test_the_compiler_and_the_ground_do_not_know_the_mechanism():
    """No symbol of the slider-crank in their code; comments and docstrings may give examples."""
    words = {"ec", "AB", "BC", "omega0", "theta", "a_C", "V_C", "T_in", "N_C", "m_rod", "m_slider"}
    result = set()
    for room in ("compiler", "support"):
        for _, path in modules("desaxe"):
            if path.is_relative_to(ROOMS["desaxe"] / room):
                for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                    said = (
                        getattr(node, "id", None) or getattr(node, "arg", None) or getattr(node, "attr", None)
                    )
                    if isinstance(node, ast.Constant) and isinstance(node.value, str):
                        said = node.value
                    if said in words:
                        result.add((path.name, said))
    assert not result


def test_the_oracle_shares_nothing_with_what_it_judges():
    pairs = list(imports_of("desaxe", inside="desaxe.oracle"))
    assert {room_of(name) for _, name in pairs if is_in(name, "desaxe")} == {"oracle"}
    others = [name for _, name in pairs if not is_in(name, "desaxe.oracle")]
    assert not [name for name in others if not (is_standard(name) or is_in(name, "mpmath", "flint"))]


@pytest.mark.parametrize(
    "name",
    [
        "evaluation.evaluate",
        "evaluation.values",
        "mechanism.program",
        "mechanism.catalogue",
        "mechanism.inputs",
        "support.extras",
    ],
)
def test_what_one_point_loads_imports_the_standard_library_and_its_own_kind(name):
    path = ROOMS["desaxe"].joinpath(*name.split(".")).with_suffix(".py")
    tree = ast.parse(path.read_text(encoding="utf-8"))
    at_top = [node for node in tree.body if isinstance(node, (ast.Import, ast.ImportFrom))]
    result = imported("\n".join(map(ast.unparse, at_top)), f"desaxe.{name}", is_package=False)
    assert not [other for other in result if not (is_standard(other) or is_in(other, "desaxe"))]
    assert not [
        other
        for other in result
        if is_in(other, "desaxe.evaluation.arrays", "desaxe.runtime.kernels", "desaxe.units.pint_units")
    ]


@pytest.mark.parametrize(
    ("source", "names"),
    [
        ("import sympy as sp", {"sympy"}),
        ("def f():\n    from sympy import sin, cos", {"sympy.sin", "sympy.cos"}),
        ("from . import loop", {"desaxe.compiler.loop"}),
        ("from .text import INDENT", {"desaxe.compiler.text.INDENT"}),
        ("from ..mechanism.inputs import LEAST", {"desaxe.mechanism.inputs.LEAST"}),
        ("if x:\n    import numpy.linalg", {"numpy.linalg"}),
    ],
)
def test_the_check_sees_an_import(source, names):
    assert imported(source, "desaxe.compiler.kernel", is_package=False) == names


def test_the_check_knows_a_package():
    assert imported("from .passes import fold", "desaxe.compiler", is_package=True) == {
        "desaxe.compiler.passes.fold"
    }


def test_rooms_of_scenes_are_small_and_no_name_stands_in_five_rooms():
    scenes = ROOMS["desaxe"] / "scenes"
    sizes = {room: len(list(room.glob("*.py"))) for room in (scenes, *scenes.rglob("*")) if room.is_dir()}
    assert {room.name for room, size in sizes.items() if size > 14} == set()
    named = [(path.name, path.parent) for _, path in modules("desaxe") if path.name != "__init__.py"]
    rooms = {name: {room for other, room in named if other == name} for name, _ in named}
    assert [name for name, places in rooms.items() if len(places) > 4] == []
