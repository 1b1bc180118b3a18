"""Functions of an angle in panels, on each of which they are polynomials: of one design or of many.

Kinks must be edges of panels. Gauss's rule is then exact to rounding, and so are running integrals, roots and
extremes. Values at the nodes are arrays (panels, NODES), of designs in rows
(designs, panels, NODES).
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from .computed import computed_once
from .roots import roots

Array = NDArray[Any]

NODES = 16
NODE, WEIGHT = legendre.leggauss(NODES)
TO_COEFFICIENTS = np.linalg.inv(legendre.legvander(NODE, NODES - 1))
ENDS = legendre.legvander(np.array([-1.0, 1.0]), NODES - 1) @ TO_COEFFICIENTS
# Integral from the left end of a panel to each node, of values at the nodes.
RUNNING = legendre.legvander(NODE, NODES) @ legendre.legint(TO_COEFFICIENTS, lbnd=-1.0, axis=0)
# Derivative over half a panel, at the nodes.
SLOPE = legendre.legvander(NODE, NODES - 2) @ legendre.legder(TO_COEFFICIENTS, axis=0)
BARYCENTRIC = (-1.0) ** np.arange(NODES) * np.sqrt((1.0 - NODE**2) * WEIGHT)  # of Gauss's nodes
SAMPLES = np.concatenate([[-1.0], NODE, [1.0]])  # of a panel, where signs and extremes are looked for
RESOLVED = 1e-13  # of the largest value: what the last coefficients of a resolved function may be
# Below the first, of the largest value, coefficients that halving does not shrink by the second are rounding.
NOISE, PLATEAU = 1e-8, 0.6
MOST = 20_000  # panels
WIDEST = 0.4  # rad
SAME = 1e-14  # rad
NARROWEST = 2.0**-44  # rad: next to a change point functions bend within the root of the margin
TINY = 1e-200  # stands for no distance from a node
EQUAL = 1e-13  # of the largest value: extremes that differ by less are equal
APART = 1e-6  # rad: equal ones that are no nearer are two


class Panels:
    """Panels between edges, which ascend along the last axis, and functions by name at their nodes.

    A panel may have no width: it fills the row of a design that needs fewer.
    """

    def __init__(self, edges: Array, values: Mapping[str, Array] | None = None) -> None:
        self.edges, self.values = edges, dict(values or {})

    @computed_once
    def half(self) -> Array:
        """Half the width of each panel, beside nodes."""
        return 0.5 * np.diff(self.edges)[..., None]

    @computed_once
    def x(self) -> Array:
        """The nodes."""
        return nodes_of(self.edges[..., :-1], self.edges[..., 1:])

    def integral(self, values: Array) -> Any:
        """The integral over all panels, of each design."""
        return ((values @ WEIGHT) * self.half[..., 0]).sum(-1)

    def running(self, values: Array) -> Array:
        """The integral from the first edge to each node."""
        whole = np.cumsum((values @ WEIGHT) * self.half[..., 0], axis=-1)
        start = np.concatenate([np.zeros_like(whole[..., :1]), whole[..., :-1]], axis=-1)
        return np.asarray(self.half * (values @ RUNNING.T) + start[..., None])

    def ends(self, values: Array) -> Array:
        """The values at both ends of each panel."""
        return np.asarray(values @ ENDS.T)

    def samples(self, values: Array) -> Array:
        """The values at start, nodes and end of each panel: on each side of a jump."""
        ends = self.ends(values)
        every = np.concatenate([ends[..., :1], values, ends[..., 1:]], axis=-1)
        return every.reshape(*every.shape[:-2], -1)

    @computed_once
    def places(self) -> Array:
        """The places of `samples`."""
        every = np.concatenate([self.edges[..., :-1, None], self.x, self.edges[..., 1:, None]], axis=-1)
        return every.reshape(*every.shape[:-2], -1)

    def at(self, x: Array, values: Array) -> Array:
        """Values at any places within the range, of each design at its own."""
        return self.reader(x)(values)

    def reader(self, x: Array) -> Callable[[Array], Array]:
        """A function that returns values at places within the range, of each design at its own."""
        edges = self._rows(self.edges)
        places = np.reshape(x, (len(edges), -1))
        result = [np.searchsorted(e[1:], p, side="right") for e, p in zip(edges, places, strict=True)]
        row, panel = np.arange(len(edges))[:, None], np.minimum(np.array(result), edges.shape[1] - 2)
        middle, half = self._shape(row, panel)
        local = np.clip((places - middle) / np.where(half > 0.0, half, 1.0), -1.0, 1.0)
        share = _shares(local)

        def read(values: Array) -> Array:
            here = values.reshape(-1, *values.shape[-2:])[row, panel]
            return np.asarray(np.einsum("...k,k...->...", here, share)).reshape(np.shape(x))

        return read

    def roots(self, values: Array, least: float = 0.0) -> Array:
        """The places at which a function changes its sign, in rows padded with the first edge.

        least   of a value: down to -least it counts as positive
        """
        negative, places = self._rows(self.samples(values)) < -least, self._rows(self.places)
        row, at = np.nonzero(np.diff(negative, axis=1))
        result = places[row, at].copy()
        panel, number = np.divmod(at, SAMPLES.size)
        inside = number < SAMPLES.size - 1  # else between two panels
        rows, panels, number = row[inside], panel[inside], number[inside]
        middle, half = self._shape(rows, panels)
        series = self._coefficients(values)[rows, panels]
        result[inside] = middle + half * _root(series, SAMPLES[number], SAMPLES[number + 1])
        every = padded(row, result, len(places), places[:, 0])
        return every.reshape(*self.edges.shape[:-1], -1)

    def extreme(self, values: Array, sign: float) -> tuple[Any, Any, Any]:
        """The largest (sign 1) or smallest (-1) value, its place, and whether that is within a panel."""
        places = self._rows(self.places)
        still = self.roots(np.nan_to_num(values @ SLOPE.T)).reshape(len(places), -1)
        place = np.concatenate([still, places], axis=1)
        here = np.concatenate([self.at(still, values), self._rows(self.samples(values))], axis=1)
        height = np.where(np.isnan(here), -np.inf, sign * here)
        row, best = np.arange(len(here)), height.argmax(axis=1)
        # Of extremes that rounding alone tells apart, such as mirror images of each other, the first counts.
        equal = height >= height[row, best, None] - EQUAL * np.nanmax(np.abs(here), axis=1, keepdims=True)
        equal[:, still.shape[1] :] = False
        first = np.where(equal, place, np.inf).argmin(axis=1)
        ahead = equal[row, first] & equal[row, best] & (place[row, best] - place[row, first] > APART)
        best = np.where(ahead, first, best)
        top, at = here[row, best], place[row, best]
        inside = (self._rows(self.edges) != at[:, None]).all(axis=1)
        shaped = (part.reshape(self.edges.shape[:-1])[()] for part in (top, at, inside))
        top, at, inside = shaped
        return top, at, inside

    def split(self, places: list[float]) -> "Panels":
        """The functions of one design on panels with additional edges."""
        edges = np.array(sorted({*self.edges.tolist(), *places}))
        wide = np.diff(edges) > 1e-15 * np.maximum(np.abs(edges[:-1]), 1.0)
        edges = np.append(edges[:-1][wide], edges[-1])
        x = nodes_of(edges[:-1], edges[1:])
        return Panels(edges, {name: self.at(x, v) for name, v in self.values.items()})

    def refined(self, bad: Array, edges: Array) -> Array:
        """These edges of designs and the middles of their bad panels, in rows."""
        row, panel = np.nonzero(bad)
        middles = padded(row, self._shape(row, panel)[0], len(edges), edges[:, 0])
        return np.sort(np.concatenate([edges, middles], axis=1), axis=1)

    def _rows(self, values: Array) -> Array:
        """Edges or samples of one design as a row."""
        return np.asarray(values.reshape(-1, values.shape[-1]))

    def _coefficients(self, values: Array) -> Array:
        """The Legendre coefficients of panels, of designs in rows."""
        return np.asarray((values @ TO_COEFFICIENTS.T).reshape(-1, *values.shape[-2:]))

    def _shape(self, row: Array, panel: Array) -> tuple[Array, Array]:
        """Middle and half width of panels of rows."""
        edges = self._rows(self.edges)
        start, stop = edges[row, panel], edges[row, panel + 1]
        return 0.5 * (start + stop), 0.5 * (stop - start)


def nodes_of(start: Array, stop: Array) -> Array:
    """The Gauss nodes of panels."""
    return np.asarray(0.5 * (start + stop)[..., None] + 0.5 * (stop - start)[..., None] * NODE)


def padded(row: Array, values: Array, count: int, filler: Array) -> Array:
    """Values of rows as an array with as many columns as the fullest row needs."""
    sizes = np.bincount(row, minlength=count)
    order = np.argsort(row, kind="stable")
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    result = np.repeat(filler[:, None], sizes.max(initial=0), axis=1)
    result[row[order], np.arange(len(row)) - starts[row[order]]] = values[order]
    return result


def _series(coefficients: Array, x: Array) -> Array:
    """Legendre series, each at its own place."""
    basis = legendre.legvander(x, coefficients.shape[-1] - 1)
    return np.asarray(np.einsum("...k,...k->...", basis, coefficients))


def _root(series: Array, low: Array, high: Array) -> Array:
    """The roots of Legendre series in brackets; of equal signs, which rounding makes, the nearer end."""
    at_low, at_high = _series(series, low), _series(series, high)
    nearer = np.where(np.abs(at_low) < np.abs(at_high), low, high)
    # Shifted by 2 so that the last bits of a root near 0 do not count.
    inside = roots(lambda x: _series(series, x - 2.0), low + 2.0, high + 2.0, at_low, at_high) - 2.0
    return np.where(at_low * at_high > 0.0, nearer, inside)


def _shares(x: Array) -> Array:
    """The weight of each node, along the first axis, in the value of a polynomial at x: barycentric."""
    result = np.empty((NODES, *x.shape))
    for share, node, weight in zip(result, NODE, BARYCENTRIC, strict=True):
        np.subtract(x, node, out=share)
        share[share == 0.0] = TINY
        np.divide(weight, share, out=share)
    result /= result.sum(0)
    return result


def resolved(
    functions: Callable[[Array, Array], dict[str, Array]], edges: Array, widest: float = WIDEST
) -> Panels:
    """Panels of designs, between their first and last edge, on which all functions are polynomials.

    functions  of flat arrays, places and the design of each: values by name, NaN where there is none
    edges      of one design, or a row for each, in any order; NaN in empty places

    A panel is halved until the Legendre coefficients of every function on it have fallen to rounding. Designs
    that need fewer panels end with some that have no width, where functions stay as they are.
    """
    design, start, stop = _first_panels(np.atleast_2d(edges), widest)
    size = len(np.atleast_2d(edges))
    done: list[tuple[Array, Array, Array, dict[str, Array]]] = []
    scale: dict[str, Array] = {}
    before: dict[str, Array] = {}
    count = np.zeros(size)
    while start.size:
        x = nodes_of(start, stop)
        values = functions(x.ravel(), np.repeat(design, NODES))
        values = {name: v.reshape(x.shape) for name, v in values.items()}
        tails = {name: np.abs(v @ TO_COEFFICIENTS[-2:].T).max(1) for name, v in values.items()}
        count += np.bincount(design, minlength=size)
        unresolved = np.zeros(start.size, bool)
        for name, tail in tails.items():
            largest = scale.setdefault(name, np.zeros(size))
            np.fmax.at(largest, design, np.abs(values[name]).max(1))
            rounding = (tail <= NOISE * largest[design]) & (tail >= PLATEAU * before.get(name, np.inf))
            unresolved |= (tail > RESOLVED * largest[design]) & ~rounding
        good = ~unresolved | (stop - start <= NARROWEST) | (count[design] > MOST)
        done.append((design[good], start[good], stop[good], {n: v[good] for n, v in values.items()}))
        before = {name: np.tile(tail[~good], 2) for name, tail in tails.items()}
        design, start, stop = design[~good], start[~good], stop[~good]
        middle = 0.5 * (start + stop)
        design = np.tile(design, 2)
        start, stop = np.concatenate([start, middle]), np.concatenate([middle, stop])
    design, start, stop = (np.concatenate([part[k] for part in done]) for k in range(3))
    values = {name: np.concatenate([part[3][name] for part in done]) for name in done[0][3]}
    return _in_rows(size, design, start, stop, values, np.ndim(edges) == 1)


def _first_panels(edges: Array, widest: float) -> tuple[Array, Array, Array]:
    """Design, start and stop of the panels between edges, the wide ones divided into equal parts."""
    last = np.nanmax(edges, axis=1, keepdims=True)
    edges = np.sort(np.where(edges < last - SAME, edges, last), axis=1)
    # An angle that is known twice, each time rounded, is one: no polynomial fits the doubles between them.
    edges[:, 1:] = np.where(np.diff(edges) > SAME, edges[:, 1:], last)
    edges.sort(axis=1)
    row, k = np.nonzero(np.diff(edges))
    low, high = edges[row, k], edges[row, k + 1]
    parts = np.ceil((high - low) / widest).astype(int)
    number = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    design, low, high, parts = (np.repeat(each, parts) for each in (row, low, high, parts))
    step = (high - low) / parts
    return design, low + number * step, np.where(number + 1 < parts, low + (number + 1) * step, high)


def divided(edges: Array, widest: float) -> Array:
    """Edges in rows, in any order, NaN in empty places, and others between them: no gap is wider."""
    design, start, _ = _first_panels(edges, widest)
    rows = padded(design, start, len(edges), np.nanmin(edges, axis=1))
    return np.concatenate([np.sort(rows, axis=1), np.nanmax(edges, axis=1, keepdims=True)], axis=1)


def _in_rows(
    size: int, design: Array, start: Array, stop: Array, values: dict[str, Array], one: bool
) -> Panels:
    """Panels in any order as those of designs in rows; as those of `one` design without rows."""
    order = np.lexsort((start, design))
    design = design[order]
    counts = np.bincount(design, minlength=size)
    ends = np.cumsum(counts)
    at = design, np.arange(design.size) - (ends - counts)[design]
    edges = np.repeat(stop[order][ends - 1][:, None], counts.max() + 1, axis=1)
    edges[at] = start[order]
    rows = {}
    for name, v in values.items():
        ordered = v[order]
        rows[name] = np.repeat((ordered[ends - 1] @ ENDS[1])[:, None], counts.max() * NODES, axis=1)
        rows[name] = rows[name].reshape(size, -1, NODES)
        rows[name][at] = ordered
    return Panels(edges[0], {n: v[0] for n, v in rows.items()}) if one else Panels(edges, rows)
