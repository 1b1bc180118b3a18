"""Shared by the emitters: statements in a column's spelling, safe names, comment text."""

import ast
import builtins
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from textwrap import wrap
from typing import NamedTuple

from ..operations import Content
from ..program import Program, renamed
from ..text import with_short_temporaries, write_lines
from .protocol import Module, Symbol
from .words import words_of

_WORD = re.compile(r"\b(nan|inf|True|False)\b")


class Spelling(NamedTuple):
    """The text of an assignment in a language, what follows it as a comment, and the words of constants."""

    column: str  # of the operation table
    statement: str
    note: str
    words: Mapping[str, str] = {}
    kinds: tuple[str, str] = ("", "")  # of a double, and of any other value

    @property
    def reserved(self) -> frozenset[str]:
        """Words that no name can be; it gets an underscore."""
        return words_of(self.column).lines

    def safe(self, name: str) -> str:
        """A name that the language has not for itself."""
        return safe_name(name, self.reserved)

    def statements(self, program: Program) -> list[str]:
        """The assignments of a program as statements, under safe names."""
        program = with_safe_names(with_short_temporaries(program), self.reserved)
        types, rows = types_of(program), []
        for line in write_lines(program, self.column):
            assignment, _, note = line.partition("  # ")
            name, _, right = assignment.partition(" = ")
            right = _WORD.sub(lambda match: self.words.get(match[1], match[1]), right)
            kind = self.kinds[types[name] != "f64"]
            comment = self.note.format(one_line(note)) if note else ""
            rows.append(self.statement.format(kind=kind, name=name, right=right) + comment)
        return rows


def safe_name(name: str, reserved: Collection[str]) -> str:
    """A name with an underscore if the language keeps it for itself."""
    return f"{name}_" if name in reserved else name


def with_safe_names(program: Program, reserved: Collection[str]) -> Program:
    """The program with an underscore after each name that the language keeps for itself."""
    names = [*program.inputs, *(line.name for line in program.lines)]
    safe = {name: safe_name(name, reserved) for name in names if name in reserved}
    if not safe:
        return program
    program = renamed(program, safe)
    notes = {safe.get(name, name): note for name, note in program.notes.items()}
    inputs = tuple(safe.get(name, name) for name in program.inputs)
    return program._replace(
        inputs=inputs, outputs=tuple(safe.get(name, name) for name in program.outputs), notes=notes
    )


def refuse_taken(outputs: Iterable[str], taken: Collection[str]) -> None:
    """ValueError for outputs that are words of a language, or would hide what else a module calls so."""
    result = ", ".join(repr(name) for name in outputs if name in taken)
    if result:
        raise ValueError(
            f"outputs: {result}: a word of the module's language, or a name that the module itself has; "
            "give the quantity another name"
        )


def taken_in_python(text: str) -> set[str]:
    """The names that a Python module imports, assigns or defines twice, and the built-in ones in use."""
    tree = ast.parse(text)
    nodes = [*ast.walk(tree)]
    used = {node.id for node in nodes if isinstance(node, ast.Name)} & set(dir(builtins))
    imported = {a.asname or a.name for node in nodes if isinstance(node, ast.ImportFrom) for a in node.names}
    assigned = [t for node in tree.body if isinstance(node, ast.Assign) for t in node.targets]
    defined = [node.name for node in tree.body if isinstance(node, ast.FunctionDef)]
    twice = {name for name in defined if defined.count(name) > 1}
    return used | imported | twice | {target.id for target in assigned if isinstance(target, ast.Name)}


def types_of(program: Program) -> dict[str, str]:
    """The type of every name."""
    return dict.fromkeys(program.inputs, "f64") | {line.name: line.type for line in program.lines}


def called(text: str, names: Iterable[str]) -> list[str]:
    """The functions that a text calls outside of comments, in the order of `names`."""
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    return [name for name in names if re.search(rf"\b{name}\(", code)]


def functions_in(text: str) -> dict[str, str]:
    """Name -> text of each function of a file, a blank line between two."""
    blocks = [f"{block}\n" for block in text.rstrip("\n").split("\n\n")]
    return {_DEFINED.search(block)[1]: block for block in blocks}  # type: ignore[index]


_DEFINED = re.compile(r"^(?:static|function|def)\b.*?(\w+)\(", re.MULTILINE)


def with_helpers(text: str, helpers: Mapping[str, str]) -> list[str]:
    """The sources of the helpers that a text calls, and of those that they call, in their order."""
    requested: set[str] = set()
    stack = [text]
    while stack:
        for name in called(stack.pop(), helpers):
            if name not in requested:
                requested.add(name)
                stack.append(helpers[name].partition("{")[2] or helpers[name].partition("\n")[2])
    return [source for name, source in helpers.items() if name in requested]


def numbers(values: Iterable[float]) -> list[str]:
    """Finite numbers as rows of text."""
    return wrap(", ".join(map(repr, values)), 90)


def arrays_of(tables: Mapping[str, Content]) -> dict[str, Sequence[float]]:
    """The arrays of tables by their names: knots and coefficients."""
    return {
        f"{name}_{end}": column
        for name, table in tables.items()
        for end, column in zip("xc", table, strict=True)
    }


def documented(module: Module, use: Iterable[str]) -> str:
    """The docstring of a Python module: its head, its use, its inputs and outputs."""
    rows = [
        f"  {group:8} {symbol.name} [{symbol.unit}]: {one_line(symbol.meaning)}"
        for group, symbols in (("inputs", module.inputs), ("outputs", module.outputs))
        for symbol in symbols
    ]
    return "\n".join(
        [*map(one_line, module.head), "", *use, "", *rows, "", "SPDX-License-Identifier: MIT", ""]
    )


def comment(lines: Iterable[str]) -> str:
    """A comment of these lines."""

    def row(line: str) -> str:
        indent = line[: len(line) - len(line.lstrip())]
        return f" * {indent}{one_line(line)}".rstrip()

    return "\n".join(["/*", *map(row, lines), " */"])


def described(symbol: Symbol) -> str:
    """The name of a symbol with unit, meaning and source, in a line."""
    source = f" ({symbol.source})" if symbol.source else ""
    return f"{symbol.name} [{symbol.unit}]: {one_line(symbol.meaning)}{source}"


def one_line(text: str) -> str:
    """A text that can stand in a comment of any language."""
    plain = " ".join(text.split()).replace("\\", "/").replace("??", "? ?")
    plain = plain.replace("/*", "/ *").replace("*/", "* /")
    return plain.replace('"""', "'''")
