"""`function`: a prepared callable of some inputs, for repeated calls.

It is a NumPy ufunc around one compiled kernel, so broadcasting, `out=`, `where=`, labelled and chunked arrays
are NumPy's; whatever the shape, every point runs through the same machine code.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..loads.resolve import without_loads
from ..mechanism.catalogue import has, inputs_of, law_name, quantity
from ..mechanism.inputs import INPUTS
from ..mechanism.keywords import check_inputs
from ..mechanism.names import sensitivity
from ..mechanism.own import Register, register, register_with, used_by
from ..mechanism.read import in_si
from ..runtime.kernels import key_of
from ..runtime.native_calls import Bound, bind, point_caller, repair_for, scalar_of, ufunc_of
from ..runtime.request import as_number, request, several
from ..support.computed import computed_once
from ..support.forks import IMPORTS, imported
from ..support.shown import shown as as_shown

Array = NDArray[Any]
INPUTS_OF_FUNCTION = ("inputs", *INPUTS, "branch", "accuracy")
_BY_ADDRESS: dict[int, Any] = {}  # code whose address somebody may have
PLAIN = {float, int, np.ndarray, np.float64}
MARGIN = {"AB": -1.0, "BC": 1.0}  # derivatives of BC - AB - |ec|


def function(
    names: str | Sequence[str], inputs: str | Sequence[str] = ("theta",), **fixed: Any
) -> "Function":
    """A prepared callable: quantities as a function of some inputs, all others fixed.

    names   one name (calls return an array) or a list (calls return a tuple)
    inputs  the arguments of each call, in this order or by keyword
    fixed   the other inputs of `evaluate` as numbers, including `branch` and `accuracy`

        f = dx.function(["V_C", "a_C"], inputs=("theta", "ec"), AB=0.125, BC=0.35, omega0=157.08)
        V_C, a_C = f(theta, ec)
        f.jacobian(theta, ec)["a_C"]["ec"]

    Compiled when it is made, it always runs the same kernel: a point has the same digits in an array of any
    shape and order, in every process on one computer. A bad or infeasible point is NaN without a warning;
    request `status` to learn why. Creating it raises as `evaluate` does.

    See docs/choose.md: which call for which question.
    """
    check_inputs("function", fixed, INPUTS_OF_FUNCTION)
    shown = (names,) if isinstance(names, str) else several(names)
    free = (inputs,) if isinstance(inputs, str) else several(inputs)
    check_inputs("function", free, tuple(INPUTS))
    without_loads("function", fixed, "{name} among inputs= and its value, such as load(theta), in each call")
    if not shown:
        raise ValueError("names = (): expected the name of a quantity or a list of names")
    twice = [name for name in free if fixed.get(name) is not None]
    if twice:
        raise TypeError(f"function: {twice[0]} is an input of each call, it cannot be fixed too")
    return Function(shown, isinstance(names, str), free, fixed)


class Function:
    """Quantities as a function of some inputs (see `function`).

    names     the quantities, a tuple
    inputs    the inputs of a call, a tuple in the order of positional arguments
    fixed     the others, a dict
    units     dict name -> unit, of quantities and inputs
    scalar    the same of numbers, to be called inside of a function compiled by numba (in this process: it
              holds an address, so such a function cannot be kept by `cache=True`)
    address   a C function `int64_t f(const double *inputs, double *outputs)` of one point, which answers 0;
              inputs and outputs stand in the order of `inputs` and `names`; it can be called until `release`,
              whether this object still exists or not
    """

    def __init__(
        self,
        names: tuple[str, ...],
        one: bool,
        inputs: tuple[str, ...],
        fixed: Mapping[str, Any],
        known: Register | None = None,
    ) -> None:
        self.names, self.inputs, self.fixed, self._one = names, inputs, dict(fixed), one
        self._known = known or register()  # as it was made: later definitions change nothing
        self._failures: list[BaseException] = []
        self._is_status = tuple(name == "status" for name in names)
        self._bound = self._compiled()
        self._state = "omega" in inputs or fixed.get("omega") is not None
        self.units = {name: quantity(name, self._state, self._known).unit for name in names}
        self.units |= {name: INPUTS[name].unit for name in inputs}
        self._ufunc, self._kept = ufunc_of(self._bound, len(inputs), self._is_status, ", ".join(names))

    def _compiled(self) -> Bound:
        """The kernel as a ufunc's inner loop."""
        branch, accuracy = self.fixed.get("branch", 1), self.fixed.get("accuracy", "standard")
        given: dict[str, Any] = {n: v for n, v in self.fixed.items() if n in INPUTS and v is not None}
        given.setdefault("alpha", None if "alpha" in self.inputs else 0.0)
        given |= dict.fromkeys(self.inputs, np.empty(1))
        requested = request(self.names, given, branch, accuracy, self._known)
        numbers = {}
        for name in requested.inputs:
            if name not in self.inputs:
                number = as_number(name, given.get(name), requested.inputs, self.names)
                if number is None:
                    message = "is fixed, so it is a number; an array belongs to inputs="
                    raise TypeError(f"function: {name} {message}")
                numbers[name] = number
        axis_of = {name: 0 for name in self.inputs if name in requested.inputs}
        key = key_of(requested, numbers, {}, axis_of, 1)
        return bind(key, numbers, self.inputs, repair_for(key, numbers, self.inputs, self._failures))

    def __call__(self, *args: Any, out: Any = None, **named: Any) -> Any:
        """The values: an array for a name, a tuple for a list of names."""
        if named:
            args, named = self._in_order(args, named)
        if len(args) != len(self.inputs):
            raise TypeError(f"function of ({', '.join(self.inputs)}): {len(args)} arguments were given")
        labelled = not PLAIN.issuperset(map(type, args)) and any(hasattr(value, "attrs") for value in args)
        if labelled:
            with IMPORTS:
                from .labelled import refuse_differing

            refuse_differing(dict(zip(self.inputs, args, strict=True)))
            pairs = zip(self.inputs, args, strict=True)  # in SI units, from the unit that an array names
            args = tuple([in_si(INPUTS[n], a) if hasattr(a, "attrs") else a for n, a in pairs])
        if out is not None:
            named["out"] = outs = self._outputs(out)
            args = tuple([_apart(argument, outs) for argument in args])
        try:
            result = self._ufunc(*args, **named)
        except (TypeError, ValueError):
            args = tuple(map(_array, self.inputs, args))
            result = self._ufunc(*args, **named)
        if self._failures:
            raise self._failures.pop()
        if labelled:
            for name, array in zip(self.names, (result,) if len(self.names) == 1 else result, strict=True):
                array.attrs = {"units": self.units[name]} if hasattr(array, "dims") else {}
        return result if self._one or len(self.names) > 1 else (result,)

    def _in_order(
        self, args: tuple[Any, ...], named: dict[str, Any]
    ) -> tuple[tuple[Any, ...], dict[str, Any]]:
        """All arguments in positional order, and the keywords for NumPy's ufunc."""
        rest = self.inputs[len(args) :]
        for name in self.inputs[: len(args)]:
            if name in named:
                raise TypeError(f"function: {name} was given twice")
        for name in named:
            if name not in (*rest, "where", "casting", "order", "dtype", "subok"):
                raise TypeError(f"function of ({', '.join(self.inputs)}): no input {name!r}")
        for name in rest:
            if name not in named:
                raise TypeError(f"function of ({', '.join(self.inputs)}): {name} is missing")
        return (*args, *(named.pop(name) for name in rest)), named

    def _outputs(self, out: Any) -> tuple[Any, ...]:
        """`out=` as a tuple for NumPy, from an array, a sequence, or a dict name -> array."""
        if type(out) is not tuple and isinstance(out, Mapping):
            if set(out) != set(self.names):
                raise ValueError(
                    f"out= is a dict with the keys {', '.join(self.names)}, got {', '.join(out)}"
                )
            return tuple(out[name] for name in self.names)
        result = tuple(out) if isinstance(out, (tuple, list)) else (out,)
        for name, place in zip(self.names, result, strict=False):
            if not hasattr(place, "__array_ufunc__"):
                raise TypeError(f"out= for {name}: an array is wanted, got {as_shown(place)}")
        if len(result) != len(self.names):
            raise ValueError(f"out=: expected {len(self.names)} arrays, got {len(result)}")
        return result

    def jacobian(self, *args: Any, **named: Any) -> dict[str, dict[str, Any]]:
        """The exact derivatives: dict name -> dict input -> array of the broadcast shape.

        Raises ValueError where the derivation has no derivative with respect to an input.
        """
        args, _ = self._in_order(args, named)
        known = dict(zip(self._slopes.names, self._slopes(*args), strict=True))
        given = dict(zip(self.inputs, args, strict=True))

        def slope(name: str, parameter: str) -> Any:
            if name == "margin":
                factor = -np.sign(given["ec"]) if parameter == "ec" else MARGIN.get(parameter, 0.0)
                return _constant_like(known[name], factor)
            result = known.get(sensitivity(name, parameter))
            return _constant_like(known[name], 0.0) if result is None else result

        return {name: {parameter: slope(name, parameter) for parameter in self.inputs} for name in self.names}

    @computed_once
    def _slopes(self) -> "Function":
        """The function of the values and of their derivatives, those that are not 0 everywhere."""
        state = self._state
        requested = dict.fromkeys(self.names)
        for name in self.names:
            needed = inputs_of(name, state, self._known)
            for parameter in self.inputs:
                slope = sensitivity(name, parameter)
                if has(slope, state, self._known):
                    requested[slope] = None
                elif parameter in needed and name != "margin":
                    derivative = f"the derivative of {name} with respect to {parameter}"
                    raise ValueError(f"jacobian: {derivative} is not derived")
        return Function(tuple(requested), False, self.inputs, self.fixed, self._known)

    @computed_once
    def _point(self) -> Any:
        return point_caller(self._bound, len(self.inputs), self._is_status)

    @property
    def address(self) -> int:
        """The address of a C function of one point, which stays callable until `release`."""
        point = self._point
        _BY_ADDRESS[point.address] = point
        address: int = point.address
        return address

    def release(self) -> None:
        """Free the code of `address` with this object: whoever has the address calls it no more then."""
        _BY_ADDRESS.pop(self._point.address, None)

    @computed_once
    def scalar(self) -> Any:
        """The function of numbers, callable from numba's code: a number for a name, a tuple for a list."""
        imported("numba")
        return scalar_of(self._point.address, self.inputs, len(self.names), self._one, self)

    def __reduce__(self) -> Any:
        own = used_by((law_name(name) for name in self.names), self._known)
        return _again, (self.names, self._one, self.inputs, self.fixed, own)

    def __repr__(self) -> str:
        fixed = "".join(f", {name}={value!r}" for name, value in self.fixed.items())
        names = self.names[0] if self._one else list(self.names)
        return f"desaxe.function({names!r}, inputs={self.inputs!r}{fixed})"


def _again(
    names: tuple[str, ...], one: bool, inputs: tuple[str, ...], fixed: dict[str, Any], own: Any
) -> Function:
    return Function(names, one, inputs, fixed, register_with(own))


def _constant_like(values: Any, constant: Any) -> Any:
    """The constant where there is a value, else NaN."""
    return np.where(np.isnan(values), np.nan, constant)[()]


def _apart(argument: Any, outs: Sequence[Any]) -> Any:
    """The argument, or a copy of it if it shares memory with an output."""
    arrays = (out for out in outs if isinstance(out, np.ndarray) and isinstance(argument, np.ndarray))
    return argument.copy() if any(np.may_share_memory(argument, out) for out in arrays) else argument


def _array(name: str, value: Any) -> Any:
    """Convert an argument that NumPy's ufunc refused to numbers; an error names it if that fails."""
    with IMPORTS:
        from .arrays import as_array

    return value if hasattr(value, "dims") else as_array(name, value, (), (name,))
