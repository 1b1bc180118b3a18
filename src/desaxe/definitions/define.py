"""`define` and `undefine`: user-defined quantities, known to every later call."""

from collections.abc import Iterable, Mapping
from keyword import iskeyword
from typing import Any, NamedTuple

from ..compiler.program import RESERVED, Note
from ..mechanism.dimensions import unit_of
from ..mechanism.inputs import INPUTS
from ..mechanism.names import INTERNAL, parts
from ..mechanism.own import Definition, change, derived_names, register, rows_of
from ..mechanism.spelling import did_you_mean
from ..support.shown import shown
from .dimensions import NONE, Checker, Dimension, dimension_of, unit_from
from .grammar import ARITY, DefinitionText, Node, parse
from .lines import value_text
from .units import constant_value

LONGEST_NAME = 48
LONGEST_MEANING = 200
# Inputs of calls, and measures of designs, which are named in the same places as quantities.
TAKEN = frozenset((
    "branch", "accuracy", "threads", "out", "quality", "kind", "reduce", "torque", "stroke", "time_ratio",
    "slow_stroke", "advance_angle", "return_angle", "theta_outer", "theta_inner", "Y_outer", "Y_inner",
    "point",
))  # fmt: skip
# What ends a comment or a text in one of the languages that a meaning is written into.
MARKS = ('"""', "\\", " | ", "*/", "</", "<!--", "-->")
DEEPEST = 50  # definitions behind one another


def define(name: str, expression: str, unit: str | None = None, meaning: str = "", **constants: Any) -> str:
    """Define a quantity of your own: every later call, plot and file knows it, with its sensitivities.

        >>> import desaxe as dx
        >>> dx.define("shoe_power", "f * abs(N_C * V_C)", unit="W", meaning="power lost in the shoe", f=0.08)
        'shoe_power'
        >>> machine = dict(theta=1.0, ec=0.01, AB=0.125, BC=0.35, omega0=150.0, m_slider=0.8)
        >>> round(dx.evaluate("shoe_power", **machine), 3)
        449.202
        >>> dx.undefine("shoe_power")

    expression  of all quantities, sensitivities, inputs and `pi`, with + - * / **, sqrt abs sin cos tan atan2
                hypot exp log min max, and where(comparison, value, other). It is parsed by a grammar of its
                own and never evaluated as Python
    unit        the SI unit, such as "W" or "N*m"; it must be that of the expression. That of the expression
                without
    constants   numbers, or texts with a unit: r_pin="1 mm"

    Sensitivities by every parameter come from the program's own differentiation: `shoe_power_wrt_ec`; second
    ones exist where the names used have them. The derivative of a magnitude at 0 is NaN, at a kink that of
    the side that is taken. Other definitions may be used. A second definition of a name takes the place of
    the first. Returns the name. Raises ValueError or TypeError that points at the place for a name that is
    taken, an unknown name, a dimension that does not fit, or anything that is no expression.
    """
    entry = GivenDefinition(name, expression, unit, meaning, constants)
    change(lambda known: with_definitions(known, [made_definition(entry, known)]))
    return name


def undefine(name: str) -> None:
    """Remove a user-defined quantity; ValueError if there is none of this name or another one uses it."""
    change(lambda known: _without(name, known))


def _without(name: str, known: Mapping[str, Definition]) -> dict[str, Definition]:
    if not isinstance(name, str) or name not in known:
        own = f"; there are {', '.join(known)}" if known else ""
        raise ValueError(f"name = {shown(name)} is not a defined quantity{own}")
    users = [other.name for other in known.values() if name in (parts(used)[0] for used in other.uses)]
    if users:
        raise ValueError(f"{name} is used by {', '.join(users)}: undefine that first")
    return {key: own for key, own in known.items() if key != name}


class GivenDefinition(NamedTuple):
    """The arguments of one definition, unchecked."""

    name: str
    expression: str
    unit: str | None
    meaning: str
    constants: Mapping[str, Any]


