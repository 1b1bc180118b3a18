"""`define` and `undefine`: user-defined quantities, known to every later call."""

from collections.abc import Iterable, Mapping
from keyword import iskeyword
from typing import Any

from ..compiler.passes.pipeline import optimise
from ..compiler.program import RESERVED, Note
from ..compiler.text import read_function, write_function
from ..mechanism.inputs import INPUTS, Input
from ..mechanism.names import INTERNAL, parts
from ..mechanism.own import Definition, change, closure, derived_names, register, rows_of
from ..mechanism.read import read
from ..mechanism.spelling import did_you_mean
from ..support.shown import shown
from ..units.dimensions import NONE, unit_text
from ..units.parse import coherent_unit, exact_quantity, rounded
from ..units.table import PI
from .expression import FUNCTIONS, Expression, Value, dimension_of, dimension_text

LONGEST_NAME = 48
LONGEST_CONSTANT = 100
LONGEST_MEANING, LONGEST_UNIT = 200, 40
# Inputs of calls, and results, which are named in the same places as quantities.
TAKEN = frozenset((
    "branch", "accuracy", "threads", "out", "quality", "kind", "reduce", "torque", "slow_stroke", "point",
))  # fmt: skip
# What ends a comment or a text in one of the languages that a meaning is written into.
MARKS = ('"""', "\\", " | ", "*/", "</", "<!--", "-->")
OUTPUT = "_value"  # of the Program of a definition
DEEPEST = 50  # definitions that use one another


def define(name: str, expression: str, unit: str | None = None, meaning: str = "", **constants: Any) -> str:
    """Define a quantity, known from then on to every call, plot and file, with its sensitivities.

        >>> import desaxe as dx
        >>> dx.define("shoe_power", "f * abs(N_C * V_C)", unit="W", meaning="power lost in the shoe", f=0.08)
        'shoe_power'
        >>> machine = dict(theta=1.0, ec=0.01, AB=0.125, BC=0.35, omega0=150.0, m_slider=0.8)
        >>> round(dx.evaluate("shoe_power", **machine), 3)
        449.202
        >>> dx.undefine("shoe_power")

    expression  of all quantities, sensitivities, inputs and `pi`, with + - * / **, sqrt abs sin cos tan atan2
                hypot exp log min max, and where(comparison, value, other). It is read as arithmetic and never
                evaluated as Python
    unit        the SI unit, such as "W" or "N*m"; it must be that of the expression. That of the expression
                without
    constants   numbers, or texts with a unit: r_pin="1 mm"

    Sensitivities by every parameter come from the program's own differentiation: `shoe_power_wrt_ec`; second
    ones exist where the names used have them. The derivative of a magnitude at 0 is NaN, at a kink that of
    the side that is taken. Other definitions may be used. A second definition of a name takes the place of
    the first. Returns the name. Raises ValueError or TypeError that points at the place for a name that is
    taken, an unknown name, a dimension that does not fit, or anything that is no expression.
    """
    made = (name, expression, unit, meaning, constants)
    change(lambda known: with_definitions(known, [compiled(*made, known)]))
    return name


def undefine(name: str) -> None:
    """Remove a user-defined quantity; ValueError if there is none of this name or another one uses it."""

    def without(known: Mapping[str, Definition]) -> dict[str, Definition]:
        if not isinstance(name, str) or name not in known:
            others = f"; there are {', '.join(known)}" if known else ""
            raise ValueError(f"name = {shown(name)} is not a defined quantity{others}")
        users = [other.name for other in known.values() if name in _bases(other)]
        if users:
            raise ValueError(f"{name} is used by {', '.join(users)}: undefine that first")
        return {key: definition for key, definition in known.items() if key != name}

    change(without)


def with_definitions(known: Mapping[str, Definition], new: Iterable[Definition]) -> dict[str, Definition]:
    """Known and new definitions together; those that use a new one are checked again."""
    result = dict(known)
    for definition in new:
        _check_chain(definition, result)
        result[definition.name] = definition
    replaced = {definition.name for definition in new if definition.name in known}
    for other in known.values():
        if other.name not in replaced and replaced.intersection(_bases(other)):
            result[other.name] = compiled(*other[:4], dict(other.constants), result)
    return result


def _check_chain(definition: Definition, known: Mapping[str, Definition]) -> None:
    """ValueError for a definition by itself, or one behind too many others."""
    depth: dict[str, int] = {}
    for other in closure(_bases(definition), known):
        depth[other.name] = 1 + max((depth.get(base, 0) for base in _bases(other)), default=0)
    if definition.name in depth:
        raise ValueError(f"{definition.name}: it would be defined by itself")
    if max(depth.values(), default=0) > DEEPEST:
        raise ValueError(f"{definition.name}: more than {DEEPEST} definitions that use one another")


def _bases(definition: Definition) -> list[str]:
    """The quantities and inputs of the expression, without the parameters of sensitivities."""
    return [parts(used)[0] for used in definition.uses]


