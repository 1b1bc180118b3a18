"""Many designs at once: in the energy form or in compiled lanes where they serve, else row by row."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from math import inf, isfinite, nan
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.arrays import as_array, broadcast_shape, number_or_array
from ..evaluation.evaluate import evaluate
from ..loads.angles import zero_of
from ..loads.arguments import arguments_of
from ..loads.load import Load, OverY
from ..loads.motors import Motor
from ..mechanism.closed import TURN
from ..mechanism.closed.limits import theta_intervals
from ..mechanism.inputs import LEAST, Input
from ..mechanism.names import CENTRES, LENGTHS, LOADS
from ..runtime.threads import run_parts
from ..support.deadline import Deadline
from ..support.interrupts import stopped_early
from ..support.progress import Portions, progress_bar
from .checks import follows_the_slider, grows
from .collocation import TABLE
from .coordinate import arc_around, inside
from .energy.many import NOT_HERE, follow_many
from .energy.panels import Designs
from .energy.serves import ENERGY, served, tables_alone
from .history import PANELS
from .loops import nodes, state
from .loops.compiled import DesignFamily, motions, packed
from .loops.torque import compiled
from .model import fixed_zeros, form_of
from .request import Ask, one_motion
from .residual import TELLS, told_of
from .result import DONE, FAILED, NO_START, SENSITIVITIES, WORDS, Simulation

Array = NDArray[np.float64]
MOTION, NUMBERS = ("theta", "omega", "alpha"), ("t_last", "energy_residual", "work")
SAMPLES = 101  # instants of the histories by default
LONGEST_PART = 64  # designs in one native call, that threads share the work evenly
BRIEF = 500.0  # pieces of motions that run at once
LONGEST_BLOCK = 256  # the same in the energy form: its arrays stay in the cache
MOST_STEPS = 2  # its place in `how`
LARGE = 1_000  # designs that may take long: a bar tells
_UNITS = {"theta0": "rad", "omega_start": "rad/s", "torque": "N*m"}
STARTS = {name: Input(name, unit, "") for name, unit in _UNITS.items()}


def is_array(value: Any) -> bool:
    """True for an array-like value, one for each design."""
    if value is None or callable(value) or isinstance(value, str):
        return False
    try:
        return np.ndim(getattr(value, "magnitude", value)) > 0
    except ValueError:  # rows of different lengths
        return True


class Answers:
    """The answers of all designs: histories, numbers, statuses and ways, a row each.

    rounded   the residual of rounding, infinite where nothing is said of a residual
    without   designs of which a derivative does not exist
    """

    def __init__(self, size: int, t: Array, ask: Ask, status: NDArray[np.int8]) -> None:
        along = [f"{name}_wrt_{p}" for p in ask.wrt for name in ("theta", "omega")]
        ends = [f"{name}_wrt_{p}" for p in ask.wrt for name in ("t_last", "work")]
        self.size, self.t, self.status = size, t, status
        self.histories = {n: np.full((size, t.size), nan) for n in (*MOTION, *ask.names, *along)}
        self.numbers = {name: np.full(size, nan) for name in (*NUMBERS, *ends)}
        self.ways, self.rounded = np.full(size, "", "U6"), np.full(size, inf)
        self.without: list[int] = []

    def put(self, row: int, result: Simulation) -> None:
        """Put in the answer of one design."""
        count = len(result["t"])
        for name, history in self.histories.items():
            history[row, :count] = result[name]
        self.status[row], self.ways[row] = result["status"], result["method"]
        self.rounded[row] = 0.0 if TELLS in result["message"] else inf
        if SENSITIVITIES in result["message"]:
            self.without.append(row)
        for name, column in self.numbers.items():
            column[row] = result[name]

    def told(self, way: str, rows: Any, numbers: Array) -> None:
        """Take over the numbers of designs that went together."""
        self.ways[rows], self.rounded[rows] = way, numbers[rows, 3]
        for name, column in zip(NUMBERS, numbers.T, strict=False):
            self.numbers[name][rows] = column[rows]

    def result(self, shape: tuple[int, ...], rtol: float) -> Simulation:
        """The result in the shape of the designs."""
        histories = {n: rows.reshape(*shape, self.t.size) for n, rows in self.histories.items()}
        result = Simulation({"t": self.t, **histories})
        ways = np.where(self.ways == "", PANELS, self.ways)
        told = told_of(self.numbers["energy_residual"], self.rounded, rtol, ways)
        if self.without:
            count = f"{len(self.without)} of {self.size} designs"
            told += f"{SENSITIVITIES}NaN in {count}, where there are none"
        result["status"], result["message"] = self.status.reshape(shape), message(self.status) + told
        result["method"] = self.ways.reshape(shape)
        return Simulation({**result, **{n: values.reshape(shape) for n, values in self.numbers.items()}})


def simulate_rows(
    ask: Ask, given: Mapping[str, Any], starts: Mapping[str, Any], times: Any, threads: int | None
) -> Simulation:
    """The motions of all designs."""
    torque = starts["torque"]
    motor = torque.numbers if isinstance(torque, Motor) else {}
    varying = {n: value for n, value in {**given, **starts}.items() if callable(value)}
    arrays, flat, shape = arrays_of(given, starts, motor)
    t = np.linspace(0.0, ask.t_end, SAMPLES) if times is None else times
    size = int(np.prod(shape))
    setup, status = setup_of({**{name: np.zeros(size) for name in varying}, **flat}, ask.branch)
    for load in varying.values():
        if isinstance(load, OverY):
            status[np.isnan(zero_of(load, [flat[n] for n in LENGTHS], ask.branch))] = NO_START
    answers = Answers(size, t, ask, status)
    how = np.array([ask.rtol, ask.t_end, ask.max_steps])
    together = not (ask.until or ask.wrt or np.any(arrays["mu"]))
    over_angles = together and tables_alone(varying, 0.0)
    if over_angles:
        scalars = {n: float(array) if array.ndim == 0 else array for n, array in arrays.items() if n != "mu"}
        designs = designs_of({**scalars, **varying}, flat, setup, ask.branch)
        _over_angles(ask, designs, answers, how, threads)
    elif together and _is_function(torque) and varying.keys() == {"torque"}:
        _in_lanes(ask, torque, arrays, flat, setup, answers, how, threads)
    done = np.flatnonzero(answers.ways != "")
    if ask.names and done.size:
        state = {n: answers.histories[n][done] for n in MOTION}
        inputs = {n: column[done, None] for n, column in flat.items() if n not in (*STARTS, *motor)}
        forces = {n: load for n, load in varying.items() if n not in STARTS}
        everything: dict[str, Any] = {"branch": ask.branch, **state, **inputs, **forces}
        for name, values in evaluate(list(ask.names), **everything).items():
            answers.histories[name][done] = values
    _one_by_one(ask, given, starts, flat, varying, answers, not over_angles)
    return answers.result(shape, ask.rtol)


def _is_function(torque: Any) -> bool:
    """True for a user's function of t, theta and omega, or some of them."""
    return callable(torque) and not isinstance(torque, (Load, Motor)) and not follows_the_slider(torque)


