"""The variables of an FMU: a value reference is a place in this table, and in the array of the C source."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from ....loads.lines import tables_of
from ....loads.load import Load
from ....loads.resolve import plan_of, split
from ....mechanism.catalogue import quantity
from ....mechanism.inputs import INPUTS
from ....mechanism.names import CENTRES, LENGTHS, MASSES
from ...content import Content
from ...schema import SceneError

FIXED = (*LENGTHS, *MASSES, *CENTRES, "g_X", "g_Y", "mu")  # parameters, in their order
FORCES = ("F_X", "F_Y")
FROZEN = ("parameter", "fixed")  # roles of what is set before the start
NOMINAL = 1e-3  # of both states: below a thousandth an importer counts errors absolutely, as `simulate` does


class Variable(NamedTuple):
    """A variable with its role in the standard's words; `start` is None where it is calculated."""

    name: str
    unit: str
    meaning: str
    causality: str
    variability: str = "continuous"
    start: float | None = None
    derivative: str = ""  # of which variable it is the derivative
    whole: bool = False  # a whole number


class Variables(NamedTuple):
    """All variables, the names of those that have a role, and the number of event indicators."""

    rows: tuple[Variable, ...]
    parameters: tuple[str, ...]
    inputs: tuple[str, ...]
    states: tuple[str, ...]
    outputs: tuple[str, ...]
    indicators: int

    @property
    def place(self) -> dict[str, int]:
        """Name -> value reference."""
        return {row.name: index for index, row in enumerate(self.rows)}


def variables(content: Content, drive: str) -> Variables:
    """The variables of a scene; `drive` is torque or omega."""
    given, moves = content.inputs, drive == "torque"
    loads = split(given)[1]
    check_outputs(content.outputs, loads)
    speed = first(given, "omega" if "omega" in given else "omega0")
    parameters = [
        Variable(n, INPUTS[n].unit, INPUTS[n].meaning, *FROZEN, first(given, n))
        for n in FIXED
        if n not in CENTRES or n in given
    ]
    parameters.append(Variable("theta0", "rad", "crank angle at the start", *FROZEN, first(given, "theta")))
    motion = [Variable("theta", "rad", "crank angle, from the slider axis", _role("theta", content))]
    if moves:
        parameters.append(Variable("omega_start", "rad/s", "crank speed at the start", *FROZEN, speed))
        driven = Variable("torque", "N*m", "torque on the crank, positive like theta", "input", start=0.0)
        motion += [
            Variable("omega", "rad/s", "angular speed of the crank", _role("omega", content)),
            Variable("der(theta)", "rad/s", "rate of theta", "local", derivative="theta"),
            Variable("der(omega)", "rad/s^2", "angular acceleration", "local", derivative="omega"),
        ]
    else:
        driven = Variable("omega", "rad/s", "angular speed of the crank", "input", start=speed)
    inputs = [driven, *(_force(n, loads.get(n), first(given, n)) for n in FORCES)]
    taken = {row.name for row in (*parameters, *inputs, *motion)}
    own = next((n for n in content.outputs if n in taken - {"theta", "omega"} or n == "time"), None)
    if own is not None:
        raise SceneError(f"outputs: {own!r}: an FMU has a variable of this name; give the quantity another")
    outputs = [_output(name) for name in dict.fromkeys(content.outputs) if name not in taken]
    time = Variable("time", "s", "time", "independent")
    return Variables(
        (time, *parameters, *inputs, *motion, *outputs),
        tuple(row.name for row in parameters),
        tuple(row.name for row in inputs),
        ("theta", "omega") if moves else (),
        tuple(row.name for row in outputs),
        3 + 3 * sum(len(tables_of(*item)) for item in loads.items()) if moves else 2,
    )


def check_outputs(names: tuple[str, ...], loads: Mapping[str, Load]) -> None:
    """SceneError for an output that a given state does not have, or that is a derivative through a load."""
    for name in names:
        try:
            quantity(name, True)
        except ValueError as error:
            raise SceneError(
                f"outputs: {name!r}: an FMU has a given state, theta and omega: {error}"
            ) from None
    through = plan_of(names, loads, True, False).terms
    total = next((name for name, terms in through.items() if terms), None)
    if total is not None:
        raise SceneError(
            f"outputs: {total!r} is a derivative through a load that varies with the motion, which an FMU "
            "does not give as an output: ask for its directional derivative"
        )


def first(inputs: Mapping[str, Any], name: str) -> float:
    """A number of the scene, or the first of a list; 0 without."""
    value = inputs.get(name, 0.0)
    return 0.0 if callable(value) else float(value[0] if isinstance(value, tuple) else value)


def _force(name: str, load: Any, start: float) -> Variable:
    more = "" if load is None else f", added to a {load.told().strip('<>')}"
    return Variable(name, "N", f"{INPUTS[name].meaning}{more}", "input", start=start)


def _role(name: str, content: Content) -> str:
    return "output" if name in content.outputs else "local"


def _output(name: str) -> Variable:
    row = quantity(name, True)
    if name == "status":
        return Variable(name, "1", row.meaning, "output", "discrete", whole=True)
    return Variable(name, row.unit, row.meaning or name, "output")
