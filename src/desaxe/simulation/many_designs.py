"""Many designs at once: broadcast, one compiled call over blocks of designs, histories of all of them."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from math import isfinite
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.arrays import as_array, broadcast_shape, number_or_array
from ..evaluation.evaluate import evaluate
from ..loads.load import Load
from ..mechanism.closed import TURN
from ..mechanism.closed.limits import theta_intervals
from ..mechanism.inputs import LEAST, Input
from ..mechanism.names import CENTRES, LENGTHS, LOADS
from ..runtime.threads import run_parts
from ..support.deadline import Deadline
from ..support.interrupts import stopped_early
from ..support.progress import Portions, progress_bar
from .checks import grows
from .coordinate import arc_around, inside
from .energy.many import NOT_HERE, follow_many
from .energy.panels import Designs
from .energy.serves import ENERGY, INTEGRATOR, PANELS, no_energy_form, served, some_of
from .loops import nodes, tableau
from .loops.compiled import DesignFamily, kernel_of
from .loops.torque import compiled
from .model import fixed_zeros, form_of
from .residual import told_of
from .result import DONE, FAILED, NO_START, WORDS, Simulation

Array = NDArray[np.float64]
MOTION, NUMBERS = ("theta", "omega", "alpha"), ("t_last", "energy_residual", "work")
SAMPLES = 101  # instants of the histories by default
LONGEST_PART = 64  # designs in one native call, that threads share the work evenly
BRIEF = 500.0  # pieces of motions that run at once
LONGEST_BLOCK = 256  # the same in the energy form: its arrays stay in the cache
LONGEST, MOST_STEPS = 2, 3  # places in `how`
BY_PANELS = 4  # the place of their number in `numbers`
TORQUE = 4  # its place in a row of `setup`: a number, or the address of its function
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


def simulate_many(
    given: Mapping[str, Any],
    starts: Mapping[str, Any],
    branch: int,
    names: Sequence[str],
    times: Any,
    how: Sequence[float],
    threads: int | None,
    deadline: Deadline,
    method: str | None,
) -> Simulation:
    """The motions; how: relative tolerance, t_end, longest step, most steps."""
    arrays, flat, shape = arrays_of(given, starts)
    del arrays["mu"], flat["mu"]  # designs with friction run one after the other
    torque = compiled(starts["torque"]) if callable(starts["torque"]) else None
    scalars = {name: float(array) if array.ndim == 0 else array for name, array in arrays.items()}
    family = DesignFamily(form_of(given_centres(given)), fixed_zeros(scalars))
    t = np.linspace(0.0, how[1], SAMPLES) if times is None else times
    setup, status = setup_of(flat | ({} if torque is None else {"torque": 0.0 * flat["theta0"]}), branch)
    rows = np.stack([flat[name] for name in family.inputs], axis=1)
    outs = (
        *(np.full((status.size, t.size), np.nan) for _ in range(3)), status, np.full((status.size, 5), np.nan)
    )  # fmt: skip
    ways = np.where(status < 0, INTEGRATOR, "")
    limits = np.array([*how, method != INTEGRATOR], dtype=np.float64)
    if method in (None, ENERGY) and torque is None and limits[LONGEST] == np.inf:
        by_energy(designs_of(scalars, flat, setup, branch), t, limits, outs, threads, deadline)
        ways[(status >= 0) & (status != NO_START)] = ENERGY
        if method == ENERGY and (status < 0).any():
            raise ValueError(no_energy_form(some_of(np.flatnonzero(status < 0), status.size)))
    left = np.flatnonzero(status < 0)
    if left.size:
        own = tuple(out[left] for out in outs)
        if torque is not None:
            setup[:, TORQUE] = torque.address
        _run(
            kernel_of(family, torque is not None),
            rows[left],
            setup[left],
            (t, limits),
            own,
            threads,
            deadline,
        )
        for out, part in zip(outs, own, strict=True):
            out[left] = part
        ways[left[own[-1][:, BY_PANELS] > 0.0]] = PANELS
    histories: dict[str, Any] = {
        name: out.reshape(*shape, t.size) for name, out in zip(MOTION, outs[:3], strict=True)
    }
    if names:
        inputs: dict[str, Any] = {n: array[..., None] for n, array in arrays.items() if n not in STARTS}
        histories |= evaluate(list(names), branch=branch, **histories, **inputs)
    numbers = dict(zip(NUMBERS, outs[4].T, strict=False))
    return result_of(shape, t, histories, numbers, status, ways, outs[4][:, 3], how[0])


def given_centres(given: Mapping[str, Any]) -> dict[str, Any]:
    """The centres of mass that are given."""
    return {name: given[name] for name in CENTRES if given.get(name) is not None}


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
    kernel: Callable[..., object],
    rows: Array,
    setup: Array,
    shared: Sequence[Array],
    outs: Sequence[Any],
    threads: int | None,
    deadline: Deadline,
) -> None:
    """Run the kernel over blocks of designs; designs are independent, so blocks do not change results."""
    A, C, last = tableau.A, tableau.C, tableau.STAGES
    step = A[:last, :last].copy(), tableau.B, C[:last], tableau.E3, tableau.E5
    tables = (*step, tableau.D, A[last + 1 :], C[last + 1 :], nodes.table())

    how, size = shared[1], len(setup)

    def stop() -> None:  # the kernel looks at the most steps before each one
        how[MOST_STEPS] = 0.0

    def block(a: int, b: int) -> None:
        kernel(rows[a:b], setup[a:b], *shared, *tables, *(out[a:b] for out in outs))

    _in_parts(block, stop, size, LONGEST_PART, threads, deadline)


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
    slopes: Sequence[Array] = (),
) -> None:
    """Fill in the motions that have an energy form; the status of the others stays below 0.

    slopes   where designs have parameters of derivatives: as `Histories`
    """
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
        status[own[there]], outs[4][own[there], :BY_PANELS] = found.status[there], found.numbers[there]
        for out, values in zip(slopes, found.by or (), strict=False):
            out[own[there]] = values[there] if values.ndim == 2 else values[there, :, :-1]
        return unfinished

    if 0 < rows.size <= LONGEST_BLOCK:  # a thread of its own would take longer than short motions do
        rows = rows[follow(rows, brief)]
    if rows.size:

        def block(a: int, b: int) -> None:
            follow(rows[a:b], most)

        _in_parts(block, stop, rows.size, LONGEST_BLOCK, threads, deadline)


def result_of(
    shape: tuple[int, ...],
    t: Array,
    histories: Mapping[str, Array],
    numbers: Mapping[str, Array],
    status: NDArray[np.int8],
    ways: Any,
    rounded: Array,
    rtol: float,
    note: str = "",
) -> Simulation:
    """The result in the shape of the designs, from a row or a number of each; note: the message's end."""
    result = Simulation({"t": t, **{name: rows.reshape(*shape, t.size) for name, rows in histories.items()}})
    told = told_of(numbers["energy_residual"], rounded, rtol, np.where(ways == "", INTEGRATOR, ways))
    result["status"], result["message"] = status.reshape(shape), message(status) + told + note
    result["method"] = ways.reshape(shape)
    return Simulation({**result, **{name: values.reshape(shape) for name, values in numbers.items()}})


def message(status: NDArray[np.int8]) -> str:
    """The number of designs of each status, in words."""
    counts = Counter(status.tolist())
    words = {**WORDS, DONE: "reached t_end"}
    return f"{status.size} designs: " + ", ".join(f"{counts[c]} {words[c]}" for c in sorted(counts))
