"""A range of crank angles in panels, on each of which functions are polynomials at Gauss nodes.

A panel is halved until the Legendre coefficients of every function on it have fallen to rounding. Kinks must
be edges of panels. Gauss's rule is then exact to rounding, and so are running integrals, roots and extremes.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from ...support.computed import computed_once

Array = NDArray[np.float64]

NODES = 16
NODE, WEIGHT = legendre.leggauss(NODES)
TO_COEFFICIENTS = np.linalg.inv(legendre.legvander(NODE, NODES - 1))
# Integral from the left end of a panel to each node, of values at the nodes.
RUNNING = legendre.legvander(NODE, NODES) @ legendre.legint(TO_COEFFICIENTS, lbnd=-1.0, axis=0)
RESOLVED = 1e-13  # of the largest value: what the last coefficients of a resolved function may be
NOISE, PLATEAU = (
    1e-8,
    0.6,
)  # below the first, coefficients that halving does not shrink by the second are rounding
MOST = 20_000  # panels
WIDEST = 0.4  # rad
NARROWEST = 2.0**-44  # rad: next to a change point functions bend within the root of the margin


class Panels:
    """Panels and the values of functions, by name, at their nodes: arrays (panels, NODES)."""

    def __init__(self, start: Array, stop: Array, values: dict[str, Array]) -> None:
        self.start, self.stop, self.values = start, stop, values

    @computed_once
    def theta(self) -> Array:
        """The nodes."""
        return nodes_of(self.start, self.stop)

    @computed_once
    def weight(self) -> Array:
        """The quadrature weight of each node."""
        return 0.5 * (self.stop - self.start)[:, None] * WEIGHT

    @property
    def edges(self) -> list[float]:
        """The edges of the panels, ascending."""
        return [*self.start.tolist(), float(self.stop[-1])]

    def integral(self, values: Array) -> float:
        """The integral over all panels."""
        return float(np.sum(self.weight * values))

    def running(self, values: Array) -> Array:
        """The integral from the first panel's left end to each node."""
        half = 0.5 * (self.stop - self.start)[:, None]
        whole = np.cumsum((self.weight * values).sum(1))
        result: Array = half * (values @ RUNNING.T) + np.concatenate([[0.0], whole[:-1]])[:, None]
        return result

    def curve(self, values: Array) -> tuple[Array, Array]:
        """Angles and values for a curve: of both ends of each panel too, so of each side of a jump."""
        ends = values @ TO_COEFFICIENTS.T @ legendre.legvander(np.array([-1.0, 1.0]), NODES - 1).T
        theta = np.concatenate([self.start[:, None], self.theta, self.stop[:, None]], axis=1)
        return theta.ravel(), np.concatenate([ends[:, :1], values, ends[:, 1:]], axis=1).ravel()

    def at(self, theta: Array, values: Array) -> Array:
        """Values at any angles within the range."""
        panel = np.clip(np.searchsorted(self.stop, theta), 0, self.stop.size - 1)
        x = 2.0 * (theta - self.start[panel]) / (self.stop - self.start)[panel] - 1.0
        basis = legendre.legvander(np.clip(x, -1.0, 1.0), NODES - 1)
        result: Array = np.sum(basis * (values @ TO_COEFFICIENTS.T)[panel], -1)
        return result

    def roots(self, values: Array) -> list[float]:
        """The angles at which a function changes its sign."""
        ends = np.array([-1.0, *NODE, 1.0])
        coefficients = values @ TO_COEFFICIENTS.T
        sampled = np.sign(coefficients @ legendre.legvander(ends, NODES - 1).T)
        found = []
        for panel in np.flatnonzero((np.abs(np.diff(sampled, axis=1)) > 1).any(1)):
            middle, half = self._shape(panel)
            found += [middle + half * x for x in _real_roots(coefficients[panel])]
        return sorted(found)

    def extreme(self, values: Array, sign: float) -> tuple[float, float, bool]:
        """The largest (sign 1) or smallest (-1) value, its angle, and whether that is within a panel."""
        coefficients = sign * (values @ TO_COEFFICIENTS.T)
        samples = coefficients @ legendre.legvander(np.array([-1.0, *NODE, 1.0]), NODES - 1).T
        bound = coefficients[:, 0] + np.abs(coefficients[:, 1:]).sum(1)
        best, place, inside = -np.inf, 0.0, False
        top = float(samples.max())
        for panel in np.flatnonzero(bound >= top - RESOLVED * abs(top)):
            flat = _real_roots(legendre.legder(coefficients[panel]))
            x = np.array([*flat, -1.0, 1.0])
            here = legendre.legval(x, coefficients[panel])
            number = int(np.argmax(here))
            if here[number] > best:
                middle, half = self._shape(panel)
                best, place, inside = (
                    float(here[number]),
                    float(middle + half * x[number]),
                    number < len(flat),
                )
        return sign * best, place, inside

    def split(self, places: list[float]) -> "Panels":
        """These functions on panels with additional edges."""
        edges = np.array(sorted({*self.edges, *places}))
        start, stop = edges[:-1], edges[1:]
        wide = stop - start > 1e-15 * np.maximum(np.abs(start), 1.0)
        start, stop = start[wide], stop[wide]
        theta = nodes_of(start, stop)
        return Panels(start, stop, {name: self.at(theta, v) for name, v in self.values.items()})

    def _shape(self, panel: Any) -> tuple[float, float]:
        """Middle and half width."""
        start, stop = self.start[panel], self.stop[panel]
        return float(0.5 * (start + stop)), float(0.5 * (stop - start))


