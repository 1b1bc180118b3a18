"""Many designs at once: in compiled loops where they serve, else row by row."""

from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from math import inf, isfinite, nan
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiler.llvm.loops import address
from ..evaluation.arrays import as_array, broadcast_shape, number_or_array
from ..evaluation.evaluate import evaluate
from ..loads.angles import zero_of
from ..loads.arguments import arguments_of
from ..loads.load import Load, OverY, TableOverTheta
from ..loads.motors import Kloss, Motor
from ..mechanism.closed import TURN
from ..mechanism.closed.angles import dead_centres
from ..mechanism.closed.limits import theta_intervals
from ..mechanism.inputs import LEAST, Input
from ..mechanism.names import CENTRES, LENGTHS, LOADS
from ..runtime.threads import run_parts
from ..support.deadline import Deadline
from ..support.interrupts import stopped_early
from ..support.progress import Portions, progress_bar
from .checks import TIME_AND_CRANK, follows_the_slider, grows
from .coordinate import arc_around, inside
from .history import PANELS
from .loops import nodes, state
from .loops.compiled import DesignFamily, motions, packed
from .loops.motions import NOT_HERE
from .loops.torque import compiled
from .model import fixed_zeros, form_of
from .panel import TABLE
from .pieces import Sheet, meeting_angles, sheet_over_Y, table_sheet
from .request import Ask, one_motion
from .residual import TELLS, told_of
from .result import DONE, NO_START, SENSITIVITIES, WORDS, Simulation

Array = NDArray[np.float64]
DRIVE = ("torque", "F_Y", "F_X")
MOTION, NUMBERS = ("theta", "omega", "alpha"), ("t_last", "energy_residual", "work")
SAMPLES = 101  # instants of the histories by default
PART = 64  # designs in one native call, that threads share the work evenly
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
    arcs, status = arcs_of(flat)
    for load in varying.values():
        if isinstance(load, OverY):
            status[np.isnan(zero_of(load, [flat[n] for n in LENGTHS], ask.branch))] = NO_START
    answers = Answers(status.size, t, ask, status)
    if not ask.wrt and all(_in_loops(name, value) for name, value in varying.items()):
        _together(ask, varying, arrays, flat, arcs, answers, threads)
    done = np.flatnonzero(answers.ways != "")
    if ask.names and done.size:
        state = {n: answers.histories[n][done] for n in MOTION}
        inputs = {n: column[done, None] for n, column in flat.items() if n not in (*STARTS, *motor)}
        forces = {n: load for n, load in varying.items() if n not in STARTS}
        everything: dict[str, Any] = {"branch": ask.branch, **state, **inputs, **forces}
        for name, values in evaluate(list(ask.names), **everything).items():
            answers.histories[name][done] = values
    _one_by_one(ask, given, starts, flat, varying, answers)
    return answers.result(shape, ask.rtol)


def _in_loops(name: str, load: Any) -> bool:
    """True for what compiled loops follow: tables, motors, and functions of t, theta and omega as a torque."""
    if isinstance(load, (Load, Motor)):
        return isinstance(load, (TableOverTheta, OverY, Motor))
    return name == "torque" and not follows_the_slider(load)