def _one_by_one(
    ask: Ask,
    given: Mapping[str, Any],
    starts: Mapping[str, Any],
    flat: Mapping[str, Array],
    varying: Mapping[str, Any],
    answers: Answers,
    energy: bool,
) -> None:
    """The motions that nothing has answered yet."""
    motor = starts["torque"] if isinstance(starts["torque"], Motor) else None
    rows = np.flatnonzero((answers.status != NO_START) & (answers.ways == "")).tolist()
    if not rows:
        return
    with progress_bar(unit="designs") as watch:
        told = Portions(len(rows), "motions", watch)
        for row in rows:
            design: dict[str, Any] = {
                **{name: values[row].item() for name, values in flat.items()},
                **varying,
            }
            if motor is not None:
                design["torque"] = motor.of_design({n: design[n] for n in motor.numbers})
            inputs = {name: design.get(name) for name in given}
            ask.deadline.check()
            begin = {name: design[name] for name in starts}
            answers.put(row, one_motion(ask, inputs, begin, answers.t, energy))
            told.add(1)


def _over_angles(ask: Ask, designs: Designs, answers: Answers, how: Array, threads: int | None) -> None:
    """Fill in the motions that have an energy form."""
    size, t = answers.size, answers.t
    states = np.where(answers.status == NO_START, NO_START, -1).astype(np.int8)
    numbers = np.full((size, 4), nan)
    motion = [answers.histories[name] for name in MOTION]
    by_energy(designs, t, how, (*motion, states, numbers), threads, ask.deadline)
    done = np.flatnonzero((states >= 0) & (states != NO_START))
    answers.status[done] = states[done]
    answers.told(ENERGY, done, numbers)


