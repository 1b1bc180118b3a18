"""The interface of a language: the Module that it writes, and the class that it is.

A `Module` says all that the emitters may know: names and units of arguments and results, Programs, and
constants. It knows no mechanism. A language turns it into the texts of one or more files.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ..builder import Parts
from ..operations import Content
from ..passes.trigonometry import Trigonometry
from ..program import Program


class Symbol(NamedTuple):
    """An argument or result with its unit, meaning and source, for comments and tables."""

    name: str
    unit: str
    meaning: str
    source: str = ""


class Forms(NamedTuple):
    """The outputs in one or two forms, and the test that selects the form.

    `stable` holds everywhere. `plain` needs fewer operations and holds where `test`, a Program with one
    output, a condition, says so. All inputs are arguments of the module; its outputs come first, then the
    status, if it is none of them. `status` is the status's index, -1 without one. Where `rounded`, sums and
    products are rounded as they stand, which twice the digits need.
    """

    status: int
    stable: Program
    plain: Program | None = None
    test: Program | None = None
    rounded: bool = False


class Solver(NamedTuple):
    """A solver function: `solve` computes the unknowns, `slopes` their derivatives.

    `arguments` come ahead of the module's own arguments; `solve` and `slopes` take arguments of both.
    """

    arguments: tuple[Symbol, ...]
    solve: Program
    slopes: Program | None = None


class Module(NamedTuple):
    """The content of a module, independent of the language.

    head         lines of the opening comment: what it is, how it was made, from which digest
    inputs       arguments, in order
    outputs      results, in order
    forms        the Programs of the results, and of the status
    derivatives  name of a result or derivative -> argument -> the name of its derivative
    values       Programs of all names that stand in `derivatives`, under their names
    solvers      further functions by name, for languages that take them
    arguments    name of a result -> the arguments of its own function, where these are not all
    motion       an acceleration and its status, for languages that take it: of a force, a position, a speed,
                 arguments, and the sign of the speed, which only friction takes
    constants    of the written-out sine and cosine; beyond their limit they are wrong
    tables       name -> knots and coefficients of a table that Programs look into
    groups       results in their order, those together that one function of JavaScript computes; else all are

    Of Python that people import (numba):

    what         the results in words
    angle        an input of which Programs take sine and cosine, which an array has computed ahead
    fixed        inputs of the Programs that callers do not give: numbers
    defaults     input -> the text of its default
    centres      input -> the input of which it is half by default
    functions    whether each result has a function of its own, too
    more         further functions
    uses         lines on these, for the opening comment
    """

    name: str
    head: tuple[str, ...]
    inputs: tuple[Symbol, ...]
    outputs: tuple[Symbol, ...]
    forms: Forms
    constants: Trigonometry
    derivatives: Mapping[str, Mapping[str, str]] = {}
    values: Mapping[str, Program] = {}
    solvers: Mapping[str, Solver] = {}
    arguments: Mapping[str, Sequence[str]] = {}
    motion: Solver | None = None
    tables: Mapping[str, Content] = {}
    groups: Sequence[Sequence[str]] = ()
    what: str = "the results"
    angle: str = ""
    fixed: Mapping[str, float] = {}
    defaults: Mapping[str, str] = {}
    centres: Mapping[str, str] = {}
    functions: bool = True
    more: Parts | None = None
    uses: tuple[str, ...] = ()

    def taken(self, name: str) -> list[str]:
        """The arguments of a result's own function, in order."""
        own = self.arguments.get(name)
        return [symbol.name for symbol in self.inputs if own is None or symbol.name in own]


class Language(ABC):
    """A language: writes a Module as source files; what it can besides, most cannot."""

    name: str
    suffix: str  # of the file that is called
    about: str  # what is written, for `desaxe compile --help`
    second_order = False  # whether `derivatives` and `values` are wanted
    steps = False  # whether `motion` is wanted
    extended = True  # whether sums and products are rounded as they stand, which twice the digits want
    only_file = False  # whether a path is always that of the file

    @abstractmethod
    def files(self, module: Module) -> dict[str, str]:
        """File name -> text."""
