"""`fit`: the parameters of a machine that explain its measurements."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...mechanism.catalogue import quantity
from ...mechanism.inputs import INPUTS, TINY, Input
from ...mechanism.keywords import with_known_keywords
from ...mechanism.messages import named
from ...mechanism.read import read, read_array
from ...mechanism.spelling import did_you_mean
from ...runtime.request import check_common, request
from ...support.checks import whole_number
from ...support.extras import needed
from ...support.forks import IMPORTS
from ...support.shown import shown
from .data import MOST, Array, Data, read_data
from .model import FittedModel
from .result import BOUNDS, DONE, OPEN, STOPPED, WORDS, Fit
from .solve import FitSolution, solve
from .spread import LOSSES, inflation, offset_of, spread_of, weights_of
from .unknowns import unknowns_of

NORMAL = 1.959963984540054  # two-sided 95 % of the normal distribution
MAD = 1.4826  # standard deviations in a median absolute deviation, of the normal distribution
UNLIKELY = 1e-6  # a chi-square that chance exceeds less often is told
EDGE = 1e-9  # of an unknown's size: a bound that is met
SMALL = 1e-3  # standard errors, Bates and Watts' bound: a smaller Gauss-Newton step is convergence
CLOSE = 1e-6  # of the rod: a margin of assembling that is none
ROUNDING = 16.0 * np.finfo(float).eps  # of the values of the model


@with_known_keywords
def fit(
    data: Any,
    over: Mapping[str, Any],
    sigma: Mapping[str, Any] | None = None,
    nuisance: Sequence[str] | Mapping[str, Any] = (),
    loss: str = "linear",
    *,
    branch: int = 1,
    seed: int = 0,
    **fixed: Any,
) -> Fit:
    """The parameters that explain measurements, with their standard errors.

    data      mapping of `theta` [rad] or `t` [s] and of measured quantities (`Y`, `a_C`, `T_in`, ...) to
              samples, NaN where one is missing; or a DataFrame, a Dataset, or the path of a CSV file whose
              heading names them: `theta [deg], a_C [m/s2]`. Without omega and omega0 in over and fixed a
              column `omega` beside `theta` is the speed at each sample, an input; so is the speed from a
              column `t` beside `theta`, and alpha where it is not in over and fixed: those of the cubic
              spline through the angles, which are at most half a turn apart. With a fixed speed t is not used
    over      dict parameter -> start, or (low, high): bounds, in which several starts are tried; of a machine
              also names alone, which start at its numbers
    sigma     dict quantity -> standard deviation of its samples, in the quantity's unit. Without it one
              quantity only may be measured, and the scatter of its residuals takes sigma's place
    nuisance  further unknowns: "theta_offset" [rad] (the crank is at theta + theta_offset), and of each
              quantity "a_C_bias", "a_C_scale": measured = scale * a_C + bias. Names, or a dict name -> start
              or (low, high)
    loss      "linear" (least squares), or "soft_l1", "huber", "cauchy", "arctan", robust to outliers
    fixed     all other inputs, as for `evaluate`

    Returns a dict (its `report()`, `plot()` and `predict(theta)` show more):

    value, std_error   dict name -> value and standard error, parameters and nuisances
    interval           dict name -> (low, high), 95 %
    names              the unknowns, in the order of `covariance` and `correlation`
    residuals          dict quantity -> measured - fitted at every sample, NaN where missing
    jacobian           dict quantity -> dict unknown -> derivative of the fitted value at every sample, exact
    unidentified       directions that the data do not fix: dicts name -> weight, a change relative to the
                       unknown's own value (or range, where that is about 0), the largest weight being 1; so
                       {AB: 1, BC: 1} leaves AB/BC known alone. std_error is infinite for the unknowns in them
    at_bound           dict name -> "low" or "high" for unknowns that end at a bound: their std_error and
                       interval leave the bound out of account
    evaluations        of the model, all starts together
    chi_square         sum of the squares of residual/sigma over the degrees of freedom, where sigma is given:
                       about 1 if the model holds
    status, message    0 converged: the scaled gradient is small, a further step is less than 0.001 standard
                       errors; 1 not converged, 2 a combination left open; `message` says too where residuals
                       are far beyond sigma

    SciPy's trust region reflective least squares with the exact Jacobian; biases and scales need no start:
    they are solved for at each. A step to a design that cannot be assembled at every sample is shortened,
    and a search that ends there says that it ran into a change point. Raises ValueError for data that are
    empty or fewer than the unknowns, and where no start can be assembled; TypeError for a missing input.
    Needs the extra `design`.

    See docs/choose.md: which call for which question.
    """
    if "theta" in fixed:
        raise TypeError("fit: theta belongs into data")
    state = dict.fromkeys((*over, *fixed), 1.0) if isinstance(over, Mapping) else fixed
    check_common(state, branch)
    if not isinstance(loss, str) or loss not in LOSSES:
        raise ValueError(f"loss = {shown(loss)}: {did_you_mean(loss, LOSSES)}there are {', '.join(LOSSES)}")
    whole_number("seed", seed, 0, 2**32 - 1)
    read = read_data(data, "omega0" not in state)
    for name, value in fixed.items():
        array = read_array(INPUTS[name], value) if isinstance(value, (list, tuple)) else value
        if np.ndim(array) and np.size(array) not in (1, read.at.size) and not callable(value):
            raise ValueError(
                f"{name}: {np.size(array)} values, and a fit is of one machine: give one, or a range in over"
            )
    if read.course == "theta":
        read, fixed = _with_speeds(read, over, fixed, branch)
    unknowns = unknowns_of(over, nuisance, read, fixed)
    if read.size < len(unknowns):
        raise ValueError(
            f"fit: {read.size} samples for {len(unknowns)} unknowns: at least as many are needed"
        )
    given = _sigmas(sigma, read)
    model = FittedModel(read, unknowns, fixed, branch, given or dict.fromkeys(read.measured, 1.0))
    before = None if given else _set_sigma(model, loss, seed)
    result = solve(model, loss, seed, absolute=bool(given), before=before)
    return _result(model, result, loss, absolute=bool(given))


def _with_speeds(
    data: Data, over: Mapping[str, Any], fixed: dict[str, Any], branch: int
) -> tuple[Data, dict[str, Any]]:
    """The data and the inputs with the speed at each sample, where it was measured and is needed.

    A quantity that depends on the speed is missing where that is.
    """
    over = over if isinstance(over, Mapping) else {}  # any other is refused where it is read
    inputs = {name: value for name, value in fixed.items() if value is not None} | dict.fromkeys(over, 1.0)
    speeds = {"omega", "omega0"} & inputs.keys()
    if data.t is not None and speeds & over.keys():
        (name,) = speeds
        raise TypeError(
            f"fit: theta and t in data have the speed: leave {name} out of over, or theta out of data"
        )
    columns = dict(data.measured)
    if speeds or (data.t is None and "omega" not in columns):
        return data, fixed
    omega = columns.pop("omega", None)
    needs = {
        q: request((q,), {"omega": 1.0, "alpha": 1.0, **inputs}, branch, "standard").inputs for q in columns
    }
    moving = [q for q, names in needs.items() if "omega" in names]
    motion = _motion(data.at, data.t) if data.t is not None and moving else {}
    missing = {name for names in needs.values() for name in names} - inputs.keys()
    motion = {name: one for name, one in motion.items() if name in missing}
    motion |= {"omega": omega} if omega is not None else {}
    known = np.isfinite(sum(motion.values(), np.zeros_like(data.at)))
    columns |= {q: np.where(known, columns[q], np.nan) for q in moving}
    motion = {name: np.where(known, one, 0.0) for name, one in motion.items()}
    return data._replace(measured=columns), {**fixed, **motion}


def _motion(theta: Array, t: Array) -> dict[str, Array]:
    """The speed and the acceleration of the crank at angles measured at times; NaN without a time."""
    with needed("fit", "design"):
        from scipy.interpolate import CubicSpline
    known = np.isfinite(t)
    late = np.flatnonzero(np.diff(t[known]) <= 0.0)
    if late.size or known.sum() < 2:
        why = f"{t[known][late[0] + 1]:g} after {t[known][late[0]]:g}" if late.size else "one time"
        raise ValueError(f"data: t: {why}: the speed needs times that increase from sample to sample")
    spline = CubicSpline(t[known], np.unwrap(theta[known]))
    return {name: np.where(known, spline(t, k), np.nan) for k, name in enumerate(("omega", "alpha"), 1)}


def _sigmas(sigma: Mapping[str, Any] | None, data: Data) -> dict[str, float]:
    """The standard deviations, checked; none where none are given."""
    if sigma is None:
        if len(data.measured) > 1:
            raise ValueError(
                f"sigma: {', '.join(data.measured)} are measured: give the standard deviation of each"
            )
        return {}
    if not isinstance(sigma, Mapping) or set(sigma) != set(data.measured):
        raise ValueError(f"sigma = {shown(sigma)}: expected a dict with {', '.join(data.measured)}")
    return {name: _sigma(name, value, data.measured[name]) for name, value in sigma.items()}


def _sigma(name: str, value: Any, samples: Array) -> float:
    row = Input(name, quantity(name).unit, "standard deviation", TINY, "a finite number > 0")
    result = read(row, value, "sigma", row.limit)
    size = float(np.max(np.abs(samples), initial=0.0, where=np.isfinite(samples))) or 1.0
    if not size / MOST <= result <= size * MOST:
        raise ValueError(
            f"sigma: {name} = {shown(value)}: samples of up to {size:.3g} have one between "
            f"{size / MOST:.3g} and {size * MOST:.3g}"
        )
    return result


def _set_sigma(model: FittedModel, loss: str, seed: int) -> FitSolution:
    """Set sigma to the scatter of the residuals, robustly: a robust loss needs a scale; the last solution."""
    (name,) = model.sigma
    model.sigma[name] = float(np.nanstd(model.data.measured[name])) or 1.0
    robust, before = loss != "linear", None
    for _ in range(3 if robust else 1):
        before = solve(model, "soft_l1" if robust else loss, seed, before=before)
        rest = before.residuals * model.sigma[name]
        scatter = MAD * float(np.median(np.abs(rest - np.median(rest))))
        floor = np.finfo(float).eps * float(np.nanmax(np.abs(model.data.measured[name])))
        model.sigma[name] = max(scatter, floor, np.finfo(float).tiny)
    assert before is not None
    return before


@np.errstate(all="ignore")  # what is not fixed by the data is infinite or NaN
def _result(model: FittedModel, result: FitSolution, loss: str, absolute: bool) -> Fit:
    residuals, jacobian = model.residuals(result.x), model.jacobian(result.x)
    sizes = np.array(
        [
            abs(x) if abs(x) > 1e-6 * u.scale else u.scale
            for x, u in zip(result.x, model.unknowns, strict=True)
        ]
    )
    freedom = residuals.size - len(model.names)
    variance = inflation(residuals, loss)
    if not absolute and loss == "linear":
        variance = float(residuals @ residuals) / freedom if freedom else np.inf
    spread = spread_of(jacobian, sizes, model.names, variance)
    error = np.sqrt(np.diag(spread.covariance))
    correlation = spread.covariance / np.outer(error, error)
    np.fill_diagonal(correlation, 1.0)
    quantile = NORMAL if absolute else _student(freedom)
    values, slopes = model.quantities(result.x)
    converged = _has_converged(model, result.x, residuals, jacobian, loss)
    status = STOPPED if not converged else OPEN if spread.unidentified else DONE
    where = "" if converged else _change_point(model, result.x)
    at_bound = _at_bound(model, result.x)
    for end, words in BOUNDS.items():
        held = [name for name, which in at_bound.items() if which == end]
        where += f"; {', '.join(held)}: {words}" if held else ""
    total = float(residuals @ residuals) if absolute else np.nan
    by_name = dict(zip(model.names, result.x.tolist(), strict=True))
    return Fit(
        {
            "value": by_name,
            "std_error": dict(zip(model.names, error.tolist(), strict=True)),
            "interval": {
                name: (by_name[name] - quantile * e, by_name[name] + quantile * e)
                for name, e in zip(model.names, error.tolist(), strict=True)
            },
            "names": list(model.names),
            "covariance": spread.covariance,
            "correlation": correlation,
            "residuals": {q: column - values[q] for q, column in model.data.measured.items()},
            "jacobian": slopes,
            "unidentified": spread.unidentified,
            "at_bound": at_bound,
            "evaluations": result.evaluations,
            "chi_square": total / freedom if freedom else np.nan,
            "status": status,
            "message": WORDS[status] + where + (_far_beyond(residuals, freedom, loss) if absolute else ""),
        },
        model,
    )


def _has_converged(model: FittedModel, x: Array, residuals: Array, jacobian: Array, loss: str) -> bool:
    """True if the scaled gradient is small; unknowns that a bound keeps from going on do not count."""
    root = np.sqrt(weights_of(residuals, loss))
    rows, rest = jacobian * root[:, None], residuals * root
    sizes = np.linalg.norm(rows, axis=0)
    parts = float((sizes * np.abs(x)).max()) / np.sqrt(rest.size)
    values = max(float(np.nanmax(np.abs(v))) / model.sigma[q] for q, v in model.data.measured.items())
    least = max(1.0, ROUNDING / SMALL * max(parts, values))
    low, high = (np.array([getattr(u, end) for u in model.unknowns]) for end in ("low", "high"))
    way = np.where(rest @ rows > 0.0, x - low, high - x)  # to the bound that the gradient leads to
    free = way * sizes > SMALL * max(least, float(np.linalg.norm(rest)) / np.sqrt(rest.size))
    return offset_of(rows[:, free], rest, least) <= SMALL


def _change_point(model: FittedModel, x: Array) -> str:
    """Words where the search ended at a design that can just be assembled at a sample."""
    inputs = {**model.fixed, **dict(zip(model.names, x.tolist(), strict=True))}
    theta, _ = model.theta(x)
    spare = inputs["BC"] - np.abs(inputs["ec"] + inputs["AB"] * np.sin(theta))
    k = int(np.argmin(spare))
    if not spare[k] <= CLOSE * inputs["BC"]:
        return ""
    where = named("theta", float(theta[k]), "g")
    return "; the search ran into a change point: the mechanism can just be assembled at " + where


def _far_beyond(residuals: Array, freedom: int, loss: str) -> str:
    """Words where the residuals are too large for sigma; none where chance may explain them.

    A robust loss lets outliers be: there half of the residuals count.
    """
    with IMPORTS:
        from scipy.special import chdtrc

    if loss != "linear":
        scatter = MAD * float(np.median(np.abs(residuals)))
        if scatter <= 1.0 + 6.0 / np.sqrt(residuals.size):
            return ""
        return f"; residuals are far beyond sigma: their own scatter is {scatter:.3g} sigma, outliers apart"
    total = float(residuals @ residuals)
    if not freedom or not chdtrc(freedom, total) < UNLIKELY:
        return ""
    message = f"residuals are far beyond sigma: chi-square is {total:.3g}, {freedom} are expected"
    return f"; {message}: sigma too small, an unknown missing (nuisance=), or outliers: try loss='huber'"


def _student(freedom: int) -> float:
    with IMPORTS:
        from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.975)) if freedom else np.inf


def _at_bound(model: FittedModel, x: Any) -> dict[str, str]:
    ends = [
        (u, value - u.low <= EDGE * u.scale, u.high - value <= EDGE * u.scale)
        for value, u in zip(x, model.unknowns, strict=True)
    ]
    return {u.name: "low" if low else "high" for u, low, high in ends if low or high}