def _one_by_one(
    ask: Ask,
    given: Mapping[str, Any],
    starts: Mapping[str, Any],
    flat: Mapping[str, Array],
    varying: Mapping[str, Any],
    answers: Answers,
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
            answers.put(row, one_motion(ask, inputs, begin, answers.t))
            told.add(1)


def _together(
    ask: Ask,
    varying: Mapping[str, Any],
    arrays: Mapping[str, Array],
    flat: Mapping[str, Array],
    arcs: Array,
    answers: Answers,
    threads: int | None,
) -> None:
    """Fill in the motions that compiled loops follow."""
    left = np.flatnonzero(answers.status < 0)
    flat, arcs = {name: column[left] for name, column in flat.items()}, arcs[left]
    scalars = {n: float(array) if array.ndim == 0 else array for n, array in arrays.items()}
    family = DesignFamily(form_of(flat), fixed_zeros({**dict.fromkeys(LOADS, nan), **scalars}))
    kernel = family.kernel()
    inputs = {"branch": float(ask.branch), **dict.fromkeys(("F_X", "F_Y"), nan), **flat}
    data = packed(kernel, inputs, left.size)
    law = np.zeros((left.size, state.ENERGY + 1))
    law[:, state.KERNEL], law[:, state.HALF : state.TORQUE] = kernel.code.address, arcs
    law[:, state.LEANS], law[:, state.MU], law[:, state.RUBS] = ask.branch, flat["mu"], flat["mu"] != 0.0
    law[:, state.TINY] = 1e-9 * flat["AB"]
    law[:, state.THETA0], law[:, state.OMEGA_START] = flat["theta0"], flat["omega_start"]
    if flat["mu"].any():
        guide = family.guide()
        contact = packed(guide, inputs, left.size)
        law[:, state.CONTACT] = guide.code.address
        law[:, state.CONTACT_DATA] = address(contact) + contact.strides[0] * np.arange(left.size)
    pieces = PiecesOfDesigns(flat, ask.branch, arcs, law)
    codes = [pieces.add(k, varying.get(name, flat.get(name))) for k, name in enumerate(DRIVE)]
    kinks = pieces.kinks(ask.until)
    timed = codes[0] is not None and "t" in arguments_of("torque", varying["torque"], TIME_AND_CRANK)
    how = np.array([ask.rtol, ask.t_end, ask.max_steps, timed], float)
    outs = np.empty((left.size, len(MOTION), answers.t.size)), answers.status[left], np.full((left.size, 4), nan)
    known = law, data, kinks, pieces.sheets
    _run(known, pieces.knots, answers.t, how, outs, threads, ask.deadline)
    here = left[outs[1] != NOT_HERE]
    for k, name in enumerate(MOTION):
        answers.histories[name][here] = outs[0][outs[1] != NOT_HERE, k]
    answers.status[here] = outs[1][outs[1] != NOT_HERE]
    numbers = np.full((answers.size, 4), nan)
    numbers[left] = outs[2]
    answers.told(PANELS, here[answers.status[here] != NO_START], numbers)


class PiecesOfDesigns:
    """The pieces of the loads of designs, and the angles at which they meet, as compiled loops take them."""

    def __init__(self, flat: Mapping[str, Array], branch: int, arcs: Array, law: Array) -> None:
        self.flat, self.branch, self.arcs, self.law = flat, branch, arcs[:, 1:], law
        self.size, self.knots = len(law), np.empty(0)
        self.sheets, self.angles = np.empty((self.size, 0, 1 + 2 * state.SLOTS)), [np.empty((self.size, 0, 2))]

    def add(self, k: int, load: Any) -> Any:
        """Write torque or force into the law; the machine code of a function."""
        law, first, arm = self.law, state.TORQUE + k * state.SLOTS, self.flat["AB"] if k else 1.0
        size, code = 0.0, None
        if isinstance(load, np.ndarray):
            law[:, first + 1], size = load, load
        elif isinstance(load, Kloss):
            most, slip, speed, gear = (self.flat[name] for name in load.numbers)
            law[:, first : first + 5] = np.stack(
                [np.full(self.size, state.KLOSS), gear * np.copysign(most, speed), slip, speed, gear], axis=1
            )
            size = load.both(self.flat["omega_start"], self.flat)[0]
        elif isinstance(load, (Load, Motor)):
            sheet = self._sheet(load)
            law[:, state.SHEETS + 3 * k : state.SHEETS + 3 * k + 3] = (
                self.sheets.shape[1], sheet.rows.shape[1], sheet.period,
            )  # fmt: skip
            self.sheets = np.concatenate(
                [self.sheets, np.broadcast_to(sheet.rows, (self.size, *sheet.rows.shape[1:]))], axis=1
            )
            size = np.abs(sheet.rows[:, :, 3]).max()
        else:
            code = compiled(load)
            law[:, first], law[:, first + 1] = state.FUNCTION, code.address
        if k < 2:
            law[:, state.ENERGY] = np.maximum(law[:, state.ENERGY], np.abs(size) * arm)
        return code

    def _sheet(self, load: Any) -> Sheet:
        if isinstance(load, Motor):
            self.knots = np.array(load.knots)
        elif isinstance(load, TableOverTheta):
            knots = np.array(load.table.knots)
            self.angles.append(np.stack(np.broadcast_arrays(knots, load.period), axis=-1)[None])
        else:
            lengths = [self.flat[name] for name in LENGTHS]
            angles = meeting_angles(load, lengths, self.branch)
            self.angles.append(np.stack(np.broadcast_arrays(angles, TURN), axis=-1))
            return sheet_over_Y(load, lengths, self.branch, self.arcs, self._slider)
        return table_sheet(load)

    def _slider(self, theta: Array) -> tuple[Any, Any]:
        inputs = {name: self.flat[name][:, None] for name in LENGTHS}
        both = evaluate(["Y", "Y_wrt_theta"], theta=theta, branch=self.branch, **inputs)
        return both["Y"], both["Y_wrt_theta"]

    def kinks(self, until: Sequence[float]) -> Array:
        """The angles at which motions are cut, their periods, and the status of a motion that ends there."""
        if self.flat["mu"].any():
            centres = dead_centres([self.flat[name] for name in LENGTHS])
            self.angles.append(np.stack(np.broadcast_arrays(centres, TURN), axis=-1))
        cuts = [np.broadcast_to(part, (self.size, *part.shape[1:])) for part in self.angles]
        ends = np.array([(angle, np.inf, DONE) for angle in until]).reshape(-1, 3)
        every = np.concatenate(cuts, axis=1)
        every = np.concatenate([every, np.full((*every.shape[:2], 1), -1.0)], axis=2)
        every[np.isnan(every[:, :, 0])] = -np.inf, np.inf, -1.0
        return np.concatenate([every, np.broadcast_to(ends, (self.size, *ends.shape))], axis=1)


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


def arcs_of(flat: Mapping[str, Array]) -> tuple[Array, NDArray[np.int8]]:
    """Half of the arc and both limit angles of designs, and a status where nothing can start."""
    AB, BC, ec = (flat[name] for name in ("AB", "BC", "ec"))
    status = np.full(AB.size, -1, np.int8)
    arcs = np.full((AB.size, 3), (0.0, -np.inf, np.inf))
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
    return arcs, status


def _arc(values: Mapping[str, float]) -> tuple[float, float, float] | None:
    """Half of the arc, where the inertia grows at its ends, and the limit angles around the start."""
    lengths = tuple(values[name] for name in LENGTHS)
    arc = arc_around(values["theta0"], *lengths)
    if arc is None or not inside(arc, values["theta0"]):
        return None
    smooth = isfinite(arc[0]) and grows(values) and theta_intervals(*lengths) != [(0.0, TURN)]
    return 0.5 * (arc[1] - arc[0]) if smooth else 0.0, *arc


def _run(
    known: Sequence[Array],
    knots: Array,
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
        law, data, kinks, sheets = (np.ascontiguousarray(part[a:b]) for part in known)
        kernel(law, data, kinks, knots, sheets, t, limits, *tables, *(out[a:b] for out in outs))

    size = len(known[0])
    with progress_bar(unit="designs") if size > LARGE else nullcontext() as watch:
        told = Portions(size, "motions", watch)

        def part(a: int, b: int) -> None:
            block(a, b)
            told.add(b - a)

        stopped_early(lambda: run_parts(part, size, threads, 1, PART), stop, deadline)


def message(status: NDArray[np.int8]) -> str:
    """The number of designs of each status, in words."""
    counts = Counter(status.tolist())
    words = {**WORDS, DONE: "reached t_end"}
    return f"{status.size} designs: " + ", ".join(f"{counts[c]} {words[c]}" for c in sorted(counts))
