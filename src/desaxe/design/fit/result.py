"""The result of `fit`: a dict with a report, predictions and a plot."""

from typing import Any

import numpy as np

from ...mechanism.catalogue import quantity
from ...support.extras import needed
from .model import Model

DONE, STOPPED, OPEN = range(3)
WORDS = {
    DONE: "converged",
    STOPPED: "stopped at the limit of evaluations",
    OPEN: "the data leave a combination of the unknowns open",
}


class Fit(dict[str, Any]):
    """The result of `fit`; see there for its keys."""

    def __init__(self, found: dict[str, Any], model: Model) -> None:
        super().__init__(found)
        self._model = model

    def __reduce__(self) -> Any:
        return Fit, (dict(self), self._model)

    def predict(self, theta: Any = None, t: Any = None) -> dict[str, tuple[Any, Any]]:
        """Each quantity as (value, standard error of the fitted curve) at crank angles [rad] or times [s].

        The band of a further measurement is wider: add its sigma squared to the square of the standard error.
        """
        course = self._model.data.course
        at = {"theta": theta, "t": t}[course]
        if at is None:
            raise TypeError(f"predict: this fit is over {course}: give {course}=")
        at = np.atleast_1d(np.asarray(at, float))
        x = np.array([self["value"][name] for name in self["names"]])
        values, slopes = self._model.quantities(x, at)
        found = {}
        for q, value in values.items():
            rows = np.array(
                [slopes[q].get(name, np.zeros_like(at)) * np.ones_like(at) for name in self["names"]]
            )
            variance = np.einsum("ki,kl,li->i", rows, self["covariance"], rows)
            found[q] = value, np.sqrt(variance)
        return found

    def report(self) -> str:
        """A table of the unknowns with standard errors and intervals, as text."""
        lines = [f"fit: {self['message']}", ""]
        wide = max(map(len, self["names"]))
        lines.append(f"  {'':{wide}}  {'value':>13}  {'std. error':>11}  95 % interval")
        for name in self["names"]:
            low, high = self["interval"][name]
            value, error = self["value"][name], self["std_error"][name]
            lines.append(f"  {name:{wide}}  {value:13.7g}  {error:11.3g}  {low:.6g} ... {high:.6g}")
        for direction in self["unidentified"]:
            weights = ", ".join(f"{weight:+.3g} {name}" for name, weight in direction.items())
            lines.append(f"  left open (relative changes): {weights}")
        for q, rest in self["residuals"].items():
            rms, samples = np.sqrt(np.nanmean(rest**2)), np.isfinite(rest).sum()
            lines.append(f"  residuals of {q}: rms {rms:.4g} in {samples} samples")
        return "\n".join(lines)

    __repr__ = report

    def plot(self, figure: Any = None) -> Any:
        """Measurements, the fitted curve with its 95 % band, and the residuals: a matplotlib Figure."""
        with needed("plot", "plot"):
            from matplotlib.figure import Figure
        data = self._model.data
        figure = figure or Figure(figsize=(8.0, 2.2 + 2.4 * len(data.measured)), layout="constrained")
        axes = figure.subplots(len(data.measured), 2, squeeze=False, sharex=True, width_ratios=(2, 1))
        fine = np.linspace(data.at.min(), data.at.max(), 721)
        bands = self.predict(**{data.course: fine})
        for (left, right), (q, column) in zip(axes, data.measured.items(), strict=True):
            value, error = bands[q]
            left.plot(data.at, column, ".", ms=3, color="0.45", label="measured")
            left.plot(fine, value, color="tab:blue", label="fitted")
            left.fill_between(
                fine, value - 1.96 * error, value + 1.96 * error, color="tab:blue", alpha=0.3, lw=0
            )
            left.set_ylabel(f"{q} [{quantity(q, self._model.state).unit}]")
            right.plot(data.at, self["residuals"][q], ".", ms=3, color="0.45")
            right.axhline(0.0, color="tab:blue", lw=1)
            right.set_ylabel("measured - fitted")
        axes[0][0].legend(frameon=False)
        for ax in axes[-1]:
            ax.set_xlabel("crank angle [rad]" if data.course == "theta" else "time [s]")
        return figure
