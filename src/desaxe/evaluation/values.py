"""Values of names from a dict of inputs: the body of `evaluate`.

A single point stays in this file and needs only `math`; as soon as an input is an array, `arrays` takes over.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from ..mechanism.inputs import SAFE, is_good
from ..mechanism.own import register
from ..runtime.point import PointFunction, point_of
from ..runtime.request import accuracy_of, as_number, check_common, request, several
from ..support.forks import IMPORTS, imported
from .call import Call

if TYPE_CHECKING:
    from ..loads.load import Load

NO_LOADS: "Mapping[str, Load]" = MappingProxyType({})
LEAST, MOST = SAFE
MOST_KNOWN = 1024  # requests that are remembered


class PreparedCall(NamedTuple):
    """A call with its function of a point, and the kernels of arrays so far, by what they go by."""

    call: Call
    point: PointFunction
    keys: dict[Any, Any]


def values(
    names: str | Sequence[str],
    inputs: Mapping[str, Any],
    branch: int = 1,
    accuracy: Any = "standard",
    threads: int | None = None,
    out: Any = None,
) -> Any:
    """The value of one name, or a dict name -> value; see `evaluate`. Inputs that are None are not given.

    Where F_X or F_Y varies with the motion, derivatives are total ones.
    """
    requested = (names,) if isinstance(names, str) else several(names)
    if threads is not None or inputs.get("omega") is not None or type(branch) is not int:
        check_common(inputs, branch, threads)
    loads = NO_LOADS
    if any(map(callable, inputs.values())):
        with IMPORTS:
            from ..loads.resolve import split

        inputs, loads = split({name: value for name, value in inputs.items() if value is not None})
    call, point, keys = prepared(requested, inputs, branch, accuracy, loads)
    numbers = _numbers(call, inputs)
    if numbers is None:
        result = _evaluate_arrays()(call, inputs, threads, out, keys)
        return result[names] if isinstance(names, str) else result
    if out is not None:
        raise TypeError("out= is for arrays, but every input is a number")
    if call.loads is None:
        answer = point.function(*numbers)
    else:
        answer = point.run(call.loads.at_point(dict(zip(call.inputs, numbers, strict=True))))
    return answer[0] if isinstance(names, str) else dict(zip(requested, answer, strict=True))


def _numbers(call: Call, inputs: Mapping[str, Any]) -> list[float] | None:
    """The inputs of a point; None if one is an array."""
    numbers = []
    for name in call.inputs:
        value = inputs.get(name)
        if type(value) is not float or not LEAST < value < MOST:
            if type(value) is _ARRAY[0]:
                return None
            if type(value) is not float or not is_good(name, value):
                value = as_number(name, value, call.inputs, call.asked.shown)
                if value is None:
                    return None
        numbers.append(value)
    return numbers


def prepared(
    names: tuple[str, ...],
    inputs: Mapping[str, Any],
    branch: Any,
    accuracy: Any,
    loads: "Mapping[str, Load]" = NO_LOADS,
) -> PreparedCall:
    """The request of names, checked when it is new: every call of a kernel begins here."""
    if type(accuracy) is not str or accuracy != "standard":
        accuracy = accuracy_of(accuracy)
    present, alpha, now = (
        tuple([n for n, v in inputs.items() if v is not None]),
        inputs.get("alpha"),
        register(),
    )
    steady = alpha is None or (type(alpha) is float and alpha == 0.0)
    key: tuple[Any, ...] = names, present, steady, branch, accuracy, now
    if loads:
        key += tuple([(name, load.variant) for name, load in loads.items()])
    result = _KNOWN.get(key)
    if result is None:
        if loads:
            with IMPORTS:
                from .under_loads import request_under

            call = Call(*request_under(names, inputs, loads, branch, accuracy, now))
        else:
            asked = request(names, inputs, branch, accuracy, now)
            call = Call(asked, asked.inputs)
        if len(_KNOWN) > MOST_KNOWN:
            _KNOWN.clear()
        result = _KNOWN[key] = PreparedCall(call, point_of(*call.asked.key), {})
    own = result.call.loads
    if own is None:
        return result
    here = own._replace(loads={name: loads[name] for name in own.loads})
    return result._replace(call=result.call._replace(loads=here))


_KNOWN: dict[Any, PreparedCall] = {}
_ARRAY: list[type] = [object]  # NumPy's type of array, when it is known


@cache
def _evaluate_arrays() -> Any:
    """`arrays.evaluate_arrays`, imported when the first array comes."""
    _ARRAY[0] = imported("numpy").ndarray
    with IMPORTS:
        from .arrays import evaluate_arrays

    return evaluate_arrays
