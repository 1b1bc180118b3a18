"""Many designs at once: in compiled loops where they serve, else row by row."""

from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from copy import copy
from math import inf, nan
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
from ..mechanism.closed.angles import dead_centres
from ..mechanism.inputs import LEAST, Input
from ..mechanism.names import CENTRES, LENGTHS, LOADS, MASSES
from ..runtime.threads import run_parts
from ..support.deadline import Deadline
from ..support.interrupts import stopped_early
from ..support.progress import Portions, progress_bar
from .checks import SMALL, follows_the_slider, refuse_function
from .coordinate import coordinate_of
from .drive import ROLES, Acting
from .events import NEVER
from .history import PANELS, TELLS, energy_residual, told_of
from .loops import law
from .loops.compiled import BRIEF, DesignFamily, loops, records_of, run
from .loops.march import SUMS
from .loops.motions import SUMMED, designs
from .loops.torque import compiled
from .march import Ask
from .model import fixed_zeros, form_of
from .panel import TABLE
from .pieces import FunctionPieces, LawNumbers, compiles
from .request import one_motion
from .result import DONE, LIMIT, NO_INERTIA, NO_START, SENSITIVITIES, WORDS, Simulation

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
    """The answers of all designs: histories, numbers, statuses, a row each.

    rounded   the residual of rounding, infinite where nothing is said of a residual
    without   designs of which a derivative does not exist
    """

    def __init__(self, size: int, t: Array, ask: Ask, status: NDArray[np.int8]) -> None:
        along = [f"{name}_wrt_{p}" for p in ask.wrt for name in ("theta", "omega")]
        ends = [f"{name}_wrt_{p}" for p in ask.wrt for name in ("t_last", "work")]
        self.size, self.t, self.status = size, t, status
        self.histories = {n: np.full((size, t.size), nan) for n in (*MOTION, *ask.names, *along)}
        self.numbers = {name: np.full(size, nan) for name in (*NUMBERS, *ends)}
        self.done, self.rounded = np.zeros(size, bool), np.full(size, inf)
        self.without: list[int] = []

    def put(self, row: int, result: Simulation) -> None:
        """Put in the answer of one design."""
        count = len(result["t"])
        for name, history in self.histories.items():
            history[row, :count] = result[name]
        self.status[row], self.done[row] = result["status"], True
        self.rounded[row] = 0.0 if TELLS in result["message"] else inf
        if SENSITIVITIES in result["message"]:
            self.without.append(row)
        for name, column in self.numbers.items():
            column[row] = result[name]

    def take(self, rows: Any, numbers: Array, rounded: Array) -> None:
        """Take over the numbers of designs that went together, in the order of NUMBERS."""
        self.done[rows], self.rounded[rows] = True, rounded
        for name, column in zip(NUMBERS, numbers.T, strict=True):
            self.numbers[name][rows] = column

    def result(self, shape: tuple[int, ...], rtol: float) -> Simulation:
        """The result in the shape of the designs."""
        histories = {n: rows.reshape(*shape, self.t.size) for n, rows in self.histories.items()}
        result = Simulation({"t": self.t, **histories})
        told = told_of(self.numbers["energy_residual"], self.rounded, rtol)
        if self.without:
            count = f"{len(self.without)} of {self.size} designs"
            told += f"{SENSITIVITIES}NaN in {count}, where there are none"
        result["status"], result["message"] = self.status.reshape(shape), message(self.status) + told
        result["method"] = np.full(shape, PANELS)
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
    done = np.flatnonzero(answers.done)
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
    """True for what compiled loops follow: tables, motors, and a torque of t, theta and omega."""
    if isinstance(load, (Load, Motor)):
        return all(isinstance(part, float) or compiles(part) for _, part in Acting(load).terms)
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
    rows = np.flatnonzero((answers.status != NO_START) & ~answers.done).tolist()
    if not rows:
        return
    with progress_bar(unit="designs") as watch:
        message = Portions(len(rows), "motions", watch)
        for row in rows:
            design: dict[str, Any] = {
                **{name: values[row].item() for name, values in flat.items()},
                **varying,
            }
            if motor is not None:
                design["torque"] = motor.of_design({n: design[n] for n in motor.numbers})
            inputs = {name: design.get(name) for name in given}
            begin = {name: design[name] for name in starts}
            # A motion lifts its deadline where it ends.
            answers.put(row, one_motion(ask._replace(deadline=copy(ask.deadline)), inputs, begin, answers.t))
            ask.deadline.check()
            message.add(1)


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
    code, timed, torque = None, False, varying.get("torque", Motor)
    if not isinstance(torque, (Load, Motor, type)):
        code = compiled(torque)
        timed = "t" in arguments_of("torque", torque, ROLES)
    terms: list[tuple[float, float, Any]] = []
    for arm, name in enumerate(DRIVE):
        load = varying.get(name)
        if arm == 0 and code is not None:
            terms.append((arm, 1.0, FunctionPieces((code.address,) * 2)))
        elif load is None and flat[name].any():
            terms.append((arm, 1.0, flat[name]))
        elif load is not None:
            parts = Acting(load).terms
            terms += [(arm, f, np.full(left.size, p) if isinstance(p, float) else p) for f, p in parts]
    laws = LawNumbers(flat, ask.branch, arcs, family, terms)
    laws.law[:, law.THETA0], laws.law[:, law.OMEGA_START] = flat["theta0"], flat["omega_start"]
    laws.law[:, law.WAITS] = 2.0 if timed else 1.0 if varying else 0.0
    how = np.array([ask.rtol, ask.t_end, ask.max_steps, *ask.knots], float)
    histories = np.empty((left.size, len(MOTION), answers.t.size))
    status, numbers = answers.status[left], np.full((left.size, SUMMED + SUMS), nan)
    known = {
        "law": laws.law,
        "data": laws.data,
        "sheets": laws.sheets,
        "kinks": kinks_of(flat, ask.branch, ask.until),
    }
    outs = {"history": histories, "status": status, "numbers": numbers}
    _run({**known, **outs}, {"knots": laws.knots, "times": answers.t, "how": how}, threads, ask.deadline)
    for k, name in enumerate(MOTION):
        answers.histories[name][left] = histories[:, k]
    answers.status[left], moved = status, status != NO_START
    t_last, work, steps = numbers.T[:SUMMED]
    residual, rounded = energy_residual(numbers[:, SUMMED:], status == LIMIT, steps)
    answers.take(left[moved], np.stack([t_last, residual, work], axis=1)[moved], rounded[moved])