def compiled(
    name: Any,
    expression: Any,
    unit: Any,
    meaning: Any,
    constants: Mapping[str, Any],
    known: Mapping[str, Definition],
) -> Definition:
    """Check a definition and compile its expression; its arguments are those of `define`."""
    _check_name(name)
    meaning = _checked_text(name, "meaning", meaning, LONGEST_MEANING)
    if not isinstance(expression, str):
        raise TypeError(f"{name}: the expression is a text, got {type(expression).__name__}")
    constants = {key: str(v) if hasattr(v, "magnitude") else v for key, v in constants.items()}
    values = {key: _constant(name, key, value) for key, value in constants.items()}
    values["pi"] = Value(float(PI), NONE)
    source = Expression(
        name, expression, lambda word: values.get(word) or _quantity(word, name, known, values)
    )
    expression = " ".join(expression.split())
    uses = [word for word in source.names if word not in values]
    if not uses:
        source.refuse_all("a constant: it uses no quantity and no input")
    unit = _unit(source, unit)
    unused = [key for key in constants if key not in source.names]
    if unused:
        raise ValueError(f"{name}: constant {unused[0]} is not used in {expression!r}")
    body = "\n    ".join([*source.lines, f"{OUTPUT} = {source.value.argument}", f"return {OUTPUT}"])
    program = read_function(f"def own({', '.join(uses)}):\n    {body}\n")
    program = optimise(program._replace(inputs=tuple(uses), notes={OUTPUT: Note(unit, meaning, expression)}))
    text = write_function(program, "own", f"{name}, in SI units and radians.")
    stored = tuple((key, v if isinstance(v, str) else float(v)) for key, v in constants.items())
    return Definition(name, expression, unit, meaning, stored, text)


def _check_name(name: Any) -> None:
    if not isinstance(name, str):
        raise TypeError(f"the name of a quantity is a str, got {name!r}")
    if not (name.isascii() and name.isidentifier()) or name.startswith("_") or len(name) > LONGEST_NAME:
        limit = f"a name has at most {LONGEST_NAME} letters, digits and _, and begins with a letter"
        raise ValueError(f"{shown(name)}: {limit}")
    if "_wrt_" in name or "omega0" in name:
        raise ValueError(f"{name!r}: '_wrt_' and 'omega0' are parts of the names of sensitivities")
    if any(name in taken for taken in (derived_names(), INPUTS, TAKEN, INTERNAL)) or iskeyword(name):
        kind = "quantity" if name in derived_names() else "name"
        raise ValueError(f"{name!r} is a {kind} of desaxe already")
    if name in FUNCTIONS or name in RESERVED or name == "pi":
        raise ValueError(f"{name!r} is a function of expressions")


def _checked_text(name: str, what: str, text: Any, longest: int) -> str:
    if not isinstance(text, str):
        raise TypeError(f"{name}: the {what} is a text, got {shown(text)}")
    if len(text) > longest or not text.isprintable() or any(mark in text for mark in MARKS):
        limit = f"one line of at most {longest} characters, without {' '.join(MARKS)}"
        raise ValueError(f"{name}: the {what} is {limit}")
    return text


def _constant(owner: str, name: str, value: Any) -> Value:
    """A constant, a number or a text such as "1 mm", in its SI unit."""
    if not (name.isascii() and name.isidentifier()) or len(name) > LONGEST_NAME:
        raise ValueError(f"{owner}: {name[:LONGEST_NAME]!r} is not a valid name of a constant")
    if any(name in taken for taken in (FUNCTIONS, ("pi",), derived_names(), INPUTS, register().rows)):
        raise ValueError(f"{owner}: constant {name!r} has the name of a quantity, an input or a function")
    what = f"{owner}: constant {name}"
    if not isinstance(value, str):
        row = Input(what, "1", "", limit="finite")
        return Value(read(row, value, "define", "a number or a text such as '1 mm'"), NONE)
    if len(value) > LONGEST_CONSTANT:
        raise ValueError(f"{what}: {len(value)} characters are no number with a unit")
    exact, unit = exact_quantity(f"{what} = {value!r}", value)
    return Value(rounded(what, value, exact), dimension_of(unit))


def _quantity(
    word: str, defined: str, known: Mapping[str, Definition], constants: Iterable[str]
) -> Value | str:
    """A quantity or an input of an expression, or what is wrong with the name."""
    base = parts(word)[0]
    if base == defined:
        return f"{base} would be defined by itself"
    if base == "status":
        return "status is not a real number"
    row = (rows_of(known[base], known) if base in known else derived_names()).get(word)
    if row is None and word not in INPUTS:
        everything = (*derived_names(), *INPUTS, *known, *constants)
        hint = did_you_mean(word, everything).strip() if len(word) <= LONGEST_NAME else ""
        return f"unknown name {shown(word)}{'; ' * bool(hint)}{hint}"
    return Value(word, dimension_of(coherent_unit(row[0] if row else INPUTS[word].unit)))


def _unit(source: Expression, unit: Any) -> str:
    """The unit, checked against the dimension of the expression."""
    dimension = source.value.dimension or NONE
    right = dimension_text(dimension)
    if unit is None:
        if any(power.denominator != 1 for power in dimension[:4]):
            source.refuse_all(f"its dimension, {right}, has no unit: a power of it is not an integer")
        return unit_text(NONE) if dimension == NONE else right
    text = _checked_text(source.name, "unit", unit, LONGEST_UNIT)
    try:
        requested = dimension_of(coherent_unit(text))
    except ValueError as error:
        raise ValueError(f"{source.name}: {error}") from None
    if requested != dimension:
        wrong = dimension_text(requested)
        source.refuse_all(f"the unit {text!r} is {wrong}, but the expression is {right}")
    return text
