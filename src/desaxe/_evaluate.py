"""`evaluate`: numbers in, a float out; arrays in, arrays out.

This file is the path of a single point, which needs only `math`. As soon as an argument is an
array, `_arrays` takes over.
"""

from collections.abc import Sequence
from typing import Any

from ._point import Point, point_of
from ._request import as_number, check_border, request, standstill
from .inputs import is_good


def evaluate(
    names: str | Sequence[str],
    *,
    theta: Any = None,
    ec: Any = None,
    AB: Any = None,
    BC: Any = None,
    omega0: Any = None,
    alpha: Any = 0.0,
    omega: Any = None,
    branch: int = 1,
    accuracy: str = "standard",
    threads: int | None = None,
    out: Any = None,
) -> Any:
    """Values of quantities and sensitivities, at one point or over arrays that broadcast like NumPy.

    `names` is one name (the answer is a float or an array) or a list of names (a dict name -> the
    same). `desaxe.quantities()` lists them: `Y`, `V_C`, `a_C`, `omega_BC`, `a_C_wrt_ec`, ...,
    `status` (int8) and `margin` among them.

    theta    crank angle [rad], from the slider axis
    ec       eccentricity [m], either sign
    AB, BC   lengths of crank (>= 0) and rod (> 0) [m]
    omega0   crank speed at theta = 0 [rad/s]; omega^2 = omega0^2 + 2 alpha theta (paper A)
    alpha    crank acceleration [rad/s^2], constant
    omega    crank speed at this instant, instead of omega0: a given state, whose sensitivities with
             respect to theta hold omega fixed, and which has `_wrt_omega`
    branch   +1 (the papers) or -1: on which side of the crank pin the slider is
    threads  for arrays: how many threads share the work, all that pay without
    out      for arrays: where to put the answer, an array or a dict name -> array

    What the wanted names do not need may be left out. A number may carry its unit: "10 mm", or a
    pint quantity. An infeasible point gives NaN; ask for `status` to learn why: 0 ok, 1 cannot be
    assembled here, 2 at a change point, 3 stalled, 4 bad input (an array's element only). Raises
    ValueError for an unknown name or a bad value, TypeError for a missing input.
    """
    given = {"theta": theta, "ec": ec, "AB": AB, "BC": BC, "omega0": omega0, "alpha": alpha, "omega": omega}
    wanted = (names,) if isinstance(names, str) else tuple(dict.fromkeys(names))
    if threads is not None or (omega is not None and omega0 is not None) or type(branch) is not int:
        check_border(given, branch, threads)
    key = wanted, omega is not None, branch, accuracy
    if omega0 is None and omega is None and "status" in wanted:
        given["omega0"] = standstill(wanted)
    point = _POINTS.get(key)
    if point is None:
        asked = request(wanted, given, branch, accuracy)
        fixed = (("branch", float(asked.branch)),)
        point = _POINTS[key] = point_of(asked.names, asked.state, fixed)
    values = []
    for name in point.inputs:
        value = given[name]
        if type(value) is not float or not is_good(name, value):
            value = as_number(name, value, point.inputs, wanted)
            if value is None:  # not a number: an array
                from ._arrays import evaluate_arrays

                answers = evaluate_arrays(request(wanted, given, branch, accuracy), given, threads, out)
                return answers[names] if isinstance(names, str) else answers
        values.append(value)
    if out is not None:
        raise TypeError("out= is for arrays, but every input is a number")
    answer = point.function(*values)
    return answer[0] if isinstance(names, str) else dict(zip(wanted, answer, strict=True))


_POINTS: dict[tuple[Any, ...], Point] = {}
