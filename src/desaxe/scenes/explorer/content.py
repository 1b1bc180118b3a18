"""The content of an explorer page: inputs, designs, quantities, and the module that computes them.

A quantity and its first sensitivities are one function of the module: the page computes what it draws.
"""

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

from ...compiler.languages.protocol import Forms, Module, Symbol
from ...compiler.passes.slicing import keep_outputs
from ...compiler.program import Line, Program, renamed
from ...loads.angles import cycle
from ...loads.lines import tables_of
from ...loads.load import Load
from ...loads.resolve import split
from ...mechanism.catalogue import Quantity, law_name, quantities, quantity
from ...mechanism.closed.dead_centres import DEAD_CENTRES
from ...mechanism.closed.functions import closed_form
from ...mechanism.closed.limits import ANGLES, LIMITS
from ...mechanism.constants import constants
from ...mechanism.inputs import INPUTS
from ...mechanism.names import CENTRES, LOADS, ORDER, PARAMETERS, joined, parts
from ...mechanism.own import Definition, used_by, using
from ...mechanism.program import program_of
from ...mechanism.quantity_units import SI, UnitSystem
from ..content import Content
from ..export.portable import ANY, asked_of

Value = float | tuple[float, ...]

KINEMATICS = (
    "Y", "V_C", "a_C", "j_C", "phi", "omega_BC", "alpha_BC", "s", "delta", "transmission_angle",
    "pressure_angle", "omega", "V_B", "V_B_X", "V_B_Y", "a_B", "a_B_X", "a_B_Y",
)  # fmt: skip
FORCES = ("T_in", "N_C")
VALUES = (  # without their sensitivities, which would make the page twice as large
    "power_in", "F_friction", "F_A_X", "F_A_Y", "F_B_X", "F_B_Y", "F_shaking_X", "F_shaking_Y",
    "M_shaking",
)  # fmt: skip
CHANGED = tuple(name for name in LOADS if name not in CENTRES)  # on the page; 0 where not given
STATE = ("status", "margin")
TURN = ("stroke", "time_ratio", "theta_outer", "theta_inner", "max_pressure_angle")
CLOSED = {  # of the lengths: closed forms, and the names of their values in the module
    "limits": [f"limits_{name}" for name in ANGLES],
    "turn": [f"turn_{name}" for name in TURN],
}
MOST_DESIGNS = 5  # that a page compares when it is opened: a colour is left for one that is kept
FROM_MANY = 4  # of more values than that, evenly chosen
LISTED = 6  # values that are left out; of more only their number is shown


class PageContent(NamedTuple):
    """The content of a page in SI units; `units`: of values, tables, files; `fields`: of the controls."""

    title: str
    branch: int
    theta: tuple[float, float]
    designs: tuple[dict[str, float], ...]
    shown: tuple[str, ...]
    groups: dict[str, list[str]]  # quantity -> it and the sensitivities that the page knows
    module: Module
    left_out: Mapping[str, tuple[float, ...]]  # input -> its values that no design has
    given: tuple[str, ...]  # the inputs that were given
    loads: Mapping[str, Load] = MappingProxyType({})
    units: UnitSystem = SI
    fields: UnitSystem = SI
    definitions: tuple[Definition, ...] = ()  # that the quantities use

    @property
    def quantities(self) -> list[Quantity]:
        """The records of all quantities of the page."""
        state = "omega" in self.designs[0]
        with using(self.definitions):
            return [quantity(name, state) for names in self.groups.values() for name in names]


def content(
    title: str, branch: int, inputs: Mapping[str, Any], shown: Iterable[str], names: Iterable[str] | None
) -> PageContent:
    """The content for these inputs; `names` are the quantities, those of the motion without.

    A load that varies with the motion is a sum of tables; the page adds a constant to it.
    """
    loads = _tables(inputs)
    given: dict[str, Value] = {"alpha": 0.0, **inputs, **dict.fromkeys(loads, 0.0)}
    named = tuple(inputs)
    shown = tuple(dict.fromkeys(shown))
    for name in ("ec", "AB", "BC", "omega" if "omega" in given else "omega0"):
        if name not in given:
            raise TypeError(f"explore: {name} is missing (needed: ec, AB, BC, and omega0 or omega)")
    requested = [*shown, *((*KINEMATICS, *(FORCES * is_loaded(given))) if names is None else names)]
    groups = _grouped(requested, given)
    groups.setdefault("Y", ["Y"])  # of the drawing
    if is_loaded(given):
        groups |= {} if names is not None else {name: [name] for name in VALUES if name not in groups}
        given = {**given, **{name: 0.0 for name in CHANGED if name not in given}}
    free: Any = dict.fromkeys((*given, "theta"), ANY) | loads
    every = tuple(name for names in groups.values() for name in names)
    scene = Content(title=title, inputs=free, outputs=every, branch=branch, accuracy="standard")
    module = _module(scene, groups.values())
    designs = _designs(given)
    left = {n: out for n, value in given.items() if n != "theta" and (out := _left_out(n, value, designs))}
    theta, own = _angles(given, cycle(loads)), used_by(groups)
    content = PageContent(title, branch, theta, designs, shown, groups, module, left, named, loads)
    return content._replace(definitions=own)


def _tables(inputs: Mapping[str, Any]) -> dict[str, Load]:
    """The loads that vary with the motion; TypeError for one that is no sum of tables."""
    result: dict[str, Load] = split(inputs)[1]
    for name, load in result.items():
        if not tables_of(name, load):
            raise TypeError(
                f"explore: {name} = {load!r}: a page holds numbers, tables, springs, dampers and their sums"
            )
    return result


