"""The Program: a frozen, ordered list of single assignments, the heart of the compiler.

Each line assigns one name once, by one operation of the table, from inputs, constants or names
assigned before it. Lines that carry a `Note` are named intermediates: they know their unit, what
they mean and which paper equation they are. The others are temporaries `t0, t1, ...`.

Canonical form, which every pass may assume and must keep (`validate`):
  * every name is assigned once, before it is used, and is no input;
  * every operation is in the table, with its number and types of arguments;
  * every line is reached from an output.
A constant is a Python float (f64), int (i64) or bool; or a TableName, whose content no Program knows.
"""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from . import helpers
from .operations import MATH_NAMES, OPERATIONS, result_type


class TableName(NamedTuple):
    """A table, by its name."""

    name: str

    def __repr__(self) -> str:
        return self.name


Argument = str | float | int | bool | TableName
RESERVED = frozenset((*vars(helpers), *MATH_NAMES))


class Note(NamedTuple):
    """Unit, meaning and source of a named line."""

    unit: str
    meaning: str
    source: str = ""


class Line(NamedTuple):
    """One assignment: ``name = op(*args)``, of a type (f64, i64, bool)."""

    name: str
    op: str
    args: tuple[Argument, ...]
    type: str = "f64"


class Program(NamedTuple):
    """Inputs, lines and outputs; the module's docstring has the invariants."""

    inputs: tuple[str, ...]
    lines: tuple[Line, ...]
    outputs: tuple[str, ...]
    notes: Mapping[str, Note]


class ProgramError(ValueError):
    """A Program that breaks its canonical form; the message names the line."""


def type_of(argument: Argument, types: Mapping[str, str]) -> str:
    """The type of an argument, given those of the names in scope."""
    if isinstance(argument, str):
        return types[argument]
    if isinstance(argument, bool):
        return "bool"
    if isinstance(argument, TableName):
        return "table"
    return "i64" if isinstance(argument, int) else "f64"


def number(argument: Argument) -> float | int:
    """The constant that an argument is; ProgramError for a name or a table."""
    if isinstance(argument, (str, TableName)):
        raise ProgramError(f"{argument} is no number")
    return argument


def names_in(arguments: Iterable[Argument]) -> list[str]:
    """The arguments that are names, in order."""
    return [argument for argument in arguments if isinstance(argument, str)]


def validate(program: Program) -> Program:
    """Return the program, or raise ProgramError naming the line that breaks the canonical form."""
    types = dict.fromkeys(program.inputs, "f64")
    for line in program.lines:
        _validate_line(line, types)
        types[line.name] = line.type
    for output in program.outputs:
        if output not in types:
            raise ProgramError(f"output {output!r} is never assigned")
    requested = reached(program)
    unused = [line.name for line in program.lines if line.name not in requested]
    if unused:
        raise ProgramError(f"unused lines: {', '.join(unused)}")
    return program


def _validate_line(line: Line, types: Mapping[str, str]) -> None:
    operation = OPERATIONS.get(line.op)
    if line.name in types:
        raise ProgramError(f"{line.name!r} is assigned twice")
    if line.name in RESERVED:
        raise ProgramError(f"{line.name!r} is the name of a function that a program calls")
    if operation is None:
        raise ProgramError(f"{line.name!r}: unknown operation {line.op!r}")
    if len(line.args) != operation.arity:
        raise ProgramError(
            f"{line.name!r}: {line.op} takes {operation.arity} arguments, got {len(line.args)}"
        )
    for name in names_in(line.args):
        if name not in types:
            raise ProgramError(f"{line.name!r} uses {name!r} before it is assigned")
    try:
        result = result_type(operation, tuple(type_of(argument, types) for argument in line.args))
    except TypeError as error:
        raise ProgramError(f"{line.name!r}: {error}") from None
    if result != line.type:
        raise ProgramError(f"{line.name!r} is {line.type}, but {line.op} gives {result}")


def tables_in(program: Program) -> list[str]:
    """The tables that a program looks into, by name, in order."""
    every = (a.name for line in program.lines for a in line.args if isinstance(a, TableName))
    return list(dict.fromkeys(every))


def reached(program: Program) -> set[str]:
    """The names that the outputs depend on, themselves included."""
    requested = set(program.outputs)
    for line in reversed(program.lines):
        if line.name in requested:
            requested.update(names_in(line.args))
    return requested


def reaching(lines: tuple[Line, ...], outputs: Iterable[str]) -> tuple[Line, ...]:
    """The lines that the outputs need."""
    requested = set(outputs)
    for line in reversed(lines):
        if line.name in requested:
            requested.update(names_in(line.args))
    return tuple(line for line in lines if line.name in requested)


def renamed_temporaries(program: Program, order: Iterable[str]) -> Program:
    """Rename the temporaries of a program to t0, t1, ... in this order."""
    keep = set(program.inputs) | set(program.outputs) | set(program.notes)
    temporaries = [name for name in order if name not in keep]
    return renamed(program, {name: f"t{position}" for position, name in enumerate(temporaries)})


def renamed(program: Program, names: Mapping[str, str]) -> Program:
    """Rename lines of a program."""
    lines = tuple(
        Line(
            names.get(line.name, line.name),
            line.op,
            tuple(names.get(a, a) if isinstance(a, str) else a for a in line.args),
            line.type,
        )
        for line in program.lines
    )
    return program._replace(lines=lines)
