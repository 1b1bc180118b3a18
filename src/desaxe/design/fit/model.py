"""The model of a fit: predicted measurements, with exact derivatives with respect to every unknown.

    measured = scale * q(theta + theta_offset; parameters) + bias

Over the time the crank follows its law from theta_offset on: theta = theta_offset + w t + alpha t^2/2 with
w^2 = omega0^2 + 2 alpha theta_offset (paper A's law), or theta_offset + omega t for a given speed.
"""

from collections.abc import Mapping, Sequence
from math import copysign, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...evaluation.evaluate import evaluate
from ...mechanism.catalogue import quantity
from ...mechanism.inputs import INPUTS
from ...mechanism.names import sensitivity
from ...runtime.request import request
from .data import Data
from .unknowns import OFFSET, Unknown

Array = NDArray[np.float64]


class FittedModel:
    """Values and derivatives of the measured quantities at the unknowns' values."""

    def __init__(
        self,
        data: Data,
        unknowns: Sequence[Unknown],
        fixed: Mapping[str, Any],
        branch: int,
        sigma: Mapping[str, float],
    ) -> None:
        self.data, self.unknowns, self.branch = data, list(unknowns), branch
        self.names = [unknown.name for unknown in unknowns]
        self.fixed = {name: value for name, value in fixed.items() if value is not None}
        self.sigma = dict(sigma)
        self.parameters = [u.name for u in unknowns if u.name in _inputs(self.names)]
        self.sampled = [name for name, value in self.fixed.items() if np.size(value) > 1]
        self.state = "omega" in self.fixed or "omega" in self.parameters
        self.slopes = {q: self._slope_names(q) for q in data.measured}

    def _slope_names(self, of: str) -> dict[str, str]:
        """Parameter -> the name of the derivative; without those that the quantity does not depend on."""
        given = {**self.fixed, **dict.fromkeys(self.parameters, 1.0)}
        needs = request((of,), given, self.branch, "standard").inputs
        moved = [p for p in self.parameters if p in needs or p in ("AB", "BC")]
        if "theta" in needs and (OFFSET in self.names or self.data.course == "t"):
            moved.append("theta")
        result = {}
        for parameter in moved:
            name = sensitivity(of, parameter)
            try:
                quantity(name, self.state)
            except ValueError:
                if parameter not in needs:
                    continue
                raise ValueError(f"fit: {of} by {parameter}: this derivative is not derived") from None
            result[parameter] = name
        return result

    def theta(self, x: Array, at: Array | None = None) -> tuple[Array, dict[str, Array]]:
        """The crank angle at each sample, and its derivative with respect to each unknown that moves it."""
        value = dict(zip(self.names, x.tolist(), strict=True))
        at = self.data.at if at is None else at
        offset = value.get(OFFSET, 0.0)
        if self.data.course == "theta":
            return at + offset, {OFFSET: np.ones_like(at)}
        inputs = {**self.fixed, **value}
        if inputs.get("omega") is not None:
            return offset + inputs["omega"] * at, {OFFSET: np.ones_like(at), "omega": at}
        omega0, alpha = float(inputs["omega0"]), float(inputs.get("alpha") or 0.0)
        square = omega0 * omega0 + 2.0 * alpha * offset
        speed = omega0
        if alpha != 0.0:  # beyond a stall there is no motion
            speed = copysign(sqrt(square), omega0) if square >= 0.0 else float("nan")
        by = {OFFSET: 1.0 + alpha / speed * at if speed else np.ones_like(at)}
        by["omega0"] = (omega0 / speed if speed else 1.0) * at
        by["alpha"] = (offset / speed if speed else 0.0) * at + 0.5 * at * at
        return offset + speed * at + 0.5 * alpha * at * at, by

    def quantities(
        self, x: Array, at: Array | None = None, sampled: Mapping[str, Array] | None = None
    ) -> tuple[dict[str, Array], dict[str, dict[str, Array]]]:
        """Each quantity at each sample, and its derivatives; NaN where infeasible.

        at, sampled  other samples, and the inputs there that vary with them
        """
        value = dict(zip(self.names, x.tolist(), strict=True))
        theta, moves = self.theta(x, at)
        asked = list(dict.fromkeys([*self.slopes, *(n for s in self.slopes.values() for n in s.values())]))
        inputs = {**self.fixed, **{p: value[p] for p in self.parameters}, **(sampled or {})}
        result = evaluate(asked, theta=theta, branch=self.branch, **inputs)
        result = {name: np.broadcast_to(array, theta.shape) for name, array in result.items()}
        values, slopes = {}, {}
        for q, names in self.slopes.items():
            gain, bias = value.get(f"{q}_scale", 1.0), value.get(f"{q}_bias", 0.0)
            by = {p: gain * result[n] for p, n in names.items() if p != "theta"}
            for p, move in moves.items() if "theta" in names else ():
                if p in self.names:
                    by[p] = by.get(p, 0.0) + gain * result[names["theta"]] * move
            by |= {
                n: one
                for n, one in ((f"{q}_scale", result[q]), (f"{q}_bias", np.ones_like(theta)))
                if n in self.names
            }
            values[q], slopes[q] = gain * result[q] + bias, by
        return values, slopes

    def residuals(self, x: Array) -> Array:
        """(measured - modelled)/sigma of every sample that was measured; infinite where infeasible."""
        values, _ = self.quantities(x)
        rows = [
            ((values[q] - column) / self.sigma[q])[np.isfinite(column)]
            for q, column in self.data.measured.items()
        ]
        joined = np.concatenate(rows)
        return np.where(np.isfinite(joined), joined, np.inf)

    def jacobian(self, x: Array) -> Array:
        """The derivatives of `residuals`, a column for each unknown."""
        _, slopes = self.quantities(x)
        blocks = []
        for q, column in self.data.measured.items():
            there = np.isfinite(column)
            block = np.zeros((int(there.sum()), len(self.names)))
            for k, name in enumerate(self.names):
                if name in slopes[q]:
                    block[:, k] = slopes[q][name][there] / self.sigma[q]
            blocks.append(block)
        return np.concatenate(blocks)


def _inputs(names: Sequence[str]) -> set[str]:
    return set(names) & set(INPUTS)
