"""The lines of user-defined quantities in the Program, with their derivatives.

The chain rule on the lines of the expression, with the derivation's own sensitivities for the names that it
uses. Only where a name has none (a sensitivity, the margin) its lines are differentiated as well. A magnitude
has no derivative at 0 (NaN); at a kink the derivative is that of the side that is taken.
"""

from collections.abc import Iterable, Iterator
from functools import lru_cache
from math import nan
from typing import NamedTuple

from ..compiler.passes.differentiate import RULES as EVERYWHERE
from ..compiler.passes.differentiate import SIGNED, Chain
from ..compiler.passes.pipeline import optimise
from ..compiler.passes.slicing import keep_outputs
from ..compiler.program import Argument, Line, Note, Program, names_in, renamed
from ..compiler.text import ProgramText, write_function
from .names import joined, parts, sensitivity
from .own import LENGTH_OF, Definition, depends, derivative_row, derived_names, leaves

# Begins the name of every line of a definition, and ends that of its value and derivatives: no line of the
# derivation, none that a pass adds and no word of an emitter is called so, whatever a user calls a quantity.
PREFIX, SUFFIX = "own_", "_own"


def line_name(name: str, own: Iterable[Definition]) -> str:
    """The name of the line of a quantity: prefixed for a user-defined one."""
    base, parameters = parts(name)
    is_own = any(definition.name == base for definition in own)
    return joined(f"{PREFIX}{base}{SUFFIX}", parameters) if is_own else name


_SIZE = "-da if a < 0.0 else da if 0.0 < a else nan"
# As for balls, but for the sign, which a double knows.
RULES = {**EVERYWHERE, "abs": _SIZE, "abs_sin": _SIZE, "copysign": SIGNED}


class _Chain(Chain):
    """A chain rule for doubles: the derivative of NaN is NaN."""

    def __init__(self, parameter: str, prefix: str) -> None:
        super().__init__(parameter, RULES, prefix)

    def slope(self, argument: Argument) -> Argument:
        """The derivative of an argument; NaN of NaN."""
        return nan if argument != argument else super().slope(argument)


class Needed(NamedTuple):
    """The lines that user-defined names need from the derivation, and the derivatives it does not have."""

    names: tuple[str, ...]
    slow: tuple[tuple[str, str], ...]  # (name, parameter) of derivatives that the derivation has not


@lru_cache(maxsize=256)
def lines_needed(names: tuple[str, ...], own: tuple[Definition, ...]) -> Needed:
    """The names of the derivation that user-defined names use, with their sensitivities."""
    known = {definition.name: definition for definition in own}
    there = {*derived_names(), *(joined(centre, (length,)) for centre, length in LENGTH_OF.items())}
    needed: dict[str, None] = {}
    slow: dict[tuple[str, str], None] = {}
    for base, parameters in map(parts, names):
        for leaf in leaves((base,), known):
            slopes = {sensitivity(leaf, p): p for p in parameters}
            every = (*slopes, sensitivity(leaf, *parameters))
            needed |= dict.fromkeys([leaf, *(slope for slope in every if slope in there)])
            if leaf in derived_names():
                without = (p for slope, p in slopes.items() if slope not in there and depends(leaf, p))
                slow |= dict.fromkeys((leaf, p) for p in without)
    return Needed(tuple(needed), tuple(slow))


def with_own_lines(base: Program, names: tuple[str, ...], own: tuple[Definition, ...]) -> Program:
    """The program of user-defined names; `base` has the lines of `lines_needed`, in one variant."""
    writer = _Writer(base, own, lines_needed(names, own))
    for name in names:
        writer.add(name)
    used = (a for line in writer.lines for a in names_in(line.args) if a not in writer.known)
    inputs = tuple(dict.fromkeys((*base.inputs, *used)))
    program = Program(inputs, tuple(writer.lines), base.outputs, writer.notes)
    return keep_outputs(program, [line_name(name, own) for name in names])


