"""`Sliders`: what calls take as `sliders=`, several sliders on one crankshaft."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ..evaluation.labelled import refuse_other_labels
from ..evaluation.labels import attributes, input_attributes, labelled
from ..evaluation.points import ALWAYS
from ..evaluation.reductions.argument import (
    Reductions,
    chain_name,
    extremes_at_end,
    names_reduced,
    reductions_of,
)
from ..evaluation.reductions.kinds import field_of, folded
from ..mechanism.catalogue import quantity
from ..mechanism.names import parts
from ..mechanism.own import using
from ..mechanism.quantity_units import unit_of, units_of_extreme
from ..mechanism.status import PeakStatus
from ..runtime.request import is_steady, several
from ..simulation.checks import check_inertia, drive_of, follows_the_slider, scalar
from ..simulation.march import Ask
from ..simulation.request import in_time
from ..simulation.result import Simulation
from ..support.answer import Answer
from .cycle import ShaftCycle, ShaftTurn
from .extreme import extremes_of
from .motion import ShaftModel
from .sums import SliderSums, indexed, number

if TYPE_CHECKING:
    import xarray as xr

_COUPLE = "couple of the inertia forces along {}, about the shaft's middle"
MEANING = {f"C_inertia_{axis}": _COUPLE.format(axis) for axis in "XY"}


class Sliders(SliderSums):
    """Several sliders on one crankshaft, as `dx.Crankshaft` makes them."""

    def turn(self, caller: str, inputs: Mapping[str, Any], accelerates: bool = False) -> ShaftTurn:
        """The shaft over its cycle."""
        given = {n: v for n, v in inputs.items() if v is not None and (n != "alpha" or not is_steady(v))}
        if "alpha" in given and not accelerates:
            raise TypeError(f"{caller}: alpha: no turn repeats the one before; leave it out")
        with using(self.definitions):
            return ShaftTurn(caller, self, given)

    def cycles(
        self, caller: str, name: str, designs: Mapping[str, Any]
    ) -> tuple[dict[str, str], tuple[int, ...], list[ShaftCycle]]:
        """The derivatives of a sum by inputs that vary, the shape of the crankshafts, the cycle of each."""
        given = {n: v for n, v in designs.items() if v is not None and n not in ("sliders", "theta")}
        shape, rows = _rows(given)
        each = ({**given, **{n: r[k].item() for n, r in rows.items()}} for k in range(int(np.prod(shape))))
        cycles = [ShaftCycle(caller, self, inputs) for inputs in each]
        return {n: f"{name}_wrt_{n}" for n in rows}, shape, cycles

    def peak(self, name: str, kind: str, theta: Any, inputs: Mapping[str, Any]) -> Answer:
        """`desaxe.peak` of the shaft; theta: a range of angles, None for the cycle."""
        with using(self.definitions):
            shape, rows = _rows(inputs)

            def turn_of(k: int) -> ShaftTurn:
                return ShaftTurn("peak", self, {**inputs, **{n: r[k].item() for n, r in rows.items()}}, theta)

            size = int(np.prod(shape))
            if not size:
                raise ValueError("peak: an empty array; expected at least one crankshaft")
            turn, numbers = turn_of(0), {n: v for n, v in inputs.items() if not callable(v)}

            def values(names: Sequence[str], angles: Any, row: Any) -> dict[str, Any]:
                state = {**numbers, **{n: r[row] for n, r in rows.items()}, "theta": angles}
                result: dict[str, Any] = turn.sliders.evaluate(list(names), state)
                return {n: np.broadcast_to(v, np.shape(angles)) for n, v in result.items()}

            first = np.array(turn.ends) if self.smooth else None
            each = [turn_of(k).edges([name]) if first is None else first for k in range(size)]
            edges = np.full((size, max(map(len, each))), np.nan)
            for k, own in enumerate(each):
                edges[k, : len(own)] = own
            columns = {n: r[:, None] for n, r in rows.items()}

            def floor(sum_of: str, angles: Any) -> Any:
                return turn.sliders.floor(sum_of, {**numbers, **columns, "theta": angles})

            result = extremes_of(turn_of, values, edges, floor, name, kind)
            return Answer(_shaped(result, shape), partial(units_of_extreme, name), PeakStatus)

    def motion(
        self, ask: Ask, inputs: Mapping[str, Any], starts: Mapping[str, Any], times: Any
    ) -> Simulation:
        """`desaxe.simulate` of the shaft."""
        here = self.replaced({n: v for n, v in inputs.items() if v is not None})
        turn = ShaftTurn("simulate", here, {})
        if follows_the_slider(starts["torque"]):
            raise TypeError("torque: of several sliders; a function is of t, theta, omega")
        drive = drive_of(starts["torque"], None, None, ask.deadline, ask.derivative)
        start = (
            scalar("theta0", starts["theta0"], "rad"),
            scalar("omega_start", starts["omega_start"], "rad/s"),
        )

        def moves(theta: float) -> dict[str, float]:
            return {p: float(shift[0]) for p, shift in turn.moves(["T_in"], np.array([theta])).items()}

        model = ShaftModel(here, start[0], drive.torque, moves, ask.deadline)
        check_inertia(model, start[0])
        with using(self.definitions):
            return in_time(ask, model, start, times, {"sliders": here}, {})

    def grid(
        self, names: Any, inputs: Mapping[str, Any], accuracy: Any, reduce: Any, **options: Any
    ) -> "xr.Dataset":
        """`desaxe.grid` of the shaft: the outer product of its inputs, or what is taken of it."""
        for option, value in options.items():
            if value is not None:
                raise TypeError(f"{option}= is not there for a crankshaft: store the Dataset")
        requested = [*((names,) if isinstance(names, str) else several(names))]
        requested = [*dict.fromkeys([*requested, *(ALWAYS if reduce is None else names_reduced(reduce))])]
        axes = {n: v if callable(v) else number(n, v) for n, v in inputs.items() if v is not None}
        arrays = {n: np.asarray(v, float) for n, v in axes.items() if not callable(v) and n != "branch"}
        dims = [n for n, array in arrays.items() if array.ndim]
        for n in dims:
            if arrays[n].ndim > 1:
                raise ValueError(f"{n}: a grid takes numbers and 1-d arrays, got the shape {arrays[n].shape}")
            axes[n] = arrays[n].reshape([-1 if n == d else 1 for d in dims])
        result = self.evaluate(requested, axes, accuracy)
        with using(self.definitions):
            if reduce is None:
                rows = {n: (dims, result[n], described(n)) for n in requested}
                return labelled(rows, arrays, 1, accuracy)
            reductions = reductions_of(reduce, dims, requested)
            kept = {n: array for n, array in arrays.items() if n not in reductions.axes}
            rows = {}
            for n in requested:
                rows |= _taken(n, result[n], dims, reductions, arrays)
            for one in reductions.at:
                there = self.evaluate(one.name, {**axes, reductions.axes[0]: one.place}, accuracy)
                at = np.take(there, 0, dims.index(reductions.axes[0]))
                rows[one.variable] = [n for n in dims if n in kept], at, described(one.name)
            return labelled(rows, kept, 1, accuracy, requested)


def _taken(
    name: str, values: Any, dims: Sequence[str], reductions: Reductions, axes: Mapping[str, Any]
) -> dict[str, Any]:
    """The rows of a Dataset for what is taken of a quantity along some axes of a grid."""
    rows: dict[str, Any] = {}
    for chain in reductions.chains(name):
        field = field_of(tuple(dims), values)
        for along, kind in chain:
            field = folded(field_of(field.dims, field.values, field.places), along, kind, axes)
        variable = chain_name(name, chain)
        rows[variable] = field.dims, field.values, {**described(name), "quantity": name}
        for axis in extremes_at_end(chain):
            rows[f"{variable}_{axis}"] = field.dims, field.places[axis], input_attributes(axis)
    return rows


def described(name: str) -> dict[str, Any]:
    """CF attributes of a sum, of a quantity of one slider, or of a derivative."""
    base, by = parts(name)
    if name == "status":
        return attributes(name)
    if by:
        meaning = f"derivative of {base} with respect to {', '.join(by)}"
    else:
        plain, index = indexed(base)
        meaning = MEANING.get(plain) or quantity(plain).meaning
        meaning += "" if index is None else f", slider {index}"
    return {"units": str(unit_of(name)), "long_name": meaning}


def _rows(inputs: Mapping[str, Any]) -> tuple[tuple[int, ...], dict[str, Any]]:
    """The shape of the inputs that are arrays, and these as rows of it."""
    refuse_other_labels(inputs)
    arrays = {n: np.asarray(v) for n, v in inputs.items() if np.ndim(v) and not callable(v)}
    shape = np.broadcast_shapes(*(a.shape for a in arrays.values()))
    return shape, {n: np.broadcast_to(a, shape).ravel() for n, a in arrays.items()}


def _shaped(result: Any, shape: tuple[int, ...]) -> Any:
    """Results of several designs in their shape; numbers of a single one."""
    if isinstance(result, dict):
        return {n: _shaped(column, shape) for n, column in result.items()}
    return result.reshape(shape) if shape else result.item()
