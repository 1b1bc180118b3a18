"""`evaluate`: numbers in, a float out; arrays in, arrays out."""

from collections.abc import Sequence
from typing import Any

from ..mechanism.inputs import INPUTS
from ..mechanism.keywords import check_inputs
from ..mechanism.names import LOADS
from ..runtime.request import check_sliders
from ..support.answer import Answer
from ..support.forks import IMPORTS
from .values import values

STEADY = 0.0  # the default of alpha; an alpha of 0 in a call is another object


def evaluate(
    names: str | Sequence[str],
    *,
    theta: Any = None,
    ec: Any = None,
    AB: Any = None,
    BC: Any = None,
    omega0: Any = None,
    alpha: Any = STEADY,
    omega: Any = None,
    m_crank: Any = None,
    m_rod: Any = None,
    m_slider: Any = None,
    I_crank: Any = None,
    I_rod: Any = None,
    r_crank: Any = None,
    r_rod: Any = None,
    F_X: Any = None,
    F_Y: Any = None,
    g_X: Any = None,
    g_Y: Any = None,
    mu: Any = None,
    branch: int = 1,
    accuracy: str | float = "standard",
    threads: int | None = None,
    out: Any = None,
    quality: bool = False,
    sliders: Any = None,
    **unknown: Any,
) -> Any:
    """Values of quantities and sensitivities, at one point or over arrays that broadcast like NumPy.

    `names` is one name (the result is a float or an array) or a list of names (a dict name -> the
    same). `desaxe.quantities()` lists them: `Y`, `V_C`, `a_C`, `omega_BC`, `a_C_wrt_ec`, ...,
    `status` (int8) and `margin` among them.

    theta    crank angle [rad], from the slider axis
    ec       eccentricity [m], either sign
    AB, BC   lengths of crank (>= 0) and rod (> 0) [m]
    omega0   crank speed at theta = 0 [rad/s]; omega^2 = omega0^2 + 2 alpha theta (paper A)
    alpha    crank acceleration [rad/s^2], constant
    omega    crank speed at this instant, instead of omega0: a prescribed state; sensitivities with
             respect to theta then hold omega fixed, and `_wrt_omega` exists
    branch   +1 (the papers) or -1: the side of the crank pin on which the slider lies
    m_crank, m_rod, m_slider   masses [kg]
    I_crank, I_rod     moments of inertia about the centre of mass [kg m^2]
    r_crank, r_rod     centres of mass: from A towards B, from B towards C [m]; half of AB and BC where
                       not given; a derivative with respect to AB or BC then moves them, too
    F_X, F_Y, g_X, g_Y external force on the slider [N], gravity [m/s^2]; F_X and F_Y may vary with the
             motion: `over_theta`, `over_Y`, `over_stroke`, `over_V`, `spring`, `damper`, a sum of them, or
             a function of any of theta, omega, Y, s, V_C; derivatives are then total ones
    mu       Coulomb friction coefficient of the slider's guide; friction opposes the motion, or the one that
             alpha starts. There is none at rest; for the breakaway torque pass a tiny omega0
    accuracy "standard": within 8 ulp x (1 + the sum of condition numbers), next to singular points too;
             "extended": within 2 ulp, in pairs of doubles, 3 to 16 times the time; or an acceptable error,
             such as 1e-14, for the cheaper of the two that meets it
    threads  for arrays: the number of threads; default: as many as speed it up
    out      for arrays: the array to fill, or a dict name -> array; those that share memory are filled one
             after the other
    quality  True: for each name, instead of the value, an object with `value`, `conditions` (input ->
             |input/value d value/d input|), `error_bound` (of the rounding) and `digits`; loads are
             numbers or tables then
    sliders  passed by a `Crankshaft`: the names are its sums and those of single sliders

    Labelled arrays (xarray) broadcast by the names of their dimensions; the result is labelled, too.
    Inputs that the names do not need may be omitted; masses and loads default to 0. A number may be a text
    with a unit, "10 mm", or a pint quantity. An infeasible point is NaN; request `status` to learn
    why: 0 ok, 1 cannot be assembled here, 2 at a change point, 3 stalled, 4 bad input (elements of arrays
    only), and, for forces or with mu, 5 friction jams (no forces balance) or 6 two sets of
    forces balance. Raises ValueError for an unknown name or a bad value, TypeError for a missing input.

    See docs/choose.md: which call for which question.
    """
    if unknown and sliders is None:
        options = "branch", "accuracy", "threads", "out", "quality", "sliders"
        check_inputs("evaluate", unknown, (*INPUTS, *options))
    given = {"theta": theta, "ec": ec, "AB": AB, "BC": BC, "omega0": omega0, "alpha": alpha, "omega": omega}
    absent = m_crank is m_rod is m_slider is I_crank is I_rod is r_crank is r_rod is None
    if not (absent and F_X is F_Y is g_X is g_Y is mu is None):
        loads = (m_crank, m_rod, m_slider, I_crank, I_rod, r_crank, r_rod, F_X, F_Y, g_X, g_Y, mu)
        given.update((name, load) for name, load in zip(LOADS, loads, strict=True) if load is not None)
    if sliders is not None:
        check_sliders(sliders)
        if quality:
            raise TypeError("quality=True is of a single slider: crankshaft.members[0].evaluate(...)")
        return sliders.evaluate(names, {**given, **unknown}, accuracy, threads, out)
    if quality:
        with IMPORTS:
            from .quality import evaluate_quality

        return evaluate_quality(names, given, branch, accuracy, threads, out)
    result = values(names, given, branch, accuracy, threads, out)
    if type(result) is dict:
        result = Values(result)
        result.inputs = {n: value for n, value in given.items() if value is not None and value is not STEADY}
    return result


def _units(values: Any) -> Any:
    """The units of an answer, when they are first asked for."""
    with IMPORTS:
        from ..mechanism.quantity_units import units_by_name

    return units_by_name(values)


def _code(code: int) -> Any:
    """The status of a point."""
    with IMPORTS:
        from ..mechanism.status import PointStatus

    return PointStatus(code)


class Values(Answer):
    """Values by the names of their quantities, made as fast as a dict is."""

    __init__ = dict.__init__
    _units = staticmethod(_units)
    codes = staticmethod(_code)