class _Writer:
    """Appends the values of user-defined quantities and their derivatives, each once."""

    def __init__(self, base: Program, own: tuple[Definition, ...], needed: Needed) -> None:
        self.base, self.own, self.needed = base, own, needed
        self.values = [
            line._replace(args=tuple(line_name(a, own) if isinstance(a, str) else a for a in line.args))
            for definition in own
            for line in _value_lines(definition)
        ]
        self.lines = [*base.lines, *self.values]
        self.notes = {**base.notes, **{line_name(d.name, own): Note(*d[2:4], d.expression) for d in own}}
        self.known = {*base.inputs, *(line.name for line in self.lines)}
        self.chains: dict[tuple[str, ...], Chain] = {}

    def add(self, name: str) -> None:
        """The lines of one derivative; those of the values are there."""
        base, parameters = parts(name)
        definition = next((d for d in self.own if d.name == base), None)
        result = line_name(name, self.own)
        if definition is None or result in self.known:
            return
        slope: Argument = line_name(base, self.own)
        for order in range(1, len(parameters) + 1):
            slope = self._chain(parameters[:order]).slope(slope)
        # A derivative of 0 is so only where there is a value: a factor says so, which `specialise` sees to.
        zero = Line(result, "mul", (line_name(base, self.own), 0.0))
        self._append([zero if slope == 0.0 else Line(result, "copy", (slope,))])
        self.notes[result] = Note(*derivative_row(definition.name, definition.unit, parameters))

    def _chain(self, parameters: tuple[str, ...]) -> Chain:
        """All derivatives with respect to some parameters, taken one after the other."""
        if parameters in self.chains:
            return self.chains[parameters]
        *before, last = parameters
        chain = _Chain(last, f"{PREFIX}{'_'.join(parameters)}_")
        slow = [leaf for leaf, by in self.needed.slow if by == last] if not before else []
        for line in keep_outputs(self.base, slow).lines if slow else ():
            chain.through(line)
        lines = self._chain(tuple(before)).lines if before else self.values
        chain.slopes |= self._chain((last,)).slopes if before else {}
        for leaf in self.needed.names:
            one, other = sensitivity(leaf, *before), sensitivity(leaf, *parameters)
            if other in self.known and (before or (leaf != last and leaf not in slow)):
                chain.slopes[one] = other
            elif before:
                chain.slopes.pop(one, None)
        for line in lines:
            chain.through(line)
        self._append(chain.lines)
        self.chains[parameters] = chain
        return chain

    def _append(self, lines: Iterable[Line]) -> None:
        self.lines += lines
        self.known |= {line.name for line in lines}


# Angles that double_digits reduces.
BOUNDED = ("theta", "phi", "delta", "pressure_angle", "transmission_angle")


@lru_cache(maxsize=256)
def not_extended(own: tuple[Definition, ...]) -> tuple[str, str] | None:
    """The first quantity without double-double, and the operation that lacks it; None if all have it."""
    for definition in own:
        for line in _value_lines(definition):
            angle = line.op in ("sin", "cos") and line.args[0] not in BOUNDED
            if angle or line.op in ("exp", "log", "pow"):
                return definition.name, f"{line.op} of an expression" if angle else line.op
    return None


@lru_cache(maxsize=256)
def has_kinks(own: tuple[Definition, ...]) -> bool:
    """True where a quantity may have kinks or jumps, or waves of its own, over the crank angle."""
    ops = {line.op for definition in own for line in _value_lines(definition)}
    return bool(ops & {"abs", "select", "sin", "cos"})


@lru_cache(maxsize=256)
def _value_lines(definition: Definition) -> tuple[Line, ...]:
    """The lines of a value, under names that no other line has."""
    program = ProgramText(definition.text).read()
    own = {line.name: f"{PREFIX}{definition.name}_{n}" for n, line in enumerate(program.lines)}
    own[program.outputs[0]] = line_name(definition.name, (definition,))
    return renamed(program, own).lines


@lru_cache(maxsize=256)
def conditions_of(own: tuple[Definition, ...]) -> tuple[Definition, ...]:
    """Definitions of what is 0 where a quantity may jump or have a kink.

    These are the differences that `where`, `min` and `max` compare, and what `abs` takes.
    """
    return tuple(dict.fromkeys(condition for definition in own for condition in _conditions(definition)))


def _conditions(definition: Definition) -> Iterator[Definition]:
    program = ProgramText(definition.text).read()
    (output,) = program.outputs
    for number, line in enumerate(program.lines):
        if line.op not in ("lt", "le", "abs"):
            continue
        a, b = (*line.args, 0.0)[:2]
        lines = (*program.lines[:number], Line(output, "sub", (a, b)))
        difference = Program(program.inputs, lines, (output,), {output: Note("1", "", "")})
        difference = keep_outputs(optimise(difference), (output,))
        if difference.inputs:
            text = write_function(difference, "own", f"A condition of {definition.name}.")
            name = f"{definition.name}_condition_{number}"
            yield Definition(name, definition.expression, "1", "", (), text)
