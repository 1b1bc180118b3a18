"""`optimize`: the best design within limits, with the multipliers of the limits; or why there is none."""

from collections.abc import Mapping
from functools import partial
from typing import Any

from ...mechanism.keywords import with_known_keywords
from ...runtime.request import check_common, check_sliders
from ...support.answer import Answer
from ...support.checks import whole_number
from ...support.deadline import Deadline
from ...support.extras import explained
from ...support.signals import put_off
from .objectives import goals_of, limits_of, space_of

with put_off(), explained("optimize", "design"):
    from .one_objective import front, solved
    from .optimum import units_of_optimum


@with_known_keywords
def optimize(
    *,
    over: Mapping[str, tuple[Any, Any]],
    maximize: Any = None,
    minimize: Any = None,
    keep: Mapping[Any, Any] | None = None,
    branch: int = 1,
    starts: int = 3,
    points: int = 11,
    seed: int = 0,
    timeout: float | None = 120.0,
    sliders: Any = None,
    **fixed: Any,
) -> dict[str, Any]:
    """The design that makes a quantity as large or as small as possible, within limits.

    maximize, minimize  "margin", a name of `events` such as "stroke" or "time_ratio", or a peak over the
                        crank angle as (kind, quantity): ("absmax", "a_C"). Others are ("rms", "T_in"),
                        ("mean", "power_in"), ("at", "60 deg", "Y"), and a function of a design, a dict,
                        that gives its value and a dict of its derivatives. Several of them, or both, ask
                        for the Pareto front: designs of which none is better than another in everything
    over                dict parameter -> (low, high): what may vary, lengths, speed or masses
    keep                dict of the same names -> (low, high), None where there is no limit, or ("==", value).
                        The crank always turns fully: margin >= 0
    fixed               all other parameters, as in `evaluate`; F_X and F_Y may vary with the motion
    sliders             filled in by a `Crankshaft` of one machine, whose phases and banks may vary, too
    starts, seed        how many local searches, from the best of a scan of the space
    timeout             seconds after which it ends with a TimeoutError; None for no limit
    points              designs along a Pareto front (to the power of the objectives less one)

    Numbers are in SI units; texts with units are understood. Gives a dict:

    <parameter>  the design, each p of `over`
    value        of the objective there; infinite where there is no optimum
    active       dict of the limits that hold it back: name or parameter -> "lower", "upper" or "equal"
    multipliers  dict name or parameter -> what the objective would gain, per unit, from relaxing its limit:
                 positive, and 0 where the limit does not hold it back. With "equal", what raising the
                 required value would gain, of either sign. NaN at a kink of the objective
    status       0 an optimum; 1 no design keeps the limits; 2 no optimum: the objective grows without
                 bound towards the limit of turning; 3 the best is at that limit itself, and nearly
                 reached by the design returned; 4 the search did not settle; 5 the objective has no finite
                 value at any design that was looked at. NaN and infinity are no design: they are left out,
                 and the message says so
    message      the same in words
    residual     of the optimality conditions, relative

    For several objectives parameters, `status` and `residual` are arrays along the front, and `value` is a
    dict of arrays by objective.

    A scan of the space, SLSQP (SciPy) with exact gradients from its best places, and the last digits from the
    optimality conditions. Largest magnitudes are split into both signs, so that a kink between them does no
    harm. Needs the extra `design`. Raises ValueError for an unknown name or limits that cross.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> machine = dict(AB=0.125, BC=0.350, omega0=157.08)
        >>> keep = {"margin": (0.005, None)}
        >>> best = dx.optimize(maximize=("absmax", "a_C"), over={"ec": (0, 0.25)}, keep=keep, **machine)
        >>> round(best["ec"], 9), best["active"]
        (0.22, {'margin': 'lower'})
    """
    check_common({}, branch)
    check_sliders(sliders)
    for name, number, least in (("starts", starts, 1), ("points", points, 2)):
        whole_number(name, number, least, 10_000)
    whole_number("seed", seed, 0, 2**32 - 1)
    deadline = Deadline("optimize", timeout)
    goals = goals_of(maximize, minimize)
    space = space_of(over, fixed, branch, deadline, sliders=sliders)
    limits = limits_of({} if keep is None else keep)
    with deadline.shown():
        if len(goals) > 1:
            result = front(goals, space, limits, starts, seed, points)
        else:
            result = solved(goals[0], space, limits, starts, seed)
    return Answer(result, partial(units_of_optimum, goals))
