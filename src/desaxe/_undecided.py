"""Points at which rounding decides whether the rod reaches the slider's axis, answered with twice the digits.

The last angle that a mechanism reaches falls between two doubles, and next to it the sine's last bits say on
which side an angle lies. `standard` kernels count such points; here they are found, and answered by
`extended`, which tells the sides apart.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ._constants import double_constants
from ._kernels import KernelKey, kernel_for
from ._request import Request

FINDING = ("less_rounded", "less_unsure")  # BC - |u|, and what rounding may take from it
SPARE = 2.0  # times that, because a kernel may round in another way than the one that counted
AT_A_TIME = 2**20  # points


def decide(key: KernelKey, values: Mapping[str, Any], outs: Sequence[Any]) -> None:
    """Answer the undecided points of a kernel's call again."""
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
    from ._arrays import evaluate_arrays  # which hands its undecided points to this module

    reach, unsure = (np.empty(outs[0].shape) for _ in FINDING)
    kernel_for(key._replace(names=FINDING)).run(values, [reach, unsure])
    undecided = np.abs(reach) <= SPARE * unsure
    if undecided.any():
        places = np.nonzero(undecided)
        given = {n: value[places[axis_of[n]]] if n in axis_of else value for n, value in values.items()}
        known = np.abs(given["theta"]) <= double_constants().limit  # no angle that it cannot reduce
        shown = tuple("status" if o.dtype == np.int8 else n for n, o in zip(key.names, outs, strict=True))
        answers = evaluate_arrays(Request(shown, key.names, key.form, key.fixed, "extended"), given, 1, None)
        for out, name in zip(outs, shown, strict=True):
            out[places] = np.where(known, answers[name], out[places])
