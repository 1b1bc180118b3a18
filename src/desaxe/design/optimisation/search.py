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
from .problem import EQUAL, LOWER, Array, Functions, Limit, Smooth, Space

SCAN = 7  # 2^7 designs are looked at first
NEAR = 1e-6  # of its scale: a limit that is so near is active
CLOSE = 0.01  # of its scale: a margin that makes the functions steep
PROBES = 400  # of a search without derivatives
BROKEN = 1e-8  # of its scale: how far that may break a limit
SATISFIED = 1e-7  # of its scale: a limit that is broken by less is kept
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

    def __init__(
        self, space: Space, pieces: Sequence[tuple[Smooth, float]], limits: Sequence[Limit], seed: int
    ) -> None:
        self.space, self.limits, self.seed, self.count = space, tuple(limits), seed, len(pieces)
        rows = [(*piece, 0.0) for piece in pieces] + [(c.measure, c.sign, c.bound) for c in limits]
        self.functions = Functions(space, rows)
        self.equal = np.array([c.side == EQUAL for c in limits], bool)
        self.scan()

    # ---- where to start ---------------------------------------------------------------------------

    def scan(self) -> None:
        """Evaluate designs spread over the space; set the scale of every function from them."""
        n = len(self.space.names)
        seed = {"rng" if "rng" in signature(qmc.Sobol).parameters else "seed": self.seed}
        with IMPORTS:  # for the table of the sequence, a resource
            spread = qmc.Sobol(n, **seed)
        corners = np.array(list(product((0.0, 1.0), repeat=min(n, 6))))
        corners = np.hstack([corners, np.full((len(corners), n - corners.shape[1]), 0.5)])
        self.places = np.vstack([spread.random_base2(SCAN), corners, np.full((1, n), 0.5)])
        result = self.functions(self.places).value
        sizes = np.where(np.isfinite(result), np.abs(result), np.nan)
        middle = np.array([np.nanmedian(s) if np.isfinite(s).any() else 1.0 for s in sizes.T])
        bounds = np.array([0.0] * self.count + [abs(c.bound) for c in self.limits])
        self.scale = np.where(np.maximum(middle, bounds) > 0.0, np.maximum(middle, bounds), 1.0)
        self.scale[: self.count] = self.scale[: self.count].max()
        keys = [limit.key for limit in self.limits]  # limits of one key are sides of one measure
        sizes = self.scale[self.count :]
        sizes[:] = [
            max(size for size, other in zip(sizes, keys, strict=True) if other == key) for key in keys
        ]
        self.scanned = result / self.scale

    def starts(self, count: int) -> list[Array]:
        """The best points of the scan, at some distance from each other."""
        value = self.scanned[:, : self.count].max(axis=1)
        violation = self._violation(self.scanned[:, self.count :])
        value = np.where(np.isfinite(value), value, np.inf)
        order = np.lexsort((value, np.round(violation, 9)))
        chosen: list[Array] = []
        for place in self.places[order]:
            if all(np.linalg.norm(place - other) > 0.1 for other in chosen):
                chosen.append(place)
        return chosen[:count]

    def margins(self) -> list[int]:
        """Indices of the lower limits of the margin, implied or requested."""
        keys = (None, "margin")
        return [k for k, limit in enumerate(self.limits) if limit.side == LOWER and limit.key in keys]

    def is_near_margin(self, z: Array) -> bool:
        """True if the design is close to a lower limit of its margin."""
        value = self.scaled(z)[0][self.count :]
        return any(value[number] < CLOSE for number in self.margins())

    def at_limit(self, z: Array, number: int) -> Array:
        """The nearest point on a limit, by one linear step."""
        value, slope = self.scaled(z)
        row = self.count + number
        step: Array = slope[row] * value[row] / max(float(slope[row] @ slope[row]), 1e-300)
        return np.clip(z - step, 0.0, 1.0)

    def _violation(self, limits: Array) -> Array:
        wrong = np.where(self.equal, np.abs(limits), np.maximum(-limits, 0.0))
        wrong = np.where(np.isnan(limits), WORST, wrong)
        total: Array = wrong.max(axis=-1) if wrong.shape[-1] else np.zeros(wrong.shape[:-1])
        return total

    def without_value(self, z: Array) -> Array:
        """Flags of the designs that keep the limits and have no finite objective."""
        result = self.functions(z).value / self.scale
        lost = ~np.isfinite(result[:, : self.count]).all(axis=1)
        return np.asarray(lost & (self._violation(result[:, self.count :]) <= SATISFIED))

    # ---- one run ----------------------------------------------------------------------------------

    def scaled(self, z: Array) -> tuple[Array, Array]:
        """Scaled values and gradients of all functions at one point, always finite."""
        result = self.functions(np.clip(np.nan_to_num(z, nan=0.5), 0.0, 1.0))
        value, slope = result.value[0] / self.scale, result.slope[0] / self.scale[:, None]
        bad = ~np.isfinite(value)
        value = np.where(bad, np.where(np.arange(value.size) < self.count, WORST, -WORST), value)
        return value, np.where(np.isfinite(slope), slope, 0.0)

    def run(self, start: Array, pinned: int | None = None) -> Candidate:
        """SLSQP from one point; `pinned` is the index of a limit to stay on."""
        n, m = len(start), self.count
        several = m > 1
        first = self.scaled(start)[0][:m].max()
        z0 = np.append(start, first) if several else start

        def sides(z: Array) -> tuple[Array, Array]:
            """The constraint functions, which stay positive, and their gradients."""
            value, slope = self.scaled(z[:n])
            if not several:
                return value[m:], slope[m:]
            over = np.vstack([np.hstack([-slope[:m], np.ones((m, 1))]), np.pad(slope[m:], ((0, 0), (0, 1)))])
            return np.append(z[n] - value[:m], value[m:]), over

        kinds = np.append(np.zeros(m if several else 0, bool), self.equal)
        if pinned is not None:
            kinds[pinned - len(self.limits)] = True
        constraints = [
            {"type": name, "fun": lambda z, k=kind: sides(z)[0][k], "jac": lambda z, k=kind: sides(z)[1][k]}
            for name, kind in (("ineq", ~kinds), ("eq", kinds))
            if kind.any()
        ]
        top = np.append(np.zeros(n), 1.0)
        answer = minimize(
            (lambda z: z[n]) if several else (lambda z: self.scaled(z)[0][0]),
            z0,
            jac=(lambda z: top) if several else (lambda z: self.scaled(z)[1][0]),
            method="SLSQP",
            bounds=[(0.0, 1.0)] * n + [(None, None)] * several,
            constraints=constraints,
            options={"maxiter": STEPS, "ftol": FLAT},
        )
        z = np.clip(np.nan_to_num(answer.x[:n], nan=0.5), 0.0, 1.0)
        result = self.judged(z)
        for number in self.margins():
            if self.scaled(z)[0][self.count + number] < 0.0:  # overshot
                other = self.judged(self.at_limit(z, number))
                result = min(result, other, key=lambda each: each.violation)
        return result

    def probed(self, result: Candidate) -> Candidate:
        """Continue from an unsettled point without derivatives (COBYLA): two peaks may tie in a kink."""
        m = self.count
        both = np.flatnonzero(self.equal)

        def limits(z: Array) -> Array:
            value = self.scaled(z)[0][m:]
            return np.concatenate([value, -value[both], z, 1.0 - z])

        other = self.judged(_probe(lambda z: self.scaled(z)[0][:m].max(), result.z, limits, 0.01))
        better = other.violation <= BROKEN and other.value < result.value
        gain = (result.value - other.value) / self.scale[0] if better else 0.0
        best = other if better else result
        beside = np.vstack([np.eye(best.z.size), -np.eye(best.z.size)]) * NEAR
        edge = self.without_value(np.clip(best.z + beside, 0.0, 1.0)).any()
        return best._replace(kink=bool(gain <= BROKEN), edge=bool(edge))

    def nearest(self, result: Candidate) -> Candidate:
        """The design that breaks the limits least, found without derivatives from the best of the scan."""
        m = self.count

        def broken(z: Array) -> float:
            return float(self._violation(self.scaled(z)[0][m:]))

        start = self.places[np.argmin(self._violation(self.scanned[:, m:]))]
        probed = _probe(broken, start, lambda z: np.append(z, 1.0 - z), 0.1)
        return self.judged(min((result.z, start, probed), key=broken))

    # ---- optimality -------------------------------------------------------------------------------

    def judged(self, z: Array) -> Candidate:
        """A point with its violation, and the multipliers that best satisfy the optimality conditions."""
        n, m = len(z), self.count
        value, slope = self.scaled(z)
        pieces, limits = value[:m], value[m:]
        largest = pieces.max()
        live = pieces >= largest - NEAR * max(1.0, abs(largest))
        active = (np.abs(limits) <= NEAR) | self.equal
        ends = np.vstack([np.eye(n), -np.eye(n)])
        at_end = np.append(z <= NEAR, z >= 1.0 - NEAR)
        normals = np.vstack([slope[m:][active], -slope[m:][active & self.equal], ends[at_end]])
        size = max(float(np.linalg.norm(slope[:m][live], axis=1).max()), LEVEL)
        # Columns: the weights of the live pieces, then the multipliers; the last row: the weights' sum.
        columns = np.vstack([slope[:m][live] / size, -normals])
        weigh = np.append(np.full(live.sum(), 1.0), np.zeros(len(normals)))
        matrix = np.vstack([columns.T, weigh])
        solution, _ = nnls(matrix, np.append(np.zeros(n), 1.0))
        residual = float(np.linalg.norm(matrix @ solution - np.append(np.zeros(n), 1.0)))
        counts = np.append(live, active)
        if not np.isfinite(self.functions(z).slope[0][counts]).all():  # without slopes nothing is known
            residual = 1.0
        result = solution[live.sum() :] * size * self.scale[0]
        many, some = int(active.sum()), int((active & self.equal).sum())
        multipliers = np.zeros(len(self.limits) + 2 * n)
        own = np.zeros(len(self.limits))
        own[active] = result[:many]
        own[active & self.equal] -= result[many : many + some]
        multipliers[: len(own)] = own / self.scale[m:]
        multipliers[len(own) :][at_end] = result[many + some :]
        violation = float(self._violation(limits))
        finite = np.isfinite(self.functions(z).value[0][:m]).all()
        top = float(largest * self.scale[0]) if finite else np.inf
        return Candidate(z, top, violation, residual, multipliers)

    def polished(self, result: Candidate) -> Candidate:
        """The optimality conditions with these limits active, solved for the last digits."""
        m = self.count
        value, slope = self.scaled(result.z)
        live = np.flatnonzero(value[:m] >= value[:m].max() - 1e-4 * max(1.0, abs(value[:m].max())))
        lambdas = result.multipliers[: len(self.limits)]
        active = np.flatnonzero(self.equal | ((np.abs(value[m:]) <= NEAR) & (lambdas != 0.0)))
        free = np.flatnonzero((result.z > NEAR) & (result.z < 1.0 - NEAR))
        fixed = np.where(result.z <= NEAR, 0.0, np.where(result.z >= 1.0 - NEAR, 1.0, result.z))
        if not free.size or len(live) - 1 + len(active) > free.size:
            return self._better(result, fixed)

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
        z = place(answer.x)
        moved = bool(np.abs(z - result.z).max() < 1e-2) and bool(((z >= 0.0) & (z <= 1.0)).all())
        return self._better(result, z) if moved else result

    def _better(self, result: Candidate, z: Array) -> Candidate:
        other = self.judged(z)
        worth = other.violation <= max(result.violation, 1e-9) and other.residual <= max(
            result.residual, 1e-9
        )
        return other if worth and np.isfinite(other.value) else result


def _probe(
    function: Callable[[Array], float], start: Array, limits: Callable[[Array], Array], reach: float
) -> Array:
    """A minimum within limits, which stay positive, without derivatives."""
    options = {"rhobeg": reach, "tol": 1e-9, "maxiter": PROBES}
    kept = [{"type": "ineq", "fun": limits}]
    answer = minimize(function, start, method="COBYLA", constraints=kept, options=options)
    return np.asarray(np.clip(answer.x, 0.0, 1.0))
