"""Many designs under loads that vary with the motion, or with friction: one after the other, stacked."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.arrays import as_array, broadcast_shape, number_or_array
from ..mechanism.names import CENTRES, LENGTHS, LOADS
from ..support.progress import Portions, progress_bar
from .many_designs import SAMPLES, STARTS, message, starting
from .residual import TELLS, told_of
from .result import NO_START, SENSITIVITIES, Simulation

Array = NDArray[np.float64]
OneDesign = Callable[[Mapping[str, Any], Mapping[str, Any], Array], Simulation]


def simulate_each(
    run: OneDesign,
    given: Mapping[str, Any],
    starts: Mapping[str, Any],
    branch: int,
    names: Sequence[str],
    wrt: Sequence[str],
    times: Any,
    end: float,
    rtol: float,
) -> Simulation:
    """The motions in the shape of the designs, as `simulate_many` gives them.

    run   simulates one design, from its inputs, its starts and the instants
    """
    varying = {n: value for n, value in {**given, **starts}.items() if callable(value)}
    arrays = {
        n: as_array(n, 0.0 if value is None else value, LENGTHS, ("simulate",))
        for n in (*LENGTHS, *LOADS)
        if n not in varying and ((value := given.get(n)) is not None or n not in CENTRES)
    }
    arrays |= {n: number_or_array(STARTS[n], value) for n, value in starts.items() if n not in varying}
    empty = next((name for name, array in arrays.items() if not array.size), None)
    if empty is not None:
        raise ValueError(f"{empty}: an empty array; expected at least one design")
    shape = broadcast_shape(arrays)
    flat = {name: np.broadcast_to(array, shape).reshape(-1) for name, array in arrays.items()}
    t = np.linspace(0.0, end, SAMPLES) if times is None else times
    size = int(np.prod(shape))
    still = {name: np.zeros(size) for name in varying}
    status = starting({**still, **flat}, branch)
    along = [f"{name}_wrt_{p}" for p in wrt for name in ("theta", "omega")]
    ends = [f"{name}_wrt_{p}" for p in wrt for name in ("t_last", "work")]
    histories = {n: np.full((size, t.size), np.nan) for n in ("theta", "omega", "alpha", *names, *along)}
    numbers = {name: np.full(size, np.nan) for name in ("t_last", "energy_residual", "work", *ends)}
    ways = np.full(size, "", "U6")
    rounded = np.full(size, np.inf)  # or 0 where the residual of a design is told
    without = []  # designs of which a derivative does not exist

    def follow(row: int) -> None:
        design = {name: values[row].item() for name, values in flat.items()} | varying
        inputs = {name: design.get(name) for name in given}
        found = run(inputs, {name: design[name] for name in starts}, t)
        count = len(found["t"])
        for name, history in histories.items():
            history[row, :count] = found[name]
        status[row], ways[row] = found["status"], found["method"]
        rounded[row] = 0.0 if TELLS in found["message"] else np.inf
        if SENSITIVITIES in found["message"]:
            without.append(row)
        for name, column_of in numbers.items():
            column_of[row] = found[name]

    rows = np.flatnonzero(status != NO_START).tolist()
    with progress_bar(unit="designs") as watch:
        told = Portions(len(rows), "motions", watch)
        for row in rows:
            follow(row)
            told.add(1)
    result = Simulation({"t": t, **{name: h.reshape(*shape, t.size) for name, h in histories.items()}})
    result["status"] = status.reshape(shape)
    result["message"] = message(status) + told_of(numbers["energy_residual"], rounded, rtol)
    result["method"] = ways.reshape(shape)
    if without:
        result["message"] += f"{SENSITIVITIES}NaN in {len(without)} of {size} designs, where there are none"
    return Simulation({**result, **{name: values.reshape(shape) for name, values in numbers.items()}})