def with_definitions(known: Mapping[str, Definition], new: Iterable[Definition]) -> dict[str, Definition]:
    """Known and new definitions together; those that use a new one are checked again."""
    result = dict(known)
    for definition in new:
        result[definition.name] = definition
        _refuse_circles(definition.name, result)
    replaced = [definition.name for definition in new if definition.name in known]
    for other in known.values() if replaced else ():
        if other.name not in replaced and any(parts(used)[0] in replaced for used in other.uses):
            entry = GivenDefinition(
                other.name, other.expression, other.unit, other.meaning, dict(other.constants)
            )
            result[other.name] = made_definition(entry, result)
    return result


def _refuse_circles(name: str, known: Mapping[str, Definition]) -> None:
    seen: set[str] = set()
    stack = [(used, 1) for used in _own_uses(known[name], known)]
    while stack:
        used, depth = stack.pop()
        if used == name:
            raise ValueError(f"{name}: it would be defined by itself")
        if depth > DEEPEST:
            raise ValueError(f"{name}: more than {DEEPEST} definitions behind one another")
        if used not in seen:
            seen.add(used)
            stack += [(other, depth + 1) for other in _own_uses(known[used], known)]


def _own_uses(definition: Definition, known: Mapping[str, Definition]) -> list[str]:
    return [base for base in dict.fromkeys(parts(used)[0] for used in definition.uses) if base in known]


# ---- checks ---------------------------------------------------------------------------------------


def made_definition(entry: GivenDefinition, known: Mapping[str, Definition]) -> Definition:
    """Check a definition and compile its expression."""
    _check_name(entry.name)
    meaning = _checked_text(entry.name, "meaning", entry.meaning, LONGEST_MEANING)
    if not isinstance(entry.expression, str):
        raise TypeError(f"{entry.name}: the expression is a text, got {type(entry.expression).__name__}")
    source = DefinitionText(entry.name, entry.expression)
    tree = parse(source)
    values = {name: _constant(entry.name, name, value) for name, value in entry.constants.items()}
    dimensions = {name: dimension for name, (_, dimension) in values.items()}
    numbers = {name: value for name, (value, _) in values.items()}
    uses = _names_used(source, tree, entry.name, numbers, known)
    dimensions |= {name: _dimension(name, known) for name in uses} | {"pi": NONE}
    found = Checker(source, dimensions, numbers).of(tree) or NONE
    unit = _unit(source, entry.unit, found)
    unused = [name for name in numbers if not _mentions(tree, name)]
    if unused:
        raise ValueError(
            f"{entry.name}: constant {unused[0]} is not used in {' '.join(source.text.split())!r}"
        )
    expression = " ".join(entry.expression.split())
    text = value_text(entry.name, tree, uses, numbers, Note(unit, meaning, expression))
    constants = tuple((name, _kept(value)) for name, value in entry.constants.items())
    return Definition(entry.name, expression, unit, meaning, constants, text)


def _check_name(name: Any) -> None:
    if not isinstance(name, str):
        raise TypeError(f"the name of a quantity is a str, got {name!r}")
    shown = repr(name) if len(name) <= LONGEST_NAME else f"{name[:LONGEST_NAME]!r}..."
    if not (name.isascii() and name.isidentifier()) or name.startswith("_") or len(name) > LONGEST_NAME:
        raise ValueError(
            f"{shown}: a name has at most {LONGEST_NAME} letters, digits and _, and begins with a letter"
        )
    if "_wrt_" in name or "omega0" in name:
        raise ValueError(f"{name!r}: '_wrt_' and 'omega0' are parts of the names of sensitivities")
    if name in derived_names():
        raise ValueError(f"{name!r} is a quantity of desaxe already")
    if name in INPUTS or name in TAKEN or name in INTERNAL or iskeyword(name):
        raise ValueError(f"{name!r} is a name of desaxe already")
    if name in ARITY or name in RESERVED or name == "pi":
        raise ValueError(f"{name!r} is a function of expressions")


