"""Undecided points: rounding decides if they can be assembled, so they are recomputed in double-double.

The last angle that a mechanism reaches falls between two doubles, and next to it the sine's last bits say on
which side an angle lies. `standard` kernels count such points; here they are found, and answered by
`extended`, which tells the sides apart.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..mechanism.constants import double_constants
from ..mechanism.own_lines import not_extended
from .kernels import REACH, SPARE, KernelKey, kernel_for
from .vectorised import fill_by_arrays

AT_A_TIME = 2**20  # points


def decide(key: KernelKey, values: Mapping[str, Any], outs: Sequence[Any]) -> None:
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
    kernel_for(key._replace(names=REACH)).run(values, [reach, unsure])
    undecided = (np.abs(reach) <= SPARE * unsure) & (unsure > 0.0)  # where that is 0, the reach is exact
    places = np.nonzero(undecided)
    chosen = {n: value[places[axis_of[n]]] if n in axis_of else value for n, value in values.items()}
    known = np.abs(chosen["theta"]) <= double_constants().limit  # not all angles can be reduced as well
    if places[0].size and np.any(known):
        answers = [np.empty(places[0].size, out.dtype) for out in outs]
        _answer(key, chosen, answers, [name for name in values if name in axis_of])
        for out, answer in zip(outs, answers, strict=True):
            out[places] = np.where(known, answer, out[places])


def _answer(key: KernelKey, values: Mapping[str, Any], outs: Sequence[Any], flat: Sequence[str]) -> None:
    """Fill flat outputs from scalars and flat columns, in double-double.

    Always by NumPy, however many they are: another tier may round differently.
    """
    scalars = {name: value for name, value in values.items() if name not in flat}
    exact = key._replace(accuracy="extended", axis_of=tuple((name, 0) for name in sorted(flat)), axes=1)
    fill_by_arrays(exact, scalars, {name: values[name] for name in flat}, outs)