def _in_lanes(
    ask: Ask,
    torque: Callable[..., Any],
    arrays: Mapping[str, Array],
    flat: Mapping[str, Array],
    setup: Array,
    answers: Answers,
    how: Array,
    threads: int | None,
) -> None:
    """Fill in the motions under a function that numba compiles."""
    arguments_of("torque", torque, ("t", "theta", "omega"))
    code = compiled(torque)
    scalars = {n: float(array) if array.ndim == 0 else array for n, array in arrays.items() if n != "mu"}
    family = DesignFamily(form_of({n: flat[n] for n in CENTRES if n in flat}), fixed_zeros(scalars))
    left = np.flatnonzero(answers.status < 0)
    kernel, rows = family.kernel(), setup[left]
    inputs = {name: column[left] for name, column in flat.items()}
    data = packed(kernel, {"branch": float(ask.branch), **inputs}, left.size)
    law = np.zeros((left.size, state.ENERGY + 1))
    law[:, state.KERNEL], law[:, state.HALF] = kernel.code.address, rows[:, 3]
    law[:, state.FIRST], law[:, state.LAST] = rows[:, 1], rows[:, 2]
    law[:, state.TORQUE], law[:, state.TORQUE + 1] = state.FUNCTION, code.address
    law[:, state.FORCE + 1], law[:, state.THETA0 :] = rows[:, 5], rows[:, 6:]
    histories = np.empty((left.size, len(MOTION), answers.t.size))
    outs = histories, answers.status[left], np.full((left.size, 4), nan)
    _run(law, data, answers.t, how, outs, threads, ask.deadline)
    for k, name in enumerate(MOTION):
        answers.histories[name][left] = histories[:, k]
    answers.status[left] = outs[1]
    numbers = np.full((answers.size, 4), nan)
    numbers[left] = outs[2]
    answers.told(PANELS, left[outs[1] != NO_START], numbers)


def arrays_of(
    given: Mapping[str, Any], starts: Mapping[str, Any], motor: Mapping[str, Any] = MappingProxyType({})
) -> tuple[dict[str, Array], dict[str, Array], tuple[int, ...]]:
    """The inputs that are no functions: as arrays, as rows with a value for each design; their shape.

    motor   the parameters of a motor
    """
    arrays = {
        name: as_array(name, 0.0 if value is None and name in LOADS else value, LENGTHS, ("simulate",))
        for name in (*LENGTHS, *LOADS)
        if not callable(value := given.get(name)) and (value is not None or name not in CENTRES)
    }
    arrays |= {n: number_or_array(STARTS[n], value) for n, value in starts.items() if not callable(value)}
    arrays |= {name: np.asarray(value, float) for name, value in motor.items()}
    empty = next((name for name, array in arrays.items() if not array.size), None)
    if empty is not None:
        raise ValueError(f"{empty}: an empty array; expected at least one design")
    shape = broadcast_shape(arrays)
    flat = {name: np.broadcast_to(array, shape).reshape(-1) for name, array in arrays.items()}
    return arrays, flat, shape


def setup_of(flat: Mapping[str, Array], branch: int) -> tuple[Array, NDArray[np.int8]]:
    """The rows that the kernel starts from (see `compiled`), and a status where nothing can start."""
    AB, BC, ec = (flat[name] for name in ("AB", "BC", "ec"))
    theta = flat["theta0"]
    status = np.full(theta.size, -1, np.int8)
    arcs = np.full((theta.size, 3), (-np.inf, np.inf, 0.0))
    good = np.logical_and.reduce([np.isfinite(column) for column in flat.values()])
    for name, least in LEAST.items():
        if name in flat:
            good &= flat[name] >= least
    status[~good] = NO_START
    for row in np.flatnonzero(good & (BC - AB - np.abs(ec) < 1e-12 * (AB + BC))):
        arc = _arc({name: float(column[row]) for name, column in flat.items()})
        if arc is None:
            status[row] = NO_START
        else:
            arcs[row] = arc
    loads = np.abs(flat["F_Y"]) * AB
    columns = (np.full(theta.size, float(branch)), *arcs.T, flat["torque"], flat["F_Y"], theta)
    return np.stack([*columns, flat["omega_start"], loads], axis=1), status


