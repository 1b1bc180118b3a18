"""Values of names from a dict of inputs: the body of `evaluate`.

A single point stays in this file and needs only `math`; as soon as an input is an array, `arrays` takes over.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from ..mechanism.inputs import SAFE, is_good
from ..mechanism.own import Register, register
from ..runtime.point import point_of
from ..runtime.request import accuracy_of, as_number, check_common, is_steady, request, several
from ..support.forks import IMPORTS, imported

if TYPE_CHECKING:
    from ..loads.load import Load
    from .under_loads.request import LoadInputs

NO_LOADS: "Mapping[str, Load]" = MappingProxyType({})
LEAST, MOST = SAFE
MOST_KNOWN = 1024  # requests that are remembered


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
    if any(map(callable, inputs.values())):
        numbers, loads = _split()({n: value for n, value in inputs.items() if value is not None})
        call = checked_request(requested, numbers, branch, accuracy, loads)
        answer = call.answer(numbers, threads, out, loads)
    else:
        answer = checked_request(requested, inputs, branch, accuracy).answer(inputs, threads, out)
    if type(answer) is tuple:
        return answer[0] if isinstance(names, str) else dict(zip(requested, answer, strict=True))
    return answer[names] if isinstance(names, str) else answer


def checked_request(
    names: tuple[str, ...],
    inputs: Mapping[str, Any],
    branch: Any,
    accuracy: Any,
    loads: "Mapping[str, Load]" = NO_LOADS,
) -> "CheckedRequest":
    """The request of names, checked when it is new; the way of every call to a kernel begins here."""
    if type(accuracy) is not str or accuracy != "standard":
        accuracy = accuracy_of(accuracy)
    present = tuple([name for name, value in inputs.items() if value is not None])
    now = register()
    key: tuple[Any, ...] = names, present, is_steady(inputs.get("alpha")), branch, accuracy, now
    if loads:
        key += tuple([(name, load.variant) for name, load in loads.items()])
    call = _KNOWN.get(key)
    if call is None:
        if len(_KNOWN) > MOST_KNOWN:
            _KNOWN.clear()
        call = _KNOWN[key] = CheckedRequest(names, inputs, loads, branch, accuracy, now)
    return call


class CheckedRequest:
    """A request that is checked and remembered, with its function of a point.

    asked    the request
    inputs   those that are numbers or arrays of the caller
    loaded   those that follow from the loads that matter
    keys     the kernels of arrays so far, by what they go by
    """

    def __init__(
        self,
        names: tuple[str, ...],
        given: Mapping[str, Any],
        loads: "Mapping[str, Load]",
        branch: int,
        accuracy: str,
        known: Register,
    ) -> None:
        self.loaded: LoadInputs | None = None
        if loads:
            with IMPORTS:
                from .under_loads.request import request_of

            self.asked, self.inputs, self.loaded = request_of(names, given, loads, branch, accuracy, known)
        else:
            self.asked = request(names, given, branch, accuracy, known)
        asked = self.asked
        self.point = point_of(asked.names, asked.form, asked.fixed, asked.accuracy)
        if self.loaded is None:
            self.inputs = self.point.inputs
        self.keys: dict[Any, Any] = {}

    def answer(
        self,
        given: Mapping[str, Any],
        threads: int | None,
        out: Any,
        loads: "Mapping[str, Load]" = NO_LOADS,
    ) -> Any:
        """The values: a tuple at a point, a dict by name over arrays."""
        numbers = []
        for name in self.inputs:
            value = given.get(name)
            if type(value) is not float or not LEAST < value < MOST:
                if type(value) is _ARRAY[0]:
                    value = None
                elif type(value) is not float or not is_good(name, value):
                    value = as_number(name, value, self.inputs, self.asked.shown)
                if value is None:  # not a number: an array
                    return self._of_arrays(given, threads, out, self.of_loads(loads))
            numbers.append(value)
        if out is not None:
            raise TypeError("out= is for arrays, but every input is a number")
        own = self.of_loads(loads)
        if own is None:
            return self.point.function(*numbers)
        return self.point.run(own.at_point(dict(zip(self.inputs, numbers, strict=True))))

    def of_loads(self, loads: "Mapping[str, Load]") -> "LoadInputs | None":
        """The inputs that follow from these loads, of the kind of those that were checked."""
        known = self.loaded
        return None if known is None else known._replace(loads={name: loads[name] for name in known.loads})

    def _of_arrays(
        self, given: Mapping[str, Any], threads: int | None, out: Any, loads: "LoadInputs | None"
    ) -> dict[str, Any]:
        """The values for arrays: labelled ones broadcast by their dimensions, others by position."""
        evaluate_arrays = _evaluate_arrays()
        names = self.asked.shown
        for name in self.inputs:
            value = given.get(name)
            if type(value) is float or type(value) is _ARRAY[0]:
                continue
            if type(value) is str:
                given = {**given, name: as_number(name, value, self.inputs, names)}
            elif out is None and bool(getattr(value, "dims", None)) and hasattr(value, "coords"):
                with IMPORTS:
                    from .labelled import evaluate_labelled

                def run(plain: dict[str, Any]) -> dict[str, Any]:
                    return self._of_arrays(plain, threads, None, loads)

                return evaluate_labelled(run, names, {name: given.get(name) for name in self.inputs})
        result: dict[str, Any] = evaluate_arrays(
            self.asked, self.inputs, given, threads, out, loads, self.keys
        )
        return result


_KNOWN: dict[Any, CheckedRequest] = {}
_ARRAY: list[type] = [object]  # NumPy's type of array, when it is known


@cache
def _evaluate_arrays() -> Any:
    """`arrays.evaluate_arrays`, imported when the first array comes."""
    _ARRAY[0] = imported("numpy").ndarray
    with IMPORTS:
        from .arrays import evaluate_arrays

    return evaluate_arrays


@cache
def _split() -> Any:
    """`loads.resolve.split`, imported when the first load comes."""
    with IMPORTS:
        from ..loads.resolve import split

    return split
