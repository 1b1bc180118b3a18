"""A second answer for points that a kernel leaves over: large angles, and those that rounding decides.

An angle beyond what the written-out sine reduces exactly takes that of the C library. The last angle that a
mechanism reaches falls between two doubles, and next to it the sine's last bits say on which side an angle
lies: there twice the digits decide. No value depends on which other points are in a call.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..mechanism.constants import double_constants, limit_of
from ..mechanism.own_lines import not_extended
from .executor import kernel_for
from .kernels import REACH, SPARE, KernelKey, has_near_limit

AT_A_TIME = 2**20  # points


def has_large_angles(angles: Any) -> bool:
    """True if an angle is beyond what the written-out sine and cosine reduce exactly."""
    limit = limit_of("standard")
    # Where their squares add up to less, none is. No test is quicker, and this one starts no threads.
    if np.einsum("i,i->", angles, angles) < 0.5 * limit * limit:
        return False
    sizes = np.abs(angles)
    return bool(np.any((sizes > limit) & (sizes < np.inf)))


def settle(key: KernelKey, values: Mapping[str, Any], outs: Sequence[Any]) -> None:
    """Answer the points again that a call of a key's kernel left over."""
    if has_near_limit(key):
        _in_parts(key, values, outs)
    axis = dict(key.axis_of).get("theta")
    if axis is not None and not key.far and key.accuracy != "extended":
        _with_large_angles(key, values, outs, axis)


def _with_large_angles(key: KernelKey, values: Mapping[str, Any], outs: Sequence[Any], axis: int) -> None:
    """Compute the points with large angles by the sine of the C library."""
    size = np.abs(values["theta"])
    rows = np.flatnonzero((size > limit_of(key.accuracy)) & (size < np.inf))
    if not rows.size:
        return
    axis_of = dict(key.axis_of)
    chosen = {n: v[rows] if axis_of.get(n) == axis else v for n, v in values.items()}
    answers = [np.empty((*out.shape[:axis], rows.size, *out.shape[axis + 1 :]), out.dtype) for out in outs]
    far = key._replace(far=True)
    if kernel_for(far).run(chosen, answers):
        _in_parts(far, chosen, answers)
    for out, answer in zip(outs, answers, strict=True):
        out[(slice(None),) * axis + (rows,)] = answer


def _in_parts(key: KernelKey, values: Mapping[str, Any], outs: Sequence[Any]) -> None:
    """Recompute the undecided points of a kernel's call."""
    if not_extended(key.form.own):
        return
    axis_of = dict(key.axis_of)
    length, row = outs[0].shape[0], max(1, outs[0].size // outs[0].shape[0])
    step = max(1, AT_A_TIME // row)
    for start in range(0, length, step):
        part = slice(start, start + step)
        here = {name: value[part] if axis_of.get(name) == 0 else value for name, value in values.items()}
        _decide(key, here, [out[part] for out in outs], axis_of)


def _decide(
    key: KernelKey, values: Mapping[str, Any], outs: Sequence[Any], axis_of: Mapping[str, int]
) -> None:
    reach, unsure = (np.empty(outs[0].shape) for _ in REACH)
    kernel_for(key._replace(names=REACH, form=key.form._replace(under=None))).run(values, [reach, unsure])
    undecided = (np.abs(reach) <= SPARE * unsure) & (unsure > 0.0)  # where that is 0, the reach is exact
    places = np.nonzero(undecided)
    chosen = {n: value[places[axis_of[n]]] if n in axis_of else value for n, value in values.items()}
    known = np.abs(chosen["theta"]) <= double_constants().limit  # not all angles can be reduced as well
    if places[0].size and np.any(known):
        flat = tuple((name, 0) for name in sorted(axis_of))
        exact = key._replace(accuracy="extended", axis_of=flat, axes=1, far=False)
        answers = [np.empty(places[0].size, out.dtype) for out in outs]
        kernel_for(exact).run(chosen, answers)
        for out, answer in zip(outs, answers, strict=True):
            out[places] = np.where(known, answer, out[places])