def _arc(values: Mapping[str, float]) -> tuple[float, float, float] | None:
    """The limit angles around the start and half their distance where the inertia grows there."""
    lengths = tuple(values[name] for name in LENGTHS)
    arc = arc_around(values["theta0"], *lengths)
    if arc is None or not inside(arc, values["theta0"]):
        return None
    smooth = isfinite(arc[0]) and grows(values) and theta_intervals(*lengths) != [(0.0, TURN)]
    return (*arc, 0.5 * (arc[1] - arc[0]) if smooth else 0.0)


def _run(
    law: Array,
    data: Array,
    t: Array,
    how: Array,
    outs: Sequence[Any],
    threads: int | None,
    deadline: Deadline,
) -> None:
    """Follow blocks of designs; designs are independent, so blocks do not change results."""
    limits, kernel, tables = how.copy(), motions(), (TABLE, nodes.table())

    def stop() -> None:  # the loops look at the most steps before each one
        limits[MOST_STEPS] = 0.0

    def block(a: int, b: int) -> None:
        kernel(law[a:b], data[a:b], t, limits, *tables, *(out[a:b] for out in outs))

    _in_parts(block, stop, len(law), LONGEST_PART, threads, deadline)


def _in_parts(
    block: Callable[[int, int], None],
    stop: Callable[[], None],
    size: int,
    longest: int,
    threads: int | None,
    deadline: Deadline,
) -> None:
    """Run parts of all designs on threads, with a bar where they may take long."""
    with progress_bar(unit="designs") if size > LARGE else nullcontext() as watch:
        told = Portions(size, "motions", watch)

        def part(a: int, b: int) -> None:
            block(a, b)
            told.add(b - a)

        stopped_early(lambda: run_parts(part, size, threads, 1, longest), stop, deadline)


def designs_of(scalars: Mapping[str, Any], flat: Mapping[str, Array], setup: Array, branch: int) -> Designs:
    """The designs as the energy form takes them."""
    own = {**flat, **scalars}
    loads = {name: value for name, value in own.items() if isinstance(value, Load)}
    inputs = {
        name: 0.0 if name in loads else value if isinstance(value, float) else flat[name]
        for name, value in scalars.items()
        if name not in STARTS
    }
    torque, force = (loads.get(name, flat.get(name)) for name in ("torque", "F_Y"))
    with np.errstate(invalid="ignore"):
        middle = np.where(np.isinf(setup[:, 1]), 0.0, 0.5 * (setup[:, 1] + setup[:, 2]))
        middle[np.isfinite(middle) & np.isfinite(setup[:, 1]) & ~(setup[:, 3] > 0.0)] = np.nan
    return Designs(inputs, branch, torque, force, flat["theta0"], flat["omega_start"], middle, setup[:, 3])


def by_energy(
    designs: Designs,
    t: Array,
    limits: Array,
    outs: Sequence[Any],
    threads: int | None,
    deadline: Deadline,
) -> None:
    """Fill in the motions that have an energy form; the status of the others stays below 0."""
    status, most = outs[3], limits[MOST_STEPS:].copy()
    rows = np.flatnonzero((status < 0) & served(designs))
    times, brief = np.append(t, limits[1]), np.minimum(most, BRIEF)

    def stop() -> None:
        most[0] = 0.0

    def follow(own: Any, most: Array) -> Any:
        """True for each row that has taken all pieces that it may."""
        part = designs.some(own) if own.size < status.size else designs
        found = follow_many(part, times, float(limits[0]), most)
        unfinished = (found.status == FAILED) & (most[0] < limits[MOST_STEPS])
        there = (found.status < NOT_HERE) & ~unfinished
        for out, values in zip(outs[:3], found[:3], strict=True):
            out[own[there]] = values[there, :-1]
        status[own[there]], outs[4][own[there], :4] = found.status[there], found.numbers[there]
        return unfinished

    if 0 < rows.size <= LONGEST_BLOCK:  # a thread of its own would take longer than short motions do
        rows = rows[follow(rows, brief)]
    if rows.size:

        def block(a: int, b: int) -> None:
            follow(rows[a:b], most)

        _in_parts(block, stop, rows.size, LONGEST_BLOCK, threads, deadline)


def message(status: NDArray[np.int8]) -> str:
    """The number of designs of each status, in words."""
    counts = Counter(status.tolist())
    words = {**WORDS, DONE: "reached t_end"}
    return f"{status.size} designs: " + ", ".join(f"{counts[c]} {words[c]}" for c in sorted(counts))
