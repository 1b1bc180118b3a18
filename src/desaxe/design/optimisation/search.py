"""The search behind `optimize`: scan, SLSQP from the best points, Newton on the optimality conditions.

Made as small as possible is the largest of the problem's pieces (one, mostly), in the variable t:

    minimise t   subject to   t >= piece_i(z),   limit_j(z) >= 0,   0 <= z <= 1

At an optimum sum w_i grad piece_i = sum lambda_j grad limit_j with w, lambda >= 0 and sum w = 1
(Karush, Kuhn, Tucker): lambda_j is what the optimum gains from relaxing limit j.
"""

from collections.abc import Callable, Sequence
from inspect import signature
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize, nnls, root
from scipy.stats import qmc

from ...support.forks import IMPORTS
from .problem import EQUAL, LOWER, Array, Functions, Limit, Space

SCAN = 7  # 2^7 designs are looked at first
NEAR = 1e-6  # of its scale: a limit that is so near is active
CLOSE = 0.01  # of its scale: a margin that makes the functions steep
REACHES, PROBES = (1e-2, 1e-3, 1e-4, 1e-5), 400  # of searches without derivatives
BROKEN = 1e-8  # of its scale: how far these may break a limit
SATISFIED = 1e-7  # of its scale: a limit that is broken by less is kept
SETTLED = 1e-4  # residual of the optimality conditions
LEVEL = 1e-6  # scaled slopes below this are none
STEPS = 100
FLAT = 1e-10  # of the scale: a smaller gain ends a run
WORST = 1e3  # of the scale: what a design counts that cannot be judged


class Candidate(NamedTuple):
    """A candidate for the optimum, in the variables from 0 to 1."""

    z: Array
    value: float  # of the largest piece; infinite where one is not finite
    violation: float  # of the limits, in their scales
    residual: float  # of the optimality conditions, relative
    multipliers: Array  # of the limits, then of the lower and upper ends of the variables
    kink: bool = False  # not settled, and yet nothing better is near
    edge: bool = False  # a neighbour keeps the limits and has no finite objective


