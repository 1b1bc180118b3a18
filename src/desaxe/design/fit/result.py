"""The result of `fit`: a dict with a report, predictions and a plot."""

from typing import Any

import numpy as np

from ...evaluation.in_units import Shown, in_units
from ...mechanism.catalogue import quantity
from ...mechanism.quantity_units import SI, QuantityUnit, UnitSystem, conversion_of, unit_of
from ...mechanism.status import FitStatus
from ...support.answer import Answer
from ...support.extras import needed
from ...support.text_table import table
from .model import FittedModel

DONE, STOPPED, OPEN = map(int, FitStatus)
BOUNDS = {"low": "held by the lower bound", "high": "held by the upper bound"}
WORDS = {int(status): status.words for status in FitStatus}


class Fit(Answer):
    """The result of `fit`; see there for its keys. `system` is that of its numbers, report and plot."""

    def __init__(self, result: dict[str, Any], model: FittedModel) -> None:
        super().__init__(result, _units_of(result, model))
        self._found, self._model = result, model

    def convert_rest(self, shown: Shown) -> None:
        """The covariance in other units, and of pint quantities all but the values as plain numbers."""
        own = [conversion_of(_unit_of(name, self._model), shown.system) for name in self["names"]]
        sizes = np.array([float(conversion.si) for conversion in own])
        self["covariance"] = self._found["covariance"] / np.outer(sizes, sizes)
        if shown.as_quantity:
            plain = shown._replace(as_quantity=False)
            for key in ("residuals", "jacobian"):
                self[key] = plain.entry(self._found[key], _units_of(self._found, self._model)[key])

    @property
    def _system(self) -> UnitSystem:
        return self.system or SI

    @property
    def _numbers(self) -> "Fit":
        """The numbers that are shown, without pint."""
        shown: Fit = in_units(Fit(self._found, self._model), self._system)
        return shown

    def predict(self, theta: Any = None, t: Any = None, **inputs: Any) -> dict[str, tuple[Any, Any]]:
        """Each quantity as (value, standard error of the fitted curve) at crank angles [rad] or times [s].

        inputs  those that varied from sample to sample, such as a measured omega, at these angles

        Angles, times, inputs and values are in the units of this result.
        The band of a further measurement is wider: add its sigma squared to the square of the standard error.
        """
        course = self._model.data.course
        at = {"theta": theta, "t": t}[course]
        if at is None:
            raise TypeError(f"predict: this fit is over {course}: give {course}=")
        if inputs.keys() != {*self._model.sampled}:
            names = ", ".join(f"{name}=" for name in self._model.sampled)
            missing = (
                f"{names} varied with the samples: give them at these angles" if names else "no other input"
            )
            raise TypeError(f"predict: {missing}, got {', '.join(inputs) or 'none'}")
        columns = {name: self._in_si(name, value) for name, value in {course: at, **inputs}.items()}
        at, *rest = np.broadcast_arrays(*columns.values())
        sampled = dict(zip(inputs, rest, strict=True))
        x = np.array([self._found["value"][name] for name in self["names"]])
        values, slopes = self._model.quantities(x, at, sampled)
        result = {}
        for q, value in values.items():
            rows = np.array(
                [slopes[q].get(name, np.zeros_like(at)) * np.ones_like(at) for name in self["names"]]
            )
            variance = np.einsum("ki,kl,li->i", rows, self._found["covariance"], rows)
            own = self._system.of(q)
            result[q] = own.shown(value), own.shown(np.sqrt(variance))
        return result

    def _in_si(self, name: str, value: Any) -> Any:
        return np.atleast_1d(np.asarray(self._system.of(name).to_si(np.asarray(value, float))))

    def report(self) -> str:
        """A table of the unknowns with standard errors and intervals, as text."""
        lines = [f"fit: {self['message']}", ""]
        shown, titles = self._numbers, {name: self._title(name) for name in self["names"]}
        rows = [["", "value", "std. error", "95 % interval"]]
        for name, title in titles.items():
            low, high = shown["interval"][name]
            spread = f"{shown['std_error'][name]:11.3g}", f"{low:.6g} ... {high:.6g}"
            end = self["at_bound"].get(name)
            spread = ("", BOUNDS[end]) if end else spread
            rows.append([title, f"{shown['value'][name]:13.7g}", *spread])
        lines += table(rows, "lrrl", indent="  ")
        for direction in self["unidentified"]:
            weights = ", ".join(f"{weight:+.3g} {name}" for name, weight in direction.items())
            lines.append(f"  left open (relative changes): {weights}")
        for q, rest in self["residuals"].items():
            with np.errstate(over="ignore"):
                rms, samples = np.sqrt(np.nanmean(rest**2)), np.isfinite(rest).sum()
            lines.append(f"  residuals of {self._title(q)}: rms {rms:.4g} in {samples} samples")
        return "\n".join(lines)

    __repr__ = report

    def _title(self, name: str) -> str:
        """Label a name with its unit."""
        unit = conversion_of(_unit_of(name, self._model), self._system).unit
        return name if unit == "1" else f"{name} [{unit}]"

    def plot(self, figure: Any = None) -> Any:
        """Measurements, the fitted curve with its 95 % band, and the residuals.

        Where inputs varied with the samples, the fitted values at these in place of curve and band.

        Returns a Picture of the fitted curves by quantity. `figure` is a matplotlib Figure to draw in, by
        default a new one.
        """
        with needed("plot", "plot"):
            from matplotlib.figure import Figure

            from ...plot import Picture
        data = self._model.data
        figure = figure or Figure(figsize=(8.0, 2.2 + 2.4 * len(data.measured)), layout="constrained")
        axes = figure.subplots(len(data.measured), 2, squeeze=False, sharex=True, width_ratios=(2, 1))
        along = self._system.of(data.course)
        at = along.shown(data.at)
        varied = {q: self._system.of(q).shown(self._model.fixed[q]) for q in self._model.sampled}
        fine, style = (at, "x") if varied else (np.linspace(at.min(), at.max(), 721), "-")
        curves: dict[str, Any] = {}
        bands = self.predict(**{data.course: fine}, **varied)
        for (left, right), (q, column) in zip(axes, data.measured.items(), strict=True):
            (value, error), own = bands[q], self._system.of(q)
            left.plot(at, own.shown(column), ".", ms=3, color="0.45", label="measured")
            (curves[q],) = left.plot(fine, value, style, ms=3, color="tab:blue", label="fitted")
            if not varied:
                ends = value - 1.96 * error, value + 1.96 * error
                left.fill_between(fine, *ends, color="tab:blue", alpha=0.3, lw=0)
            unit = own.unit if self.system else quantity(q, self._model.state).unit
            left.set_ylabel(f"{q} [{unit}]")
            right.plot(at, self["residuals"][q], ".", ms=3, color="0.45")
            right.axhline(0.0, color="tab:blue", lw=1)
            right.set_ylabel(f"measured - fitted [{unit}]")
        axes[0][0].legend(frameon=False)
        for ax in axes[-1]:
            ax.set_xlabel(f"{'crank angle' if data.course == 'theta' else 'time'} [{along.unit}]")
        return Picture(axes.ravel().tolist(), curves)


def _unit_of(name: str, model: FittedModel) -> QuantityUnit:
    """The unit of an unknown or a quantity: a bias is in the unit of its quantity, a scale in none."""
    measured = model.data.measured
    if any(name == f"{q}_scale" for q in measured):
        return unit_of(None)
    return unit_of(next((q for q in measured if name == f"{q}_bias"), name))


def _units_of(result: dict[str, Any], model: FittedModel) -> dict[str, Any]:
    """The units of a result; relative directions, correlations and words have none."""
    own = {name: _unit_of(name, model) for name in result["names"]}
    return {
        **dict.fromkeys(("value", "std_error", "interval"), own),
        "residuals": {q: unit_of(q) for q in result["residuals"]},
        "jacobian": {q: {n: unit_of(q, own[n].name) for n in rows} for q, rows in result["jacobian"].items()},
    }
