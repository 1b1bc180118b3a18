"""`feasibility`: can the mechanism be assembled, can it turn, at which crank angles."""

from collections.abc import Mapping
from math import fsum, ulp
from typing import TYPE_CHECKING, Any

from ...mechanism.closed.functions import closed_form
from ...mechanism.closed.limits import CHANGE_POINT_ULPS, LIMITS, in_intervals
from ...mechanism.inputs import LEAST
from ...mechanism.quantity_units import slopes_of, units_of
from ...mechanism.status import TurnStatus
from ...runtime.request import as_number, with_known_inputs
from ...support.answer import Answer
from ...support.forks import IMPORTS

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

KINDS = ("crank", "change point", "rocker", "none", "bad input")


@with_known_inputs
def feasibility(*, ec: Any, AB: Any, BC: Any) -> dict[str, Any]:
    """Type of a design, its margin, and the crank angles at which it can be assembled.

    ec, AB, BC: numbers (or text with a unit) in metres, or arrays, which broadcast like NumPy. Gives a dict:

    margin           BC - AB - |ec| [m], of the doubles given, rounded once
    gradient         its derivatives with respect to ec, AB, BC (at ec = 0 that by ec is taken as 0)
    can_turn         whether the crank can turn fully (margin >= 0)
    theta_intervals  list of (first, last) crank angles [rad] in which it can be assembled; an
                     interval that crosses 2 pi goes on beyond it. [(0, 2 pi)] where it can turn
    kind             "crank" (turns fully), "change point" (|margin| within 4 last bits of BC), "rocker"
                     (turns partly), "none"
    grashof          whether the shorter of crank and rod can turn fully: |ec| <= |BC - AB|
    status           0 the crank turns fully, 1 it does not, 2 at a change point (margin = 0), 4 bad input

    For arrays each is an array: `theta_intervals` has two intervals in its last two axes, NaN where there
    are fewer, and `kind` is "bad input" where a length is none. `design_map` labels outer products.

    Raises ValueError for a bad value. Source: paper A (6), where |u| <= BC.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> found = dx.feasibility(ec=0.125, AB=0.125, BC=0.375)
        >>> found["kind"], found["can_turn"], found["margin"]
        ('crank', True, 0.125)
    """
    inputs = {"ec": ec, "AB": AB, "BC": BC}
    lengths = {
        name: as_number(name, value, tuple(inputs), ("feasibility",)) for name, value in inputs.items()
    }
    if None in lengths.values():
        with IMPORTS:
            from ...evaluation.arrays import as_array, broadcast_shape
            from ...evaluation.labelled import refuse_other_labels

        refuse_other_labels(inputs)
        arrays = {n: as_array(n, value, tuple(inputs), ("feasibility",)) for n, value in inputs.items()}
        broadcast_shape(arrays)
        return Answer(of_arrays(*arrays.values()), _units, TurnStatus)
    ec, AB, BC = lengths.values()
    *angles, status, _, link_margin = closed_form(LIMITS).point(ec, AB, BC)
    margin = fsum((BC, -AB, -abs(ec)))  # rounded once, ties too
    intervals = in_intervals(angles)
    near = abs(margin) <= CHANGE_POINT_ULPS * ulp(BC)
    kind = "change point" if near else "crank" if margin > 0.0 else "rocker" if intervals else "none"
    slope = 0.0 if ec == 0.0 else (-1.0 if ec > 0.0 else 1.0)
    result = {
        "margin": margin,
        "gradient": {"ec": slope, "AB": -1.0, "BC": 1.0},
        "can_turn": margin >= 0.0,
        "theta_intervals": intervals,
        "kind": kind,
        "grashof": link_margin >= 0.0,
        "status": status,
    }
    return Answer(result, _units, TurnStatus)


def _units(result: Mapping[str, Any]) -> dict[str, Any]:
    """The units of an answer of `feasibility`."""
    return {**units_of(("margin", "theta_intervals")), "gradient": slopes_of("margin", result["gradient"])}


def only_good(ec: "Array", AB: "Array", BC: "Array") -> "tuple[NDArray[np.bool_], list[Array]]":
    """Mask of the designs with a bad length; the lengths in their broadcast shape, NaN for those."""
    with IMPORTS:
        import numpy as np

    ec, AB, BC = np.broadcast_arrays(ec, AB, BC)
    good = np.isfinite(ec) & np.isfinite(AB) & np.isfinite(BC) & (LEAST["AB"] <= AB) & (LEAST["BC"] <= BC)
    return ~good, [np.where(good, length, np.nan) for length in (ec, AB, BC)]


def of_arrays(ec: "Array", AB: "Array", BC: "Array") -> dict[str, Any]:
    """The results of `feasibility` in the broadcast shape."""
    with IMPORTS:
        import numpy as np

    bad, (ec, AB, BC) = only_good(ec, AB, BC)
    *angles, status, margin, link_margin = closed_form(LIMITS).arrays(ec, AB, BC)
    intervals = np.stack(np.broadcast_arrays(*angles), axis=-1).reshape(*bad.shape, 2, 2)
    near = np.abs(margin) <= CHANGE_POINT_ULPS * np.spacing(BC)
    turns, some = margin >= 0.0, np.isfinite(angles[0])
    one = np.where(bad, np.nan, 1.0)
    return {
        "margin": margin,
        "gradient": {"ec": -np.sign(ec) * one, "AB": -one, "BC": one},
        "can_turn": turns,
        "theta_intervals": intervals,
        "kind": np.array(KINDS)[np.select([bad, near, turns, some], [4, 1, 0, 2], 3)],
        "grashof": link_margin >= 0.0,
        "status": np.where(bad, 4, status).astype(np.int8),
    }
