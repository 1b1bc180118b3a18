"""`evaluate`: numbers in, a float out; arrays in, arrays out.

This file is the path of a single point, which needs only `math`. As soon as an argument is an
array, `_arrays` takes over.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from . import _program
from .catalogue import law_name, quantity
from .compiler.emit_python import compile_python
from .compiler.passes.pipeline import optimise
from .inputs import INPUTS, is_good

if TYPE_CHECKING:
    from collections.abc import Callable

ACCURACIES = ("standard",)


class Request(NamedTuple):
    """What is asked for: the names as the user says them, the same under the law, state, branch."""

    shown: tuple[str, ...]
    names: tuple[str, ...]
    state: bool
    branch: int


class Point(NamedTuple):
    """A request ready for single points: its function and the inputs that it takes, in order."""

    function: "Callable[..., tuple[Any, ...]]"
    inputs: tuple[str, ...]


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
    wanted = (names,) if isinstance(names, str) else tuple(names)
    key = wanted, omega is not None, branch, accuracy
    if omega0 is None and omega is None and "status" in wanted:
        given.update(_unmoved(wanted))
    point = _POINTS.get(key)
    if point is None:
        point = _POINTS[key] = _point(request(wanted, given, branch, accuracy))
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


def request(names: Iterable[str], given: Mapping[str, Any], branch: Any, accuracy: str) -> Request:
    """The request, checked; its names are those of the law."""
    state = given.get("omega") is not None
    if state and given.get("omega0") is not None:
        raise ValueError("give omega0= (the law) or omega= (a state), not both")
    if branch not in (1, -1):
        raise ValueError(f"branch = {branch!r}: it is +1 or -1")
    if accuracy not in ACCURACIES:
        raise ValueError(f"accuracy = {accuracy!r}: it is one of {', '.join(ACCURACIES)}")
    for name in names:
        quantity(name, state)
    shown = tuple(names)
    return Request(shown, tuple(law_name(name) if state else name for name in shown), state, int(branch))


def _unmoved(names: tuple[str, ...]) -> dict[str, float]:
    """The speed to take where none is given and only `status` would use it: a crank that stands still."""
    others = tuple(name for name in names if name not in ("status", "margin"))
    for name in others:
        quantity(name)
    needs = _program.program_of(others).inputs if others else ()
    return {} if "omega0" in needs else {"omega0": 0.0, "alpha": 0.0}


def _point(wanted: Request) -> Point:
    program, _ = optimise(_program.program_of(wanted.names, wanted.state), {"branch": float(wanted.branch)})
    return Point(compile_python(program), program.inputs)


def as_number(name: str, value: Any, inputs: Sequence[str], names: Sequence[str]) -> float | None:
    """The input as a float, None if it is an array; an error that names it if it is bad or missing."""
    if value is None:
        raise TypeError(f"{', '.join(names)}: {name} is missing (needed: {', '.join(inputs)})")
    if isinstance(value, str) or hasattr(value, "magnitude"):
        from .units import in_si

        value = in_si(name, value)
    if isinstance(value, bool) or not (isinstance(value, (int, float)) or _is_numpy_number(value)):
        return None
    number = float(value)
    if not is_good(name, number):
        raise ValueError(f"{name} = {value!r}: it must be {INPUTS[name].limit}")
    return number


def _is_numpy_number(value: Any) -> bool:
    """A NumPy real scalar such as np.float32(1); a 0-d array is an array."""
    return getattr(value, "shape", None) == () and hasattr(value, "is_integer")
