"""The content of an explorer page: inputs, designs, quantities, and a function for each quantity.

A quantity and its first sensitivities are one Program, cut to them: the page computes what it draws.
"""

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from ...compiler.languages.javascript import emit_javascript
from ...compiler.program import Line, Program, renamed
from ...loads.angles import cycle
from ...loads.lines import lines_of, tables_of, totals_of
from ...loads.load import Load
from ...loads.resolve import plan_of, split
from ...mechanism.catalogue import Quantity, law_name, quantities, quantity
from ...mechanism.closed.dead_centres import DEAD_CENTRES
from ...mechanism.closed.functions import closed_form
from ...mechanism.closed.limits import ANGLES, LIMITS
from ...mechanism.inputs import INPUTS
from ...mechanism.load_lines import TurningSense, with_totals
from ...mechanism.names import CENTRES, LENGTHS, LOADS, PARAMETERS, joined, parts
from ...mechanism.own import Definition, used_by, using
from ...mechanism.program import program_of
from ...mechanism.quantity_units import SI, UnitSystem
from ...runtime.request import request
from ...runtime.specialise import specialise

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
MOST_DESIGNS = 5  # that a page compares when it is opened: a colour is left for one that is kept
FROM_MANY = 4  # of more values than that, evenly chosen
LISTED = 6  # values that are left out; of more only their number is shown


class PageFunction(NamedTuple):
    """One function of the page: the values that it returns, the inputs that it takes, its source."""

    quantity: str
    names: tuple[str, ...]
    inputs: tuple[str, ...]
    source: str


class PageContent(NamedTuple):
    """The content of a page in SI units; `units`: of values, tables, files; `fields`: of the controls."""

    title: str
    branch: int
    theta: tuple[float, float]
    designs: tuple[dict[str, float], ...]
    shown: tuple[str, ...]
    functions: tuple[PageFunction, ...]
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
            return [quantity(name, state) for function in self.functions for name in function.names]


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
    functions = tuple(_function(base, own, given, branch, loads) for base, own in groups.items())
    designs = _designs(given)
    left = {n: out for n, value in given.items() if n != "theta" and (out := _left_out(n, value, designs))}
    theta, own = _angles(given, cycle(loads)), used_by(groups)
    return PageContent(title, branch, theta, designs, shown, functions, left, named, loads, definitions=own)


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


def _function(
    base: str, names: Iterable[str], given: Mapping[str, Value], branch: int, loads: Mapping[str, Load]
) -> PageFunction:
    plan = plan_of(tuple(names), loads, "omega" in given, "mu" in given)
    every = tuple(dict.fromkeys((*plan.names, *plan.motion)))
    free = dict.fromkeys(given, 1.0) | {"theta": 1.0}  # every given input stays variable
    asked = request(every, free, branch, "standard")
    program = specialise(asked.names, asked.form, asked.fixed)
    if plan.loads:
        way = TurningSense("omega", "alpha") if "omega" in given else TurningSense("omega0")
        lines = [lines_of(*item) for item in plan.loads.items()]
        outputs = dict(zip(every, program.outputs, strict=True))
        program = _with_constants(with_totals(program, outputs, lines, totals_of(plan), way), plan.loads)
    return PageFunction(base, plan.shown, program.inputs, emit_javascript(program, f"of_{base}"))


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


def closed_functions(branch: int) -> dict[str, str]:
    """The functions of the lengths of a design, which are closed forms: limit angles, figures of a turn."""
    turn = ("stroke", "time_ratio", "theta_outer", "theta_inner", "max_pressure_angle")
    forms = {
        "limits": closed_form(LIMITS, ANGLES).program,
        "turn": closed_form(DEAD_CENTRES, turn, branch=float(branch), turning=1.0).program,
    }
    return {
        name: emit_javascript(program._replace(inputs=LENGTHS), f"of_{name}")
        for name, program in forms.items()
    }


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