def _real_roots(coefficients: Array) -> list[float]:
    """The roots of a Legendre series within its panel, without coefficients that are rounding."""
    series = legendre.legtrim(coefficients, 1e-15 * float(np.abs(coefficients).max()))
    roots = legendre.legroots(series)
    return [float(x.real) for x in roots if abs(x.imag) < 1e-9 and abs(x.real) <= 1.0]


def nodes_of(start: Array, stop: Array) -> Array:
    """The Gauss nodes of panels."""
    nodes: Array = 0.5 * (start + stop)[:, None] + 0.5 * (stop - start)[:, None] * NODE
    return nodes


def resolved(functions: Callable[[Array], dict[str, Array]], breaks: list[float]) -> Panels:
    """Panels between the first and the last break, on which all functions are polynomials.

    `functions(theta)` gives values by name for a flat array of angles. Breaks are in order.
    """
    edges = np.array(sorted(set(breaks)))
    counts = np.maximum(1, np.ceil(np.diff(edges) / WIDEST)).astype(int)
    pieces = [np.linspace(a, b, n + 1) for a, b, n in zip(edges[:-1], edges[1:], counts, strict=True)]
    start, stop = (np.concatenate([piece[part] for piece in pieces]) for part in (np.s_[:-1], np.s_[1:]))
    done: list[tuple[Array, Array, dict[str, Array]]] = []
    scale: dict[str, float] = {}
    before: dict[str, Array] = {}
    count = 0
    while start.size:
        theta = nodes_of(start, stop)
        values = {name: v.reshape(theta.shape) for name, v in functions(theta.ravel()).items()}
        good = (stop - start <= NARROWEST) | (count > MOST)
        tails = {name: np.abs(v @ TO_COEFFICIENTS[-2:].T).max(1) for name, v in values.items()}
        fine = np.ones(start.size, bool)
        for name, tail in tails.items():
            scale[name] = max(scale.get(name, 0.0), float(np.abs(values[name]).max()))
            rounding = (tail <= NOISE * scale[name]) & (tail >= PLATEAU * before.get(name, np.inf))
            fine &= (tail <= RESOLVED * scale[name]) | rounding
        good |= fine
        done.append((start[good], stop[good], {name: v[good] for name, v in values.items()}))
        before = {name: np.tile(tail[~good], 2) for name, tail in tails.items()}
        start, stop = start[~good], stop[~good]
        middle = 0.5 * (start + stop)
        start, stop = np.concatenate([start, middle]), np.concatenate([middle, stop])
        count += start.size
    order = np.argsort(np.concatenate([part[0] for part in done]))
    joined = {name: np.concatenate([part[2][name] for part in done])[order] for name in done[0][2]}
    first, last = (np.concatenate([part[k] for part in done])[order] for k in (0, 1))
    return Panels(first, last, joined)
