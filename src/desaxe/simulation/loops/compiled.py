"""The loops over many designs as machine code, and the kernel of a family of designs that they call."""

from collections.abc import Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...compiler.llvm.loops import CompiledLoops
from ...mechanism.program import Variant
from ...runtime.executor import CompiledKernel, kernel_for
from ...runtime.kernels import KernelKey
from ...support.interrupts import finished
from .motions import designs

Array = NDArray[np.float64]
NAMES = ("M_eff", "T_in", "Y_wrt_theta", "M_eff_wrt_theta", "potential_energy")  # see `state`
UNLOADED = ("omega", "alpha", "mu", "F_X", "F_Y")
_KINDS = (
    *("f64[3]", "f64[2]", "f64[1]", "f64[1]", "f64[2]", "f64[1]", "f64[1]", "f64[1]", "f64[1]", "f64[2]"),
    *("f64[2]", "f64[1]", "f64[2]", "f64[2]", "f64[2]", "f64[2]", "i8[1]", "f64[2]"),
)


class DesignFamily(NamedTuple):
    """A family of designs: the variant of the program, and the inputs that are 0 in all of them."""

    form: Variant
    fixed: tuple[tuple[str, float], ...]

    def kernel(self) -> CompiledKernel:
        """The kernel of the quantities at angles; all other inputs are numbers."""
        fixed = dict(self.fixed) | dict.fromkeys(UNLOADED, 0.0)
        return kernel_for(KernelKey(NAMES, self.form, tuple(fixed.items()), (("theta", 0),), 1))

    def rows(self, kernel: CompiledKernel, inputs: Mapping[str, Any], branch: int) -> Array:
        """The packed inputs of designs, on their branch and on the other one."""
        first = np.frombuffer(kernel.data(dict.fromkeys(kernel.scalars, 0.0)))
        size = max((np.size(inputs[name]) for name in kernel.scalars if name in inputs), default=1)
        rows = np.empty((size, 2, first.size))
        rows[:, :] = first
        for at, name in enumerate(kernel.scalars, first.size - len(kernel.scalars)):
            for k, side in enumerate((branch, -branch)):
                rows[:, k, at] = side if name == "branch" else inputs[name]
        return rows


@cache
def motions() -> CompiledLoops:
    """The machine code of motions, compiled once a process."""
    return finished(lambda: CompiledLoops(designs, _KINDS))
