"""The one builder of Python text: the parts of a module, what they call, and the imports of both.

What a part calls is a function or constant at the top of a real file, whose text goes along: a module stands
alone, for numba's cache does not see changes in another file. A file may use names that it does not define,
such as functions that are written from a Program. Those are parts, and the file declares them under
`TYPE_CHECKING`: as arguments they would be typed as dispatchers, which no explicit signature names.
"""

import re
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from textwrap import wrap
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

from .operations import MATH_NAMES
from .text import INDENT, WIDTH

HELPERS = Path(__file__).with_name("helpers.py")  # in plain Python, what spellings call
MATH = dict.fromkeys(MATH_NAMES, "math")
_FUTURE = "from __future__ import annotations"
_STANDARD = ("concurrent.futures", "inspect", "math", "os", "threading", "typing")
_IMPORT = re.compile(r"^(?: {4})?from ([^.\s]\S*) import (?:\(([^)]*)\)|(.*))$", re.MULTILINE)
# A function with its decorators, or an assignment; comments above go with it.
_STATEMENT = re.compile(
    r"(?:^[#@].*\n)*^(?!from )(def )?(\w[\w, ]*)(?:\(| = |: ).*\n(?:[ )\]}].*\n|\n(?=[ \n]))*", re.MULTILINE
)
_SILENT = re.compile(r'""".*?"""|#[^\n]*', re.DOTALL)
_WORD = re.compile(r"[.=@]?[^\W\d]\w*(?:\(|\.py_func)?")
_ASKED = ("{}(", "={}", "@{}", "{}.py_func")


class Statement(NamedTuple):
    """A function or assignment at the top of a file; `words` stand in it."""

    names: tuple[str, ...]
    function: bool
    text: str
    words: frozenset[str]

    @property
    def keys(self) -> list[str]:
        """The words that ask for it: a function is called, given by keyword, a decorator, or plain Python."""
        asked = [key.format(name) for name in self.names for key in _ASKED]
        return asked if self.function else [*asked, *self.names]


class Source(NamedTuple):
    """A file: its statements but for imports, and the module of each name that it imports."""

    statements: tuple[Statement, ...]
    imports: Mapping[str, str]


class Parts(NamedTuple):
    """Texts of a module, the words that stand in them, and the module of each name that they may import."""

    texts: tuple[str, ...]
    words: frozenset[str]
    imports: Mapping[str, str]


@cache
def source_of(file: Path) -> Source:
    """The statements and imports of a file; what it declares for type checkers alone is left out."""
    _, _, code = file.read_text(encoding="utf-8").split('"""', 2)
    imports = {
        name: module
        for module, wrapped, names in _IMPORT.findall(code)
        for name in (wrapped or names).replace(",", " ").split()
    }
    return Source(tuple(map(_statement, _STATEMENT.finditer(code))), imports)


def _statement(result: re.Match[str]) -> Statement:
    return Statement(
        tuple(result[2].split(", ")), bool(result[1]), result[0].strip("\n"), words_of(result[0])
    )


def functions_of(file: Path) -> dict[str, str]:
    """The text of each function of a file."""
    return {each.names[0]: each.text for each in source_of(file).statements if each.function}


def words_of(text: str) -> frozenset[str]:
    """The words of a text outside of docstrings and comments, with what shows how they are used."""
    return frozenset(_WORD.findall(_SILENT.sub("", text)))


def with_sources(
    parts: Sequence[str],
    files: Sequence[Path] = (HELPERS,),
    jit: str = "",
    imports: Mapping[str, str] = MATH,
) -> Parts:
    """The parts, behind what they need of files, which is taken from the first file that has it.

    jit       goes before functions of the last file
    imports   the module of names that the parts themselves use
    """
    sources = [source_of(file) for file in files]
    known: dict[str, Statement] = {}
    for statement in (each for source in sources for each in source.statements):
        for key in statement.keys:
            known.setdefault(key, statement)
    words = frozenset[str]().union(*map(words_of, parts))
    needed: set[Statement] = set()
    left = [words]
    while left:
        more = {known[key] for key in known.keys() & left.pop()} - needed
        needed |= more
        left += [statement.words for statement in more]
    chosen = [statement for statement in dict.fromkeys(known.values()) if statement in needed]
    bare = {each for each in chosen if each.function and each in sources[-1].statements}
    texts = [jit + each.text if each in bare else each.text for each in chosen]
    words = words.union(words_of(jit) if jit and bare else (), *(each.words for each in chosen))
    modules = {name: module for source in sources for name, module in source.imports.items()}
    return Parts((*texts, *parts), words, modules | dict(imports))


def function_text(name: str, parameters: Sequence[str], body: Sequence[str]) -> str:
    """The text of a function."""
    head = [f"def {name}({', '.join(parameters)}):"]
    if len(head[0]) > WIDTH:
        head = [f"def {name}(", *(INDENT + row for row in wrap(", ".join(parameters) + ",", WIDTH)), "):"]
    return "\n".join([*head, *(INDENT + row if row else "" for row in body)]) + "\n"


def quoted(value: object) -> str:
    """A constant as text, in double quotes."""
    return repr(value).replace("'", '"')


def rebound(module: ModuleType, scope: Mapping[str, Any]) -> dict[str, Any]:
    """The names of a module, with those of `scope` in their places, for its functions, too."""
    names = vars(module) | dict(scope)
    for name, one in vars(module).items():
        if isinstance(one, FunctionType) and name not in scope:
            names[name] = FunctionType(one.__code__, names, name, one.__defaults__)
    return names


def module_text(docstring: str, *groups: Parts) -> str:
    """The text of a module: docstring, imports, and all parts, each text once."""
    modules = {name: module for group in groups for name, module in group.imports.items()}
    words = {word.strip("=@(") for group in groups for word in group.words}
    names: dict[str, list[str]] = {}
    for name in sorted(words & modules.keys()):
        names.setdefault(modules[name], []).append(name)
    kinds = {module: 2 if module.startswith(".") else module not in _STANDARD for module in sorted(names)}
    blocks = [[_import(m, names[m]) for m, own in kinds.items() if own == kind] for kind in range(3)]
    texts = dict.fromkeys(text.strip("\n") for group in groups for text in group.texts)
    future = [_FUTURE] if "Any" in words else []
    head = [f'"""{docstring}"""', *("\n".join(block) for block in (future, *blocks) if block)]
    rows = ["\n\n".join(head)]
    for before, text in zip(["def", *texts], texts, strict=False):
        rows.append("\n" if _is_constant(before) and _is_constant(text) else "\n\n\n")
        rows.append(text)
    return "".join(rows) + "\n"


def _is_constant(text: str) -> bool:
    return not text.startswith(("def", "@", "#"))


def _import(module: str, names: Sequence[str]) -> str:
    line = f"from {module} import {', '.join(names)}"
    if len(line) <= WIDTH:
        return line
    rows = wrap(", ".join(names) + ",", WIDTH - len(INDENT))
    return "\n".join([f"from {module} import (", *(INDENT + row for row in rows), ")"])
