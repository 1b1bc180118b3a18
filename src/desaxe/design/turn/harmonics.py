"""`harmonics`: the Fourier series of a quantity over the crank angle, at constant speed."""

from typing import Any

import numpy as np

from ...mechanism.catalogue import quantity
from ...mechanism.keywords import with_known_keywords
from ...mechanism.quantity_units import unit_of
from ...support.answer import Answer, lines_of, text_of
from ...support.checks import whole_number
from ...support.panels import NODES, RESOLVED, WEIGHT, WIDEST, Array, Panels
from ...support.shown import printed
from ...support.text_table import table
from .turn import turning

WAVES = 4.0  # rad of the highest wave in a panel of 16 nodes: what Gauss's rule integrates to rounding
MOST = 2048  # orders
ROWS = 65  # of the table that is shown
BLOCK = 64  # panels whose waves are in memory at a time


class Harmonics(Answer):
    """The harmonics of `harmonics`; their repr is a table with a row for each order."""

    def __repr__(self) -> str:
        columns = ("order", "cos", "sin", "amplitude", "phase")
        shown = [k for k in range(len(self["order"])) if k < ROWS]
        sizes = {"cos": 1.0, "sin": 1.0, "amplitude": 1.0, "phase": self["amplitude"]}
        numbers = {
            n: np.where(abs(self[n]) * size <= self["error"], 0.0, self[n]) for n, size in sizes.items()
        }
        numbers["order"] = self["order"]
        rows = [tuple(text_of(float(numbers[name][k])) for name in columns) for k in shown]
        units = tuple(printed(str(self.units.get(name, ""))) for name in columns)
        lines = table([columns, *([units] if any(units) else []), *rows], "r" * len(columns))
        if len(shown) < len(self["order"]):
            lines.append(f"... {len(self['order'])} orders")
        rest = {name: value for name, value in self.items() if name not in columns}
        rest["mean"] = 0.0 if abs(self["mean"]) <= self["error"] else self["mean"]
        return "\n".join([*lines, *lines_of(rest, self.units)])


@with_known_keywords
def harmonics(
    name: str, *, orders: int = 8, branch: int = 1, sliders: Any = None, **inputs: Any
) -> dict[str, Any]:
    """The harmonics of a quantity over a cycle at constant speed.

    name    any quantity or sensitivity, such as "F_shaking_Y", "T_in" or "a_C"
    orders  the highest harmonic
    inputs  of one design, as in `evaluate`; F_X and F_Y may vary with the motion, and repeat after n turns
    sliders filled in by a `Crankshaft`; what its sliders cancel to rounding is 0

    Returns a dict; the quantity is mean + sum over orders n > 0 of cos cos(n theta) + sin sin(n theta):

    order              0, 1, ..., orders; under loads that repeat after n turns 0, 1/n, 2/n, ..., orders
    cos, sin           coefficients by order, in the quantity's unit; cos[0] is the mean
    amplitude, phase   the same as amplitude cos(order theta - phase) [rad]
    mean               over the cycle
    remainder          root of the mean square of all higher harmonics: what these orders leave out
    error              bound of the error of each coefficient: how far the panels were refined
    points             angles that this took

    Gauss's rule in panels between kinks and jumps, which are halved until the quantity is resolved. Raises
    ValueError where the crank cannot turn fully or a value is missing.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> found = dx.harmonics("a_C", ec=0, AB=0.1, BC=0.4, omega0=10.0)
        >>> [round(float(c), 4) for c in found["cos"][1:3]]
        [-10.0, -2.5403]
    """
    if sliders is None:
        quantity(name)
    if name == "status":
        raise ValueError("status is not a real number")
    orders = whole_number("orders", orders, 0, MOST)
    turn = turning("harmonics", inputs, branch, sliders)
    panels = turn.panels([name], widest=min(WIDEST, WAVES / (orders + 1)))
    order = np.arange(orders * turn.turns + 1)
    c, remainder = _series(panels, panels.values[name], turn.turns, order.size)
    c[np.abs(c) <= turn.floor(name)] = 0.0
    scale = np.where(order == 0, 1.0, 2.0)
    cosine, sine = scale * c.real, 0.0 - scale * c.imag
    series: dict[str, Any] = {
        "order": order if turn.turns == 1 else order / turn.turns,
        "cos": cosine,
        "sin": sine,
        "amplitude": np.hypot(cosine, sine),
        "phase": np.arctan2(sine, cosine),
        "mean": float(cosine[0]),
        "remainder": remainder,
        "error": 2.0 * RESOLVED * float(np.abs(panels.values[name]).max()),
        "points": panels.values[name].size,
    }
    own = dict.fromkeys(("cos", "sin", "amplitude", "mean", "remainder", "error"), unit_of(name))
    return Harmonics(series, {**own, "phase": unit_of("phase")})


def _series(panels: Panels, value: Array, turns: int, count: int) -> tuple[Array, float]:
    """The complex coefficients of exp(i k theta/turns), and the root mean square of what they leave."""
    weight, side = panels.half * WEIGHT / (2.0 * np.pi * turns), int(np.ceil(np.sqrt(count)))
    blocks = [slice(k, k + BLOCK) for k in range(0, len(value), BLOCK)]

    def waves(part: slice) -> list[Array]:
        """exp(i k theta/turns) of k < side, and of the first multiples of side: their products are all."""
        x = panels.x[part].ravel() / turns
        return [np.exp(1j * np.multiply.outer(step * np.arange(side), x)) for step in (1, side)]

    c, series = np.zeros((side, side), complex), np.empty_like(value)
    for part in blocks:
        fine, coarse = waves(part)
        c += ((weight * value)[part].ravel() * coarse.conj()) @ fine.conj().T
    c.reshape(-1)[count:] = 0.0
    for part in blocks:
        fine, coarse = waves(part)
        series[part] = (2.0 * ((c @ fine) * coarse).sum(0).real - c[0, 0].real).reshape(-1, NODES)
    remainder = np.sqrt(np.sum(weight * (value - series) ** 2))
    return c.reshape(-1)[:count], float(remainder)