def left_out_text(content: PageContent) -> str:
    """The input values that no design of the page has, as text; empty if there are none."""
    message = []
    for name, values in content.left_out.items():
        own = (content.units or content.fields).of(name)
        numbers = ", ".join(f"{own.shown(value):.6g}" for value in values)
        listed = f"{name} = {numbers} {own.unit}".removesuffix(" 1")
        message.append(listed if len(values) <= LISTED else f"{len(values)} of the values of {name}")
    return "; ".join(message)


def _left_out(name: str, value: Value, designs: Iterable[Mapping[str, float]]) -> tuple[float, ...]:
    if not isinstance(value, tuple):
        return ()
    there = {design[name] for design in designs}
    return tuple(dict.fromkeys(v for v in value if v not in there))


def is_loaded(given: Mapping[str, Any]) -> bool:
    """True if a mass or a force is among the inputs."""
    return any(name in given for name in LOADS)


def forces_first(names: Iterable[str], state: bool) -> list[str]:
    """These names, first those that masses and loads have an effect on; FORCES where there are none."""
    lawful = {name: law_name(name) if state else name for name in names}
    forces = [n for n, law in lawful.items() if any(p in LOADS for p in program_of((law,)).inputs)]
    return list(dict.fromkeys([*(forces or FORCES), *lawful]))


def _grouped(requested: Iterable[str], given: Mapping[str, Value]) -> dict[str, list[str]]:
    """Group names by quantity: the quantity, its first sensitivities, and further requested ones."""
    state = "omega" in given
    result: dict[str, list[str]] = {STATE[0]: list(STATE)}
    for name in requested:
        quantity(name, state)
        base = parts(name)[0]
        if base not in STATE:
            result.setdefault(base, [base, *_sensitivities(base, given)])
            result[base] += [name] if name not in result[base] else []
    return result


def _sensitivities(base: str, given: Mapping[str, Value]) -> list[str]:
    """Sensitivities by the motion's parameters and by the given masses and loads."""
    state = "omega" in given
    known = quantities()
    by = [*PARAMETERS, *(load for load in LOADS if load in given)]
    names = [(p, joined(base, (p,))) for p in by]
    return [
        joined(base, ("omega",)) if state and p == "omega0" else name for p, name in names if name in known
    ]


def _module(content: Content, groups: Iterable[Sequence[str]]) -> Module:
    """The module of the outputs, as `compile` writes it, whose inputs are all open; with closed forms."""
    asked = asked_of(content, content.outputs)
    stable = _with_constants(asked.stable("standard"), asked.loads)
    outputs = [Symbol(*quantity(name, asked.request.form.state)) for name in content.outputs]
    closed = {
        "limits": closed_form(LIMITS, ANGLES).program,
        "turn": closed_form(DEAD_CENTRES, TURN, branch=float(content.branch), turning=1.0).program,
    }
    for group, program in closed.items():
        names = {line.name: f"{group}_{line.name}" for line in program.lines}
        lines = *stable.lines, *renamed(program, names).lines
        stable = stable._replace(lines=lines, outputs=(*stable.outputs, *CLOSED[group]))
        outputs += [Symbol(name, "1", "a closed form of the lengths") for name in CLOSED[group]]
    inputs = tuple(Symbol(n, INPUTS[n].unit, INPUTS[n].meaning) for n in ORDER if n in content.inputs)
    every_table = (part for item in asked.loads.items() for part in tables_of(*item).items())
    tables = {name: table.arrays() for name, table in every_table}
    module = Module("page", (), inputs, tuple(outputs), Forms(-1, stable), constants(), tables=tables)
    every = (*groups, *CLOSED.values())
    made = dict(zip((symbol.name for symbol in outputs), stable.outputs, strict=True))
    taken = {names[0]: keep_outputs(stable, [made[n] for n in names]).inputs for names in every}
    return module._replace(groups=every, arguments={n: taken[names[0]] for names in every for n in names})


def _with_constants(program: Program, forces: Iterable[str]) -> Program:
    """The program whose loads have a constant added: an input of the force's name."""
    sums = {f"{force}_sum": force for force in forces}
    lines: list[Line] = []
    for line in renamed(program, {force: name for name, force in sums.items()}).lines:
        force = sums.get(line.name)
        table = f"{force}_of_table"
        pair = [line._replace(name=table), Line(line.name, "add", (table, force))] if force else [line]
        lines += pair
    return program._replace(inputs=(*program.inputs, *sums.values()), lines=tuple(lines))


def _angles(given: Mapping[str, Value], cycle: float) -> tuple[float, float]:
    """The range of the crank angle: that of the scene, else a cycle; one without its last angle is whole."""
    theta = given.get("theta")
    if not isinstance(theta, tuple) or len(set(theta)) < 2:
        return (0.0, cycle)
    low, high = min(theta), max(theta)
    missing = low + cycle - high
    step = (high - low) / (len(theta) - 1)
    return (low, low + cycle) if 0.0 < missing <= 1.001 * step else (low, high)


def _designs(given: Mapping[str, Value]) -> tuple[dict[str, float], ...]:
    """One design, or a few over the values of the first input that has several."""
    inputs = {name: given[name] for name in INPUTS if name in given and name != "theta"}
    several = next((n for n, value in inputs.items() if isinstance(value, tuple) and len(value) > 1), None)
    first: dict[str, float] = {n: v[0] if isinstance(v, tuple) else v for n, v in inputs.items()}
    if several is None:
        return (first,)
    values: Any = inputs[several]
    count = len(values) if len(values) <= MOST_DESIGNS else FROM_MANY
    places = [round(k * (len(values) - 1) / (count - 1)) for k in range(count)]
    return tuple({**first, several: values[place]} for place in places)
