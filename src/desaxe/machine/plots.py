"""Pictures of a machine: `machine.plot("a_C")`, and those of `desaxe.plot` with its inputs filled in."""

from collections.abc import Mapping, Sequence
from math import ceil
from typing import Any

import numpy as np

from .. import plot
from ..design.tolerance.uncertain import read
from ..evaluation.in_units import in_units
from ..loads.angles import cycle
from ..loads.load import Load
from ..loads.resolve import as_load, split
from ..mechanism.catalogue import has
from ..mechanism.closed import TURN
from ..mechanism.inputs import INPUTS
from ..mechanism.names import LENGTHS, sensitivity
from ..mechanism.own import using
from ..mechanism.program import program_of
from ..mechanism.ranges import Between, PlusMinus
from ..plot.dataset import as_dataset
from ..plot.mechanism import sketched
from ..plot.style import title_of
from ..plot.tornado import value_text
from ..runtime.request import several
from ..support.shown import printed
from ..units.text import PLUS_MINUS
from .arguments import in_si

STEPS = 720  # of a turn
WORDS = {"absmax": "largest magnitude", "max": "maximum", "min": "minimum"}
SIDES = {-1: ", before a jump", 1: ", after a jump"}
SHARE = 0.01  # of an input, where no changes are given


class Plots:
    """Pictures of one machine, in its units; each returns what it drew (extra `plot`).

    Called with the name of a quantity it draws its curve over the crank angle, several one above the other.
    """

    __slots__ = ("_machine",)

    def __init__(self, machine: Any) -> None:
        self._machine = machine

    def __call__(
        self, names: str | Sequence[str], *, family: str | None = None, ax: Any = None, **inputs: Any
    ) -> Any:
        """Draw quantities over the crank angle: see `desaxe.plot.curves`, for several `desaxe.plot.panels`.

        names   a quantity, or several that are drawn one above the other
        inputs  theta= for other angles than those of a turn, or of the turns until the loads repeat; of a
                list of another input each value has its curve
        """
        dataset = self._over_theta(names, inputs)
        with using(self._machine.definitions):
            if isinstance(names, str):
                return plot.curves(dataset, names, family=family, ax=ax)
            return plot.panels(dataset, list(names), family=family, ax=ax)

    def polar(
        self, name: str | tuple[str, str], *, family: str | None = None, ax: Any = None, **inputs: Any
    ) -> Any:
        """Draw a quantity, or the magnitude of a vector, in polar coordinates: see `desaxe.plot.polar`."""
        names = [name] if isinstance(name, str) else list(several(name))
        return plot.polar(self._over_theta(names, inputs), name, family=family, ax=ax)

    def each(self, name: str, *, ax: Any = None, **inputs: Any) -> Any:
        """Draw a quantity of a crankshaft and, thin, what each slider adds to it, in the shaft's frame."""
        dataset = self._over_theta([name], inputs)
        given = {**inputs, "theta": dataset.theta.values}
        parts = [self._machine.only(k).plot._over_theta([name], given) for k in range(self._sliders())]
        total = plot.curves(dataset, name, ax=ax)
        axes = total[0].axes
        degrees = total[0].get_xdata()
        theta = self._machine.units.of("theta").to_si(dataset.theta.values)
        for k, part in enumerate(parts):
            axes.plot(np.degrees(theta), part[name], linewidth=0.8, label=f"slider {k}")
        total[0].set_label("sum")
        axes.set_xlim(degrees.min(), degrees.max())
        axes.relim()
        axes.autoscale_view()
        axes.legend()
        return total

    def star(self, name: str = "F_inertia_Y", order: float = 1, *, ax: Any = None, **inputs: Any) -> Any:
        """Draw one harmonic of each slider as an arrow, tip to tail: the star closes where they balance.

        name   a sum of a crankshaft; the arrow of a slider is what it adds, in the shaft's frame
        order  of the harmonic, half ones under loads of two turns
        """
        most, arrows = max(1, ceil(order)), {}
        orders = self._machine.harmonics(name, orders=most, **inputs)["order"]
        if order not in orders:
            raise ValueError(f"plot.star: order = {order}: there are {orders[:3].tolist()} ...")
        for k in range(self._sliders()):
            series = self._machine.only(k).harmonics(name, orders=most, **inputs)
            at = series["order"] == order  # nowhere for a slider whose load repeats sooner
            arrows[f"slider {k}"] = complex(series["cos"][at].sum(), series["sin"][at].sum())
        unit = printed(self._machine.units.of(name).unit)
        return plot.star(arrows, f"{name}, order {order:g}", unit, ax=ax)

    def _sliders(self) -> int:
        """The number of sliders of a crankshaft."""
        if "sliders" not in self._machine:
            raise TypeError("plot.each and plot.star are of a desaxe.Crankshaft")
        return len(self._machine["sliders"].members)

    def mechanism(self, theta: Any = "60 deg", *, ax: Any = None) -> Any:
        """Draw the machine to scale at a crank angle: see `desaxe.plot.mechanism`."""
        lengths = {name: self._machine.get(name) for name in LENGTHS}
        angle = in_si(self._machine.units, "theta", theta)
        return sketched(angle, lengths, self._machine.get("branch", 1), self._machine.units, ax)

    def load(self, load: Any = "F_Y", *, ax: Any = None) -> Any:
        """Draw a load over the crank angle or the slider's place: see `desaxe.plot.load`.

        load  of `over_theta`, `over_Y` or `over_stroke`, or "F_X" or "F_Y" for that of the machine
        """
        result = self._machine[load] if isinstance(load, str) else load
        if not callable(result):
            raise TypeError(f"plot.load: {load} is a number, which does not vary with the motion")
        return plot.load(
            result if isinstance(result, Load) else as_load("F_Y", result), ax=ax, units=self._machine.units
        )

    def animate(
        self, name: str | None = None, *, frames: int = 60, seconds: float = 3.0, ax: Any = None
    ) -> Any:
        """The machine as it turns, beside a quantity's curve: see `desaxe.plot.animate`."""
        dataset = self._over_theta("Y" if name is None else name, {})
        return plot.animate(dataset, name, frames=frames, seconds=seconds, ax=ax)

    def tornado(
        self,
        name: str,
        changes: Mapping[str, Any] | None = None,
        *,
        kind: str = "absmax",
        ax: Any = None,
        **inputs: Any,
    ) -> Any:
        """Draw what changes of the inputs do to a peak over the crank angle: see `desaxe.plot.tornado`.

        name     a quantity; of one that has no course over the crank angle, such as "stroke", its value
        changes  dict input -> half its range, in the units of the machine; by default 1 % of each, of ec 1 %
                 of AB, and the tolerances of `inputs` instead where they have some
        kind     of the peak: "absmax", "max" or "min"
        inputs   others than the machine's; with a tolerance, such as ec="10 mm +- 0.1 mm" or
                 `dx.plus_minus(10, 0.1)`, they are changes; theta=60 for the value at an angle
        """
        return _tornado(self._machine, name, changes, kind, ax, inputs)

    def design_map(
        self, name: Any, *, x: str | None = None, y: str | None = None, ax: Any = None, **inputs: Any
    ) -> Any:
        """Draw a quantity of designs over two inputs: see `desaxe.plot.design_map`.

        name    such as "stroke" or ("absmax", "a_C")
        inputs  two of them, each a list of values
        """
        dataset = self._machine.design_map([name], **inputs)
        label = name if isinstance(name, str) else "_".join(name)
        return plot.design_map(dataset, label, x=x, y=y, ax=ax)

    def drive(self, *, ax: Any = None, **inputs: Any) -> Any:
        """Draw the drive torque over a turn, and the speed with the flywheel: see `desaxe.plot.drive`."""
        return plot.drive(self._machine.drive(**inputs), ax=ax)

    def steady(self, *, torque: Any, ax: Any = None, **inputs: Any) -> Any:
        """Draw the steady state over a turn and on the motor's curve: see `desaxe.plot.steady`."""
        return plot.steady(self._machine.steady(torque=torque, **inputs), ax=ax)

    def _over_theta(self, names: str | Sequence[str], inputs: Mapping[str, Any]) -> Any:
        """The quantities over the crank angle, labelled, in the units of the machine."""
        if "theta" in inputs:
            return self._machine.grid(names, **inputs)
        sliders = self._machine.get("sliders")
        loads = {} if sliders else split({**self._machine, **inputs})[1]
        end = sliders.turn("plot", {}).angle if sliders else cycle(loads)
        angles = np.linspace(0.0, end, round(STEPS * end / TURN) + 1)
        return self._machine.grid(names, **inputs, theta=self._machine.units.of("theta").shown(angles))