def _checked_text(name: str, what: str, text: Any, longest: int) -> str:
    if not isinstance(text, str):
        raise TypeError(f"{name}: the {what} is a text, got {shown(text)}")
    if len(text) > longest or not text.isprintable() or any(mark in text for mark in MARKS):
        raise ValueError(
            f"{name}: the {what} is one line of at most {longest} characters, without {' '.join(MARKS)}"
        )
    return text


def _constant(owner: str, name: str, value: Any) -> tuple[float, Dimension]:
    if not (name.isascii() and name.isidentifier()) or len(name) > LONGEST_NAME:
        raise ValueError(f"{owner}: {name[:LONGEST_NAME]!r} is not a valid name of a constant")
    if name in derived_names() or name in INPUTS or name in ARITY or name == "pi" or name in register().rows:
        raise ValueError(f"{owner}: constant {name!r} has the name of a quantity, an input or a function")
    try:
        number, unit = constant_value(name, value)
    except (ValueError, TypeError) as error:
        raise type(error)(f"{owner}: {error}") from None
    return number, dimension_of(unit)


def _kept(value: Any) -> str | float:
    """A constant in its stored form: a number, or a text with a unit."""
    return value if isinstance(value, str) else str(value) if hasattr(value, "magnitude") else float(value)


def _names_used(
    source: DefinitionText,
    tree: Node,
    own: str,
    numbers: Mapping[str, float],
    known: Mapping[str, Definition],
) -> tuple[str, ...]:
    """The quantities and inputs of a tree, in order; ValueError that marks the first unknown name."""
    found: dict[str, None] = {}
    stack = [tree]
    while stack:
        node = stack.pop()
        stack += reversed(node.parts)
        if node.op != "name" or node.name in numbers or node.name == "pi":
            continue
        base = parts(node.name)[0]
        if base == own:
            source.refuse(node.at, node.end, f"{own} would be defined by itself")
        if base == "status":
            source.refuse(node.at, node.end, "status is not a real number")
        if node.name not in derived_names() and node.name not in INPUTS and not _is_own(node.name, known):
            everything = (*derived_names(), *INPUTS, *known, *numbers)
            hint = did_you_mean(node.name, everything) if len(node.name) <= LONGEST_NAME else ""
            shown = node.name if len(node.name) <= LONGEST_NAME else f"{node.name[:LONGEST_NAME]}..."
            tail = f"; {hint.strip()}" if hint else ""
            source.refuse(node.at, node.end, f"unknown name {shown!r}{tail}")
        found[node.name] = None
    if not found:
        source.refuse(0, len(source.text), "a constant: it uses no quantity and no input")
    return tuple(found)


def _is_own(name: str, known: Mapping[str, Definition]) -> bool:
    """True for another user-defined quantity or one of its sensitivities."""
    base = parts(name)[0]
    return base in known and name in rows_of(known[base], known)


def _mentions(tree: Node, name: str) -> bool:
    stack = [tree]
    while stack:
        node = stack.pop()
        stack += node.parts
        if node.name == name and node.op == "name":
            return True
    return False


def _dimension(name: str, known: Mapping[str, Definition]) -> Dimension:
    base = parts(name)[0]
    own = rows_of(known[base], known) if base in known else {}
    row = derived_names().get(name) or own.get(name)
    return dimension_of(unit_of(row[0] if row else INPUTS[name].unit))


def _unit(source: DefinitionText, unit: str | None, found: Dimension) -> str:
    """The unit, checked against the dimension of the expression."""
    if unit is None:
        derived = unit_from(found)
        if derived is None:
            source.refuse(
                0, len(source.text), f"its dimension, {found}, has no unit: a power of it is not an integer"
            )
        return derived
    text = _checked_text(source.name, "unit", unit, 40)
    try:
        wanted = dimension_of(unit_of(text))
    except ValueError as error:
        raise ValueError(f"{source.name}: {error}") from None
    if wanted != found:
        source.refuse(0, len(source.text), f"the unit {text!r} is {wanted}, but the expression is {found}")
    return text
