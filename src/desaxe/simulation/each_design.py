"""Many designs under loads that vary with the motion, or with friction: one after the other, stacked."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.evaluate import evaluate
from ..loads.angles import zero_of
from ..loads.load import OverY
from ..loads.motors import Motor
from ..mechanism.names import LENGTHS
from ..support.deadline import Deadline
from ..support.progress import Portions, progress_bar
from .energy.serves import ENERGY, INTEGRATOR, no_energy_form, some_of, tables_alone
from .many_designs import (
    MOTION,
    NUMBERS,
    SAMPLES,
    STARTS,
    arrays_of,
    by_energy,
    designs_of,
    result_of,
    setup_of,
)  # fmt: skip
from .residual import TELLS
from .result import NO_START, SENSITIVITIES, Simulation

Array = NDArray[np.float64]
OneDesign = Callable[[Mapping[str, Any], Mapping[str, Any], Array, str | None], Simulation]


def simulate_each(
    run: OneDesign,
    given: Mapping[str, Any],
    starts: Mapping[str, Any],
    branch: int,
    names: Sequence[str],
    wrt: Sequence[str],
    times: Any,
    end: float,
    how: Sequence[float],
    threads: int | None,
    deadline: Deadline,
    method: str | None,
    together: bool,
) -> Simulation:
    """The motions in the shape of the designs, as `simulate_many` gives them.

    run        simulates one design, from its inputs, its starts, the instants and the method
    together   whether those that have an energy form are followed at once, up to the last instant
    """
    varying = {n: value for n, value in {**given, **starts}.items() if callable(value)}
    motor = starts["torque"] if isinstance(starts["torque"], Motor) else None
    arrays, flat, shape = arrays_of(given, starts, {} if motor is None else motor.numbers)
    t = np.linspace(0.0, end, SAMPLES) if times is None else times
    size = int(np.prod(shape))
    still = {name: np.zeros(size) for name in varying}
    setup, status = setup_of({**still, **flat}, branch)
    of_motor = {} if motor is None else {name: flat.pop(name) for name in motor.numbers}
    for load in varying.values():
        if isinstance(load, OverY):
            status[np.isnan(zero_of(load, [flat[n] for n in LENGTHS], branch))] = NO_START
    along = [f"{name}_wrt_{p}" for p in wrt for name in ("theta", "omega")]
    ends = [f"{name}_wrt_{p}" for p in wrt for name in ("t_last", "work")]
    histories = {n: np.full((size, t.size), np.nan) for n in (*MOTION, *names, *along)}
    numbers = {name: np.full(size, np.nan) for name in (*NUMBERS, *ends)}
    ways = np.full(size, "", "U6")
    rounded = np.full(size, np.inf)  # or 0 where the residual of a design is told
    without = []  # designs of which a derivative does not exist

    def follow(row: int) -> None:
        design = {name: values[row].item() for name, values in flat.items()} | varying
        if motor is not None:
            design["torque"] = motor.of_design({n: values[row].item() for n, values in of_motor.items()})
        inputs = {name: design.get(name) for name in given}
        found = run(inputs, {name: design[name] for name in starts}, t, way)
        count = len(found["t"])
        for name, history in histories.items():
            history[row, :count] = found[name]
        status[row], ways[row] = found["status"], found["method"]
        rounded[row] = 0.0 if TELLS in found["message"] else np.inf
        if SENSITIVITIES in found["message"]:
            without.append(row)
        for name, column_of in numbers.items():
            column_of[row] = found[name]

    motion = [histories[name] for name in MOTION]
    together = (
        together
        and method in (None, ENERGY)
        and how[2] == np.inf
        and "mu" not in wrt
        and tables_alone(varying, arrays["mu"])
    )
    way = INTEGRATOR if together else method
    if together:
        scalars = {n: float(array) if array.ndim == 0 else array for n, array in arrays.items() if n != "mu"}
        states = np.where(status == NO_START, NO_START, -1).astype(np.int8)
        told_numbers = np.full((size, 4), np.nan)
        designs = designs_of({**scalars, **varying}, flat, setup, branch)._replace(wrt=tuple(wrt))
        slopes = [np.full((size, len(wrt), t.size), np.nan) for _ in range(2)]
        slopes += [np.full((size, len(wrt)), np.nan) for _ in range(2)]
        by_energy(designs, t, np.array(how), (*motion, states, told_numbers), threads, deadline, slopes)
        done = np.flatnonzero((states >= 0) & (states != NO_START))
        status[done], ways[done], rounded[done] = states[done], ENERGY, told_numbers[done, 3]
        for name, column in zip(NUMBERS, told_numbers.T, strict=False):
            numbers[name][done] = column[done]
        for k, p in enumerate(wrt):
            for name, values in zip(("theta", "omega", "t_last", "work"), slopes, strict=True):
                table = numbers if values.ndim == 2 else histories
                table[f"{name}_wrt_{p}"][done] = values[done, k]
        known = np.isfinite(slopes[0]).sum(axis=2) >= np.isfinite(motion[0]).sum(axis=1)[:, None]
        known &= np.isfinite(slopes[3])
        without += done[~known[done].all(axis=1)].tolist()
        if names and done.size:
            state = dict(zip(MOTION, (history[done] for history in motion), strict=True))
            inputs = {n: array[done, None] for n, array in flat.items() if n not in STARTS}
            forces = {n: load for n, load in varying.items() if n not in STARTS}
            everything: dict[str, Any] = {"branch": branch, **state, **inputs, **forces}
            for name, values in evaluate(list(names), **everything).items():
                histories[name][done] = values
        if method == ENERGY and (states < 0).any():
            raise ValueError(no_energy_form(some_of(np.flatnonzero(states < 0), size)))
    rows = np.flatnonzero((status != NO_START) & (ways == "")).tolist()
    with progress_bar(unit="designs") as watch:
        told = Portions(len(rows), "motions", watch)
        for row in rows:
            follow(row)
            told.add(1)
    note = f"{SENSITIVITIES}NaN in {len(without)} of {size} designs, where there are none" if without else ""
    return result_of(shape, t, histories, numbers, status, ways, rounded, how[0], note)