class LocalSearch:
    """The search of one problem: minimise the largest piece within the limits."""

    def __init__(self, space: Space, pieces: Sequence[Limit], limits: Sequence[Limit], seed: int) -> None:
        self.space, self.limits, self.count = space, tuple(limits), len(pieces)
        self.functions = Functions(space, [*pieces, *limits])
        self.equal = np.array([c.side == EQUAL for c in limits], bool)
        self.places = _spread(len(space.names), seed)
        result = self.functions(self.places).value.copy()
        self.scale = self._scale(np.where(np.isfinite(result), np.abs(result), np.nan))
        self.scanned = result / self.scale

    def _scale(self, sizes: Array) -> Array:
        """The scale of each function: one for all pieces, one for all limits of a key."""
        middle = np.array([np.nanmedian(s) if np.isfinite(s).any() else 1.0 for s in sizes.T])
        middle = np.maximum(middle, [0.0] * self.count + [abs(c.bound) for c in self.limits])
        keys = [*[self.functions] * self.count, *(limit.key for limit in self.limits)]
        largest = {key: max(m for m, k in zip(middle, keys, strict=True) if k == key) for key in keys}
        return np.array([largest[key] or 1.0 for key in keys])

    def starts(self, count: int) -> list[Array]:
        """The best points of the scan, at some distance from each other."""
        value = self.scanned[:, : self.count].max(axis=1)
        violation = self._violation(self.scanned[:, self.count :])
        value = np.where(np.isfinite(value), value, np.inf)
        chosen: list[Array] = []
        for place in self.places[np.lexsort((value, np.round(violation, 9)))]:
            if all(np.linalg.norm(place - other) > 0.1 for other in chosen):
                chosen.append(place)
        return chosen[:count]

    @property
    def margins(self) -> list[int]:
        """Indices of the lower limits of the margin, implied or requested."""
        keys = (None, "margin")
        return [k for k, limit in enumerate(self.limits) if limit.side == LOWER and limit.key in keys]

    def at_limit(self, z: Array, number: int) -> Array:
        """The nearest point on a limit, by one linear step."""
        value, slope = (part[self.count + number] for part in self.scaled(z))
        return np.asarray(np.clip(z - slope * value / max(float(slope @ slope), 1e-300), 0.0, 1.0))

    def _violation(self, limits: Array) -> Array:
        wrong = np.where(self.equal, np.abs(limits), -limits)
        return np.asarray(np.where(np.isnan(limits), WORST, wrong).max(axis=-1, initial=0.0))

    def without_value(self, z: Array) -> Array:
        """Flags of the designs that keep the limits and have no finite objective."""
        result = self.functions(z).value / self.scale
        lost = ~np.isfinite(result[:, : self.count]).all(axis=1)
        return np.asarray(lost & (self._violation(result[:, self.count :]) <= SATISFIED))

    def scaled(self, z: Array) -> tuple[Array, Array]:
        """Scaled values and gradients of all functions at one point, always finite."""
        result = self.functions(np.clip(np.nan_to_num(z, nan=0.5), 0.0, 1.0))
        value, slope = result.value[0] / self.scale, result.slope[0] / self.scale[:, None]
        worst = np.where(np.arange(value.size) < self.count, WORST, -WORST)
        return np.where(np.isfinite(value), value, worst), np.where(np.isfinite(slope), slope, 0.0)

    def run(self, start: Array, pinned: int | None = None) -> Candidate:
        """SLSQP from one point; `pinned` is the index of a limit to stay on."""
        n, m, several = len(start), self.count, self.count > 1
        equal = np.append(np.zeros(m, bool), self.equal)
        if pinned is not None:
            equal[m + pinned] = True
        # The constraint functions, which stay positive: t - piece where there are several pieces, and limits.
        way, is_piece = np.append(-np.ones(m), np.ones(len(self.limits))), np.arange(len(equal)) < m

        def sides(z: Array) -> Array:
            return np.asarray(way * self.scaled(z[:n])[0] + (is_piece * z[n] if several else 0.0))

        def slopes(z: Array) -> Array:
            along = way[:, None] * self.scaled(z[:n])[1]
            return np.column_stack([along, is_piece]) if several else along

        kinds = (("ineq", ~equal & (several | ~is_piece)), ("eq", equal))
        top = np.append(np.zeros(n), 1.0)
        answer = minimize(
            (lambda z: z[n]) if several else (lambda z: self.scaled(z)[0][0]),
            np.append(start, self.scaled(start)[0][:m].max())[: n + several],
            jac=(lambda z: top) if several else (lambda z: self.scaled(z)[1][0]),
            method="SLSQP",
            bounds=[(0.0, 1.0)] * n + [(None, None)] * several,
            constraints=[
                {"type": name, "fun": lambda z, k=kind: sides(z)[k], "jac": lambda z, k=kind: slopes(z)[k]}
                for name, kind in kinds
                if kind.any()
            ],
            options={"maxiter": STEPS, "ftol": FLAT},
        )
        z = np.clip(np.nan_to_num(answer.x[:n], nan=0.5), 0.0, 1.0)
        overshot = [k for k in self.margins if self.scaled(z)[0][m + k] < 0.0]
        others = [self.judged(place) for place in (z, *(self.at_limit(z, k) for k in overshot))]
        return min(others, key=lambda each: each.violation)

    def nearest(self, result: Candidate, seed: int) -> Candidate:
        """The design that breaks the limits least: their largest violation is a piece itself."""
        sizes = dict(zip(self.limits, self.scale[self.count :], strict=True))
        pieces = [
            c._replace(sign=-way * c.sign / sizes[c])
            for c in self.limits
            for way in ((1.0, -1.0) if c.side == EQUAL else (1.0,))
        ]
        start = self.places[np.argmin(self._violation(self.scanned[:, self.count :]))]
        search = LocalSearch(self.space, pieces, [], seed)
        runs = [search.settled(search.run(z)).z for z in (start, result.z)]
        return min(map(self.judged, (*runs, start, result.z)), key=lambda one: one.violation)

    def settled(self, result: Candidate) -> Candidate:
        """A candidate to its last digits; without derivatives where these say nothing."""
        z = self._polished(result)
        other = self.judged(np.clip(z, 0.0, 1.0))
        worth = other.violation <= max(result.violation, 1e-9) and other.residual <= max(
            result.residual, 1e-9
        )
        near = bool(np.abs(z - result.z).max() < 1e-2) and bool(((z >= 0.0) & (z <= 1.0)).all())
        best = other if worth and near and np.isfinite(other.value) else result
        return best if best.residual <= SETTLED else self._probed(best)

    def _polished(self, result: Candidate) -> Array:
        """The optimality conditions with these limits active, solved for the last digits."""
        m = self.count
        value, slope = self.scaled(result.z)
        live = np.flatnonzero(value[:m] >= value[:m].max() - 1e-4 * max(1.0, abs(value[:m].max())))
        lambdas = result.multipliers[: len(self.limits)]
        active = np.flatnonzero(self.equal | ((np.abs(value[m:]) <= NEAR) & (lambdas != 0.0)))
        free = np.flatnonzero((result.z > NEAR) & (result.z < 1.0 - NEAR))
        fixed = np.where(result.z <= NEAR, 0.0, np.where(result.z >= 1.0 - NEAR, 1.0, result.z))
        if not free.size or len(live) - 1 + len(active) > free.size:
            return fixed

        def place(y: Array) -> Array:
            z = fixed.copy()
            z[free] = y[: free.size]
            return z

        size = max(float(np.abs(slope[live]).max()), 1e-300)

        def conditions(y: Array) -> Array:
            value, slope = self.scaled(place(y))
            weights = np.append(
                1.0 - y[free.size : free.size + live.size - 1].sum(), y[free.size :][: live.size - 1]
            )
            forces = y[free.size + live.size - 1 :]
            balance = weights @ slope[live] / size - forces @ slope[m + active]
            return np.concatenate([balance[free], value[live[1:]] - value[live[0]], value[m + active]])

        weights = np.full(live.size - 1, 1.0 / live.size)
        begin = np.concatenate(
            [result.z[free], weights, lambdas[active] * self.scale[m + active] / size / self.scale[0]]
        )
        answer = root(conditions, begin, method="hybr", options={"xtol": 1e-13, "maxfev": 60})
        return place(answer.x)

    def _probed(self, best: Candidate) -> Candidate:
        """Continue from an unsettled point without derivatives: two peaks may tie in a kink."""
        m, both = self.count, np.flatnonzero(self.equal)

        def limits(z: Array) -> Array:
            value = self.scaled(z)[0][m:]
            return np.concatenate([value, -value[both], z, 1.0 - z])

        gain = np.inf
        for reach in REACHES:
            other = self.judged(_probe(lambda z: self.scaled(z)[0][:m].max(), best.z, limits, reach))
            better = other.violation <= BROKEN and other.value < best.value
            gain = (best.value - other.value) / self.scale[0] if better else 0.0
            best = other if better else best
            if gain <= BROKEN:
                break
        beside = np.vstack([np.eye(best.z.size), -np.eye(best.z.size)]) * NEAR
        edge = self.without_value(np.clip(best.z + beside, 0.0, 1.0)).any()
        sloped = bool(np.isfinite(self.functions(best.z).slope).all())
        return best._replace(kink=bool(gain <= BROKEN and (sloped or edge)), edge=bool(edge))

    def judged(self, z: Array) -> Candidate:
        """A point with its violation, and the multipliers that best satisfy the optimality conditions."""
        n, m = len(z), self.count
        value, slope = self.scaled(z)
        pieces, limits = value[:m], value[m:]
        largest = pieces.max()
        live = pieces >= largest - NEAR * max(1.0, abs(largest))
        active = (np.abs(limits) <= NEAR) | self.equal
        both = active & self.equal
        ends = np.vstack([np.eye(n), -np.eye(n)])
        at_end = np.append(z <= NEAR, z >= 1.0 - NEAR)
        normals = np.vstack([slope[m:][active], -slope[m:][both], ends[at_end]])
        size = max(float(np.linalg.norm(slope[:m][live], axis=1).max()), LEVEL)
        # Columns: the weights of the live pieces, then the multipliers; the last row: the weights' sum.
        columns = np.vstack([slope[:m][live] / size, -normals])
        matrix = np.vstack([columns.T, np.arange(len(columns)) < live.sum()])
        solution, residual = nnls(matrix, np.append(np.zeros(n), 1.0))
        if not np.isfinite(self.functions(z).slope[0][np.append(live, active)]).all():
            residual = 1.0  # without slopes nothing is known
        result, many = solution[live.sum() :] * size * self.scale[0], int(active.sum())
        own = np.zeros(len(limits))
        own[active] = result[:many]
        own[both] -= result[many : many + both.sum()]
        multipliers = np.append(own / self.scale[m:], np.zeros(2 * n))
        multipliers[len(own) :][at_end] = result[many + both.sum() :]
        finite = np.isfinite(self.functions(z).value[0][:m]).all()
        top = float(largest * self.scale[0]) if finite else np.inf
        return Candidate(z, top, float(self._violation(limits)), float(residual), multipliers)


def _spread(n: int, seed: int) -> Array:
    """Designs spread over the space: a Sobol sequence, corners, the middle."""
    keyword = {"rng" if "rng" in signature(qmc.Sobol).parameters else "seed": seed}
    with IMPORTS:  # for the table of the sequence, a resource
        sequence = qmc.Sobol(n, **keyword)
    corners = np.array(list(product((0.0, 1.0), repeat=min(n, 6))))
    corners = np.hstack([corners, np.full((len(corners), n - corners.shape[1]), 0.5)])
    return np.vstack([sequence.random_base2(SCAN), corners, np.full((1, n), 0.5)])


def _probe(
    function: Callable[[Array], float], start: Array, limits: Callable[[Array], Array], reach: float
) -> Array:
    """A minimum within limits, which stay positive, without derivatives."""
    options = {"rhobeg": reach, "tol": 1e-9, "maxiter": PROBES}
    kept = [{"type": "ineq", "fun": limits}]
    answer = minimize(function, start, method="COBYLA", constraints=kept, options=options)
    return np.asarray(np.clip(answer.x, 0.0, 1.0))
