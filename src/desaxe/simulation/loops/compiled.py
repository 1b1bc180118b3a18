"""The loops over panels and designs as machine code, and the kernel of a family of designs that they call."""

from collections.abc import Mapping
from functools import cache, lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...compiler.llvm.loops import CompiledLoops
from ...mechanism.program import Variant
from ...runtime.executor import CompiledKernel, compiled_kernel, kernel_for
from ...runtime.kernels import KernelKey
from ...support.signals import finished
from .march import advance
from .motions import designs

Array = NDArray[np.float64]
NAMES = (  # see `state`
    *("M_eff", "M_eff_wrt_theta", "T_in", "T_in_wrt_theta", "Y_wrt_theta", "Y_wrt_theta_theta"),
    *("potential_energy", "Y"),
)
GUIDE = ("N_C", "N_C_wrt_alpha", "N_C_wrt_omega0", "phi")
UNLOADED = ("omega", "alpha", "mu", "F_X", "F_Y")
_PANELS = (
    *("f64[1]", "f64[1]", "f64[1]", "f64[2]", "f64[1]", "f64[2]", "f64[1]", "f64[1]", "f64[2]"),
    *("f64[2]", "f64[2]", "f64[2]", "f64[3]", "f64[3]", "f64[2]", "f64[1]"),
)
_MOTIONS = (
    *("f64[2]", "f64[2]", "f64[3]", "f64[1]", "f64[3]", "f64[1]", "f64[1]", "f64[2]", "f64[3]"),
    *("i8[1]", "f64[2]"),
)


class DesignFamily(NamedTuple):
    """A family of designs: the variant of the program, and the inputs that are 0 in all of them."""

    form: Variant
    fixed: tuple[tuple[str, float], ...]

    def kernel(self) -> CompiledKernel:
        """The kernel of the quantities at angles; all other inputs are numbers."""
        fixed = dict(self.fixed) | dict.fromkeys(UNLOADED, 0.0)
        return kernel_for(KernelKey(NAMES, self.form, tuple(fixed.items()), (("theta", 0),), 1))

    def guide(self) -> CompiledKernel:
        """The kernel of the contact at the guide, over angles, speeds and forces, which are not folded."""
        fixed = {n: v for n, v in self.fixed if n not in UNLOADED} | {"alpha": 0.0, "mu": 0.0}
        axes = tuple((name, 0) for name in ("F_X", "F_Y", "omega", "theta"))
        key = KernelKey(GUIDE, self.form, tuple(fixed.items()), axes, 1)
        return _guide(key)


@lru_cache(maxsize=64)
def _guide(key: KernelKey) -> CompiledKernel:
    return compiled_kernel(key, ("theta", "omega", "F_X", "F_Y"))


def packed(kernel: CompiledKernel, inputs: Mapping[str, Any], size: int) -> Array:
    """The packed inputs of designs, numbers or arrays, a row for each."""
    first = np.frombuffer(kernel.data(dict.fromkeys(kernel.scalars, 0.0)))
    rows = np.tile(first, (size, 1))
    for column, name in enumerate(kernel.scalars, first.size - len(kernel.scalars)):
        rows[:, column] = inputs[name]
    return rows


@cache
def panels() -> CompiledLoops:
    """The machine code of panels of one motion, compiled once a process."""
    return finished(lambda: CompiledLoops(advance, _PANELS))


@cache
def motions() -> CompiledLoops:
    """The machine code of many motions, compiled once a process."""
    return finished(lambda: CompiledLoops(designs, _MOTIONS))