# ---- tornado ------------------------------------------------------------------------------------


def _tornado(
    machine: Any, name: str, changes: Mapping[str, Any] | None, kind: str, ax: Any, inputs: Mapping[str, Any]
) -> plot.Picture:
    """Draw what changes do to a peak, to the value at an angle, or to a quantity of the whole design."""
    if not isinstance(name, str):
        raise TypeError(
            f"plot.tornado: expected the name of a quantity, got a {type(name).__name__}; a result is drawn "
            "by desaxe.plot.tornado(result, changes)"
        )
    others = dict(inputs)
    theta = others.pop("theta", None)
    values, spread = _split(machine.units, others)
    design = machine.replace(**values)
    turns = "theta" in program_of((name,)).inputs
    if turns and (theta is None or isinstance(theta, (tuple, list))):
        result = design.peak(name, kind=kind, **({} if theta is None else {"theta": theta}))
        message = f"{WORDS[kind]} of {value_text(result, name, design.units)}"
        message += SIDES.get(result["side"], "")
    else:
        result = _at_a_point(design, name, {"theta": theta} if turns else {})
        message = value_text(result, name, design.units)
    steps = {**spread, **(changes or {})} or _shares(design, result["gradient"])
    title = f"{message}\n{title_of(labelled_inputs(design, [name]), [name])}"
    return plot.tornado(result, steps, name=name, units=design.units, title=title, ax=ax)