def kinks_of(flat: Mapping[str, Array], branch: int, until: Sequence[float]) -> Array:
    """The angles at which motions are cut, their periods, and the status of a motion that ends there."""
    size, lengths = flat["AB"].size, [flat[name] for name in LENGTHS]
    centres = dead_centres(lengths) if flat["mu"].any() else np.empty((size, 0))
    ends = np.broadcast_to(np.array(until).reshape(1, -1), (size, len(until)))
    gone = _vanishing(flat, branch)
    every = [_marks(centres, TURN, NEVER), _marks(ends, np.inf, DONE), _marks(gone, TURN, NO_INERTIA)]
    kinks = np.concatenate(every, axis=1)
    kinks[np.isnan(kinks[:, :, 0])] = -np.inf, np.inf, NEVER
    return kinks


def _vanishing(flat: Mapping[str, Array], branch: int) -> Array:
    """Both sides of the dead centres at which no inertia is left (see `Model.vanishing`)."""
    light = (flat["I_crank"] == 0.0) & ((flat["m_crank"] == 0.0) | (flat.get("r_crank", 1.0) == 0.0))
    if not light.any():
        return np.empty((light.size, 0))
    angles = dead_centres([flat[name] for name in LENGTHS])
    theta = np.hstack([angles, np.broadcast_to(TURN * np.arange(16) / 16, (light.size, 16))])
    names = (*LENGTHS, *MASSES, *CENTRES)
    inputs: dict[str, Any] = {name: flat[name][:, None] for name in names if name in flat}
    inertia = evaluate("M_eff", theta=theta, branch=branch, **inputs)
    least = 1e-12 * np.nanmax(inertia, axis=1, keepdims=True, initial=0.0)
    gone = np.where((inertia <= least)[:, :4], angles, np.nan)
    return np.hstack([gone - SMALL, gone + SMALL])


def _marks(angles: Array, period: float, status: int) -> Array:
    """Rows of angles with their period and status."""
    return np.stack(np.broadcast_arrays(angles, period, float(status)), axis=-1)


def arrays_of(
    inputs: Mapping[str, Any], starts: Mapping[str, Any], motor: Mapping[str, Any] = MappingProxyType({})
) -> tuple[dict[str, Array], dict[str, Array], tuple[int, ...]]:
    """The inputs that are no functions: as arrays, as rows with a value for each design; their shape.

    motor   the parameters of a motor
    """
    for name in (*LENGTHS, *LOADS):
        refuse_function(name, inputs.get(name))
    arrays = {
        name: as_array(name, 0.0 if value is None and name in LOADS else value, LENGTHS, ("simulate",))
        for name in (*LENGTHS, *LOADS)
        if not callable(value := inputs.get(name)) and (value is not None or name not in CENTRES)
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
        design = {name: float(column[row]) for name, column in flat.items()}
        coordinate = coordinate_of(design, design["theta0"])
        if coordinate is None:
            status[row] = NO_START
        else:
            arcs[row] = coordinate.half, coordinate.first, coordinate.last
    return arcs, status


def _run(
    each: Mapping[str, Any], shared: Mapping[str, Array], threads: int | None, deadline: Deadline
) -> None:
    """Follow blocks of designs; designs are independent, so blocks do not change results."""
    size, how = len(each["law"]), shared["how"]
    loops(designs)

    def stop() -> None:  # the loops look at the most steps before each call for panels
        how[MOST_STEPS] = 0.0

    def block(a: int, b: int) -> None:
        memory = records_of(BRIEF, each["law"].shape[1])
        own = {name: np.ascontiguousarray(part[a:b]) for name, part in each.items()}
        run(designs, table=TABLE, **memory, **shared, **own)

    with progress_bar(unit="designs") if size > LARGE else nullcontext() as watch:
        message = Portions(size, "motions", watch)

        def part(a: int, b: int) -> None:
            block(a, b)
            message.add(b - a)

        stopped_early(lambda: run_parts(part, size, threads, 1, PART), stop, deadline)


def message(status: NDArray[np.int8]) -> str:
    """The number of designs of each status, in words."""
    counts = Counter(status.tolist())
    words = {**WORDS, DONE: "reached t_end"}
    return f"{status.size} designs: " + ", ".join(f"{counts[c]} {words[c]}" for c in sorted(counts))
