"""Values of names from a dict of inputs: the body of `evaluate`.

A single point stays in this file and needs only `math`; as soon as an input is an array, `arrays` takes over.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

from ..mechanism.inputs import SAFE, is_good
from ..mechanism.own import register
from ..runtime.point import PointFunction, point_of
from ..runtime.request import (
    Request,
    accuracy_of,
    as_number,
    check_common,
    is_steady,
    request,
    several,
    standstill,
)
from ..support.forks import IMPORTS
from ..support.interrupts import import_whole

if TYPE_CHECKING:
    from .under_loads.request import LoadInputs


def values(
    names: str | Sequence[str],
    given: dict[str, Any],
    branch: int = 1,
    accuracy: Any = "standard",
    threads: int | None = None,
    out: Any = None,
) -> Any:
    """The value of one name, or a dict name -> value; see `evaluate`. Inputs that are None are not given."""
    wanted = (names,) if isinstance(names, str) else several(names)
    omega, speed_given = given.get("omega"), given.get("omega0") is not None
    if threads is not None or (omega is not None and speed_given) or type(branch) is not int:
        check_common(given, branch, threads)
    if type(accuracy) is not str or accuracy != "standard":
        accuracy = accuracy_of(accuracy)
    present = tuple([name for name, value in given.items() if value is not None])
    now = register()
    key = wanted, present, is_steady(given.get("alpha")), branch, accuracy, now
    if not speed_given and omega is None and "status" in wanted:
        given = {**given, "omega0": standstill(wanted, given, now)}
    known = _KNOWN.get(key)
    if known is None:
        if len(_KNOWN) > MOST_KNOWN:
            _KNOWN.clear()
        asked = request(wanted, given, branch, accuracy, now)
        _KNOWN[key] = known = asked, point_of(asked.names, asked.form, asked.fixed, asked.accuracy)
    asked, point = known
    answer = answer_of(asked, point, point.inputs, given, threads, out)
    if type(answer) is tuple:
        return answer[0] if isinstance(names, str) else dict(zip(wanted, answer, strict=True))
    return answer[names] if isinstance(names, str) else answer


def answer_of(
    asked: Request,
    point: PointFunction,
    inputs: Sequence[str],
    given: Mapping[str, Any],
    threads: int | None,
    out: Any,
    loads: "LoadInputs | None" = None,
) -> Any:
    """The values of a request: a tuple at a point, a dict by name over arrays.

    inputs   those that are numbers or arrays of the caller
    loads    those that follow from loads which vary with the motion
    """
    numbers = []
    for name in inputs:
        value = given.get(name)
        if type(value) is not float or not LEAST < value < MOST:
            if type(value) is _ARRAY[0]:
                value = None
            elif type(value) is not float or not is_good(name, value):
                value = as_number(name, value, inputs, asked.shown)
            if value is None:  # not a number: an array
                return _of_arrays(asked, inputs, given, threads, out, loads)
        numbers.append(value)
    if out is not None:
        raise TypeError("out= is for arrays, but every input is a number")
    if loads is None:
        return point.function(*numbers)
    return point.run(loads.at_point(dict(zip(inputs, numbers, strict=True))))


LEAST, MOST = SAFE
MOST_KNOWN = 1024  # requests that are remembered
_KNOWN: dict[Any, tuple[Request, PointFunction]] = {}


_ARRAY: list[type] = [object]  # NumPy's type of array, when it is known


@cache
def _evaluate_arrays() -> Callable[..., dict[str, Any]]:
    """`arrays.evaluate_arrays`, imported when the first array comes."""
    _ARRAY[0] = import_whole("numpy").ndarray
    with IMPORTS:
        from .arrays import evaluate_arrays

    return evaluate_arrays


def _of_arrays(
    asked: Request,
    inputs: Sequence[str],
    given: Mapping[str, Any],
    threads: int | None,
    out: Any,
    loads: "LoadInputs | None",
) -> dict[str, Any]:
    """The values for arrays: labelled ones broadcast by their dimensions, others by position."""
    evaluate_arrays = _evaluate_arrays()
    for name in inputs:
        value = given.get(name)
        if type(value) is float or type(value) is _ARRAY[0]:
            continue
        if type(value) is str:
            given = {**given, name: as_number(name, value, inputs, asked.shown)}
        elif out is None and bool(getattr(value, "dims", None)) and hasattr(value, "coords"):
            with IMPORTS:
                from .labelled import evaluate_labelled

            def run(plain: dict[str, Any]) -> dict[str, Any]:
                return _of_arrays(asked, inputs, plain, threads, None, loads)

            return evaluate_labelled(run, asked.shown, {name: given.get(name) for name in inputs})
    return evaluate_arrays(asked, inputs, given, threads, out, loads)