def labelled_inputs(design: Any, names: Any) -> Any:
    """A Dataset without values: the inputs of a machine with its units, for a title."""
    inputs = {key: value for key, value in design.items() if key != "branch"}
    empty = as_dataset(dict.fromkeys(names, 0.0), "theta", {**inputs, "theta": 0.0})
    named: Any = in_units(empty.drop_vars("theta"), design.units)
    return named.assign_attrs(branch=design.get("branch", 1))


def _split(units: Any, inputs: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, float]]:
    """The values of inputs, and the tolerances of those that have one, in the units of the machine."""
    values: dict[str, Any] = {}
    spread: dict[str, float] = {}
    for name, given in inputs.items():
        rough = isinstance(given, (PlusMinus, Between)) or (
            isinstance(given, str) and PLUS_MINUS.search(given)
        )
        row: Any = (
            read(name, in_si(units, name, given), "uniform", 3.0) if rough and name in INPUTS else given
        )
        if hasattr(row, "tolerance"):
            values[name], spread[name] = (units.of(name).shown(v) for v in (row.mean, row.tolerance))
        else:
            values[name] = row if row is given else units.of(name).shown(row)
    return values, spread


def _at_a_point(design: Any, name: str, theta: Mapping[str, Any]) -> dict[str, Any]:
    """The value and its derivatives with respect to the machine's inputs, as a peak gives them."""
    rows = {p: sensitivity(name, p) for p in design if p != "branch"}
    rows = {p: row for p, row in rows.items() if has(row, "omega" in design)}
    result = design.evaluate([name, *rows.values()], **theta)
    return {"value": result[name], "gradient": {p: result[row] for p, row in rows.items()}, **theta}


def _shares(design: Any, slopes: Mapping[str, Any]) -> dict[str, float]:
    """One percent of each input that a derivative is by; of ec = 0 one of AB."""
    shown = design.in_units()
    sizes = {p: shown[p] for p in slopes if p in shown and not callable(shown[p])}
    if sizes.get("ec") == 0.0:
        sizes["ec"] = shown["AB"]
    return {p: SHARE * abs(size) for p, size in sizes.items() if size}
