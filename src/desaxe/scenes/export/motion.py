"""The crank's acceleration under a torque as a Program, for a controller or a simulation in another language.

torque = M alpha + h + c |N|: h is the drive torque at constant speed without friction, c |N| what the guide
takes (`simulation/law.py`). The way in which the crank turns, or is about to turn, is an input of its
own: at rest there is an answer for each way.
"""

from collections.abc import Mapping
from types import MappingProxyType

from ...compiler.languages.protocol import Solver, Symbol
from ...compiler.passes.guard import guard_inputs
from ...compiler.passes.pipeline import optimise
from ...compiler.program import Line, Program, renamed
from ...compiler.text import read_function
from ...loads.lines import lines_of, totals_of
from ...loads.load import Load
from ...loads.resolve import plan_of
from ...mechanism.inputs import LEAST
from ...mechanism.load_lines import Total, TurningSense, with_totals
from ...mechanism.names import CENTRES, LENGTHS, LOADS, MASSES, STATUS
from ...mechanism.program import Variant
from ...runtime.specialise import specialise
from ...simulation.law import JAMS_AT
from ...simulation.model import form_of

FREE = """def motion(M_eff, T_in, torque):
    acceleration = (torque - T_in) / M_eff
    return acceleration
"""
RUBBING = f"""def motion(M_eff, T_in, torque, Y_wrt_theta, N_C, N_C_wrt_alpha, lean, mu, way):
    alpha_free = (torque - T_in) / M_eff
    normal_free = N_C + N_C_wrt_alpha * alpha_free
    arm = mu * (fabs(Y_wrt_theta) * way)
    wedge = lean * (mu * copysign(1.0, Y_wrt_theta) * way) - arm * (N_C_wrt_alpha / M_eff)
    share = wedge * copysign(1.0, normal_free)
    acceleration = alpha_free - arm * (fabs(normal_free) / (1.0 - share)) / M_eff
    jams = {JAMS_AT!r} <= share
    two = share < -1.0
    return acceleration, jams, two
"""
SMOOTH, CONTACT = ("M_eff", "T_in"), ("Y_wrt_theta", "N_C", "N_C_wrt_alpha", "lean")


def has_masses(inputs: Mapping[str, object]) -> bool:
    """True where something has a mass, so that a torque has an effect."""
    return any(inputs.get(name, 0.0) != 0.0 for name in MASSES)


def numbers_of(inputs: Mapping[str, object]) -> dict[str, float]:
    """The lengths, masses and loads that an acceleration has folded in: numbers, and 0 for what is absent."""
    values = {n: inputs.get(n, 0.0) for n in (*LENGTHS, *LOADS) if n in inputs or n not in CENTRES}
    return {name: value for name, value in values.items() if isinstance(value, float)}


def motion(
    given: Mapping[str, object],
    branch: int,
    loads: Mapping[str, Load] = MappingProxyType({}),
) -> Program:
    """The acceleration and its status, from theta, omega, torque, what is not a number, and `way` (-1, 1).

    Without friction, mu = 0, and loads that differ by the way of the slider there is no `way`.
    """
    numbers = numbers_of(given)
    rubs = numbers.get("mu") != 0.0
    fixed = {**numbers, "branch": float(branch), "alpha": 0.0, "mu": 0.0}
    names = (*SMOOTH, STATUS, *(CONTACT if rubs else ()))
    base = _base(names, form_of(given), tuple(fixed.items()), loads)
    law = read_function(RUBBING if rubs else FREE)
    parts = dict(zip((*SMOOTH, STATUS, *CONTACT), base.outputs, strict=False))
    law = renamed(law, parts | {line.name: f"_{line.name}" for line in law.lines})
    inputs = [*base.inputs, *(name for name in law.inputs if name not in (*base.inputs, *parts))]
    status = [Line("told", "copy", (parts[STATUS],), "i64")]
    if rubs:
        status = [
            Line("_balances", "select", ("_two", 6, parts[STATUS]), "i64"),
            Line("told", "select", ("_jams", 5, "_balances"), "i64"),
        ]
    lines, outputs = (*base.lines, *law.lines, *status), ("_acceleration", "told")
    whole = Program(tuple(inputs), lines, outputs, base.notes)
    held = {"mu": numbers["mu"]} if rubs and "mu" in numbers else {}
    program = optimise(whole, held)
    return guard_inputs(program, [name for name in program.inputs if name != "way"], LEAST, {})


def _base(
    names: tuple[str, ...],
    form: Variant,
    fixed: tuple[tuple[str, float], ...],
    loads: Mapping[str, Load],
) -> Program:
    """The program of names of the motion, under loads with `way`."""
    if not loads:
        return specialise(names, form, fixed)
    public = tuple(name for name in names if name != "lean")
    plan = plan_of(public, loads, True, public != names)
    every = tuple(dict.fromkeys((*names, *plan.names, *plan.motion, *plan.of_motion)))
    base = specialise(every, form, fixed)
    lines = [lines_of(name, load) for name, load in plan.loads.items()]
    of_all = {total.name: total for total in totals_of(plan)}
    totals = [of_all.get(name, Total(name)) for name in names]
    return with_totals(base, dict(zip(every, base.outputs, strict=True)), lines, totals, TurningSense("way"))


def motion_solver(inputs: Mapping[str, object], branch: int, loads: Mapping[str, Load]) -> Solver:
    """The acceleration as a function of its own arguments and those of a module."""
    message = (
        ("N*m", "torque on the crank"),
        ("rad", "crank angle"),
        ("rad/s", "speed"),
        ("1", "sign of the speed"),
    )
    own = zip(("torque", "theta", "omega", "way"), message, strict=True)
    law = motion(inputs, branch, loads)
    return Solver(tuple(Symbol(name, *each) for name, each in own), law)
