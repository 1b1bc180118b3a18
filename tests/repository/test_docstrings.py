"""Docstrings that a stranger understands from the first line alone."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ROOMS = ("src/desaxe", "derive", "benchmarks", "tests")
# A first line names what is done or returned: "True if ...", "The number of ...", "Merge two ...".
VAGUE = re.compile(
    r"(Whether|What|Those|The same|Who|Where|How|Which|As|All of (it|them)|All that|Of|Its|They|It|So many)\b"
)
# Everyday words for which the field has a term: returned, requested, n or `count`, undecided, wide margin.
HOME_MADE = re.compile(
    r"\b(told|wanted|so many|somebody|nobody|hangs? on|roomy|last bits?|next to nothing)\b"
)


def first_lines(path):
    """Line number and first line of every docstring of a file, those of test functions left out."""
    kinds = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, kinds) and not getattr(node, "name", "").startswith("test_"):
            text = ast.get_docstring(node)
            if text:
                yield node.body[0].lineno, text.splitlines()[0]


@pytest.mark.parametrize("room", ROOMS)
def test_first_lines_say_what_a_function_does(room):
    vague = [
        f"{path.relative_to(ROOT)}:{number}: {line}"
        for path in sorted((ROOT / room).rglob("*.py"))
        for number, line in first_lines(path)
        if VAGUE.match(line) or HOME_MADE.search(line)
    ]
    assert not vague, "\n".join(vague)


@pytest.mark.parametrize("room", ["src/desaxe", "derive", "benchmarks"])
def test_every_room_lists_its_files(room):
    missing = []
    for init in sorted((ROOT / room).rglob("__init__.py")):
        folder = init.parent
        text = ast.get_docstring(ast.parse(init.read_text(encoding="utf-8"))) or ""
        listed = set(re.findall(r"\w+", text))
        files = {path.stem for path in folder.glob("*.py")} - {"__init__", "__main__"}
        rooms = {path.parent.name for path in folder.glob("*/__init__.py")}
        if folder.name != "desaxe":  # README lists its rooms, in the order of their floors
            missing += [f"{folder.relative_to(ROOT)}: {name}" for name in sorted((files | rooms) - listed)]
    assert not missing


def test_readme_lists_every_room():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    rooms = sorted(path.parent.name for path in (ROOT / "src" / "desaxe").glob("*/__init__.py"))
    assert [room for room in rooms if f"{room}/ " not in readme] == []
