"""Programs in NumPy, so that the first call of a request need not wait for the compiler.

Points go through in blocks that stay in the cache. As in a kernel, the plain form is for designs with wide
margins and the stable one for the others, and what rounding decides is answered with twice the digits.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.languages.arrays import Function, compile_arrays
from ..compiler.passes.guard import guard_inputs
from ..compiler.program import Program
from ..mechanism.constants import double_constants
from ..mechanism.inputs import LEAST
from ..mechanism.own_lines import not_extended
from ..support.forks import IMPORTS
from .kernels import REACH, SPARE, KernelKey, counting, has_near_limit, plain_of, seen_inputs
from .specialise import specialise

Array = NDArray[Any]

BLOCK = 8192  # points: some hundred lines of them stay in the second-level cache


class _Forms(NamedTuple):
    """The programs of a key as functions of arrays, and the inputs that all of them take."""

    inputs: tuple[str, ...]
    first: Function  # of all points
    test: Function | None  # which of them need the second
    second: Function | None


def fill_by_arrays(
    key: KernelKey, scalars: Mapping[str, float], columns: Mapping[str, Array], outs: Sequence[Array]
) -> None:
    """Fill flat outputs from scalars and flat columns, by NumPy."""
    forms = _forms(key._replace(axis_of=tuple(sorted((n, 0) for n in columns)), axes=1, far=False))
    for start in range(0, outs[0].size, BLOCK):
        part = slice(start, start + BLOCK)
        values = {**scalars, **{name: column[part] for name, column in columns.items()}}
        _fill(key, forms, values, list(columns), [out[part] for out in outs])


def _fill(
    key: KernelKey,
    forms: _Forms,
    values: Mapping[str, Any],
    flat: Sequence[str],
    outs: Sequence[Array],
) -> None:
    size = outs[0].size
    with np.errstate(all="ignore"):
        given = [values[name] for name in forms.inputs]
        found = forms.first(*given)
        for out, value in zip(outs, found, strict=False):
            out[:] = value
        if forms.test is None or forms.second is None:
            return
        rows = np.flatnonzero(~np.broadcast_to(forms.test(*given)[0], size))
        if not rows.size:
            return
        chosen = {name: value[rows] if name in flat else value for name, value in values.items()}
        found = forms.second(*(chosen[name] for name in forms.inputs))
        for out, value in zip(outs, found, strict=False):
            out[rows] = value
        if len(found) > len(outs):
            near = np.flatnonzero(np.broadcast_to(found[-1], rows.size))
            _decide(key, chosen, flat, outs, rows, near)


def _decide(
    key: KernelKey,
    values: Mapping[str, Any],
    flat: Sequence[str],
    outs: Sequence[Array],
    rows: NDArray[np.intp],
    near: NDArray[np.intp],
) -> None:
    """Recompute undecided points in double-double (see `near_limit`)."""
    if not near.size or not_extended(key.form.own):
        return
    chosen = {name: value[near] if name in flat else value for name, value in values.items()}
    test = specialise(REACH, key.form, key.fixed)
    reach, unsure = compile_arrays(test, np)(*(chosen[name] for name in test.inputs))
    undecided = (np.abs(reach) <= SPARE * unsure) & (unsure > 0.0)
    undecided &= np.abs(chosen["theta"]) <= double_constants().limit
    some = np.flatnonzero(np.broadcast_to(undecided, near.size))
    if some.size:
        columns = {name: np.ascontiguousarray(chosen[name][some]) for name in flat}
        scalars = {name: value for name, value in values.items() if name not in flat}
        answers = [np.empty(some.size, out.dtype) for out in outs]
        fill_by_arrays(key._replace(accuracy="extended"), scalars, columns, answers)
        for out, answer in zip(outs, answers, strict=True):
            out[rows[near[some]]] = answer


@lru_cache(maxsize=1024)
def _forms(key: KernelKey) -> _Forms:
    """The programs of a key, each as a function of all inputs."""
    program = specialise(key.names, key.form, key.fixed, key.accuracy)
    inputs = program.inputs
    own = dict(key.axis_of)
    varying = [name for name in inputs if name in own]
    if key.accuracy == "extended":
        with IMPORTS:
            from ..compiler.passes.double_double import double_double

        guarded = guard_inputs(program, varying, LEAST, {"theta": double_constants().limit})
        return _Forms(inputs, _function(double_double(guarded, double_constants()), inputs), None, None)
    if key.form.wide_margins:
        guarded = guard_inputs(program, seen_inputs(program, varying), LEAST, {})
        return _Forms(inputs, _function(guarded, inputs), None, None)
    stable = guard_inputs(counting(key) if has_near_limit(key) else program, varying, LEAST, {})
    plain = plain_of(key)
    if plain is None:
        return _Forms(inputs, _function(stable, inputs), None, None)
    test = specialise(("wide_margins",), key.form, key.fixed)
    first = guard_inputs(plain, seen_inputs(plain, varying), LEAST, {})
    return _Forms(inputs, *(_function(each, inputs) for each in (first, test, stable)))


def _function(program: Program, inputs: tuple[str, ...]) -> Function:
    return compile_arrays(program._replace(inputs=inputs), np)
