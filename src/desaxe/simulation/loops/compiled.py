"""The loops over panels and designs as machine code, and the kernel of a family of designs that they call."""

from collections.abc import Callable, Mapping
from functools import cache, lru_cache
from inspect import signature
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...compiler.llvm.loops import CompiledLoops
from ...mechanism.program import Variant
from ...runtime.executor import CompiledKernel, compiled_kernel, kernel_for
from ...runtime.kernels import KernelKey
from ...support.signals import finished

Array = NDArray[np.float64]
NODES = 16
NAMES = (  # see `state`
    *("M_eff", "M_eff_wrt_theta", "T_in", "T_in_wrt_theta", "Y_wrt_theta", "Y_wrt_theta_theta"),
    *("potential_energy", "Y"),
)
GUIDE = ("N_C", "N_C_wrt_alpha", "N_C_wrt_omega0", "phi")
UNLOADED = ("omega", "alpha", "mu", "F_X", "F_Y")
BRIEF = 64  # panels of a call for one motion, which neither an interrupt nor a deadline stops
HEAD = 7  # numbers of a panel (see `loops.panels`)
_BY_KIND = {
    "f64": "work",
    "i8[1]": "status",
    "f64[1]": "knots y clock scales count sums which t q v times how",
    "f64[2]": "law data table rows matrix heads ends laws out numbers",
    "f64[3]": "kinks sheets records history",
}
KINDS = {name: kind for kind, names in _BY_KIND.items() for name in names.split()}  # of `motions`
_NONE = {f"f64[{axes}]": np.empty((0,) * axes) for axes in (1, 2, 3)} | {"i8[1]": np.empty(0, np.int8)}


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


def records_of(most: int, numbers: int) -> dict[str, Array]:
    """Memory for `most` panels, and the one before, under a law of some numbers."""
    shapes = {"heads": (HEAD,), "records": (3, NODES + 1), "ends": (2,), "laws": (numbers,)}
    return {name: np.zeros((most + 1, *shape)) for name, shape in shapes.items()}


@cache
def loops(function: Callable[..., Any]) -> tuple[CompiledLoops, dict[str, str]]:
    """The machine code of a function, compiled once a process, and the kinds of its arguments."""
    kinds = {name: KINDS[name] for name in signature(function).parameters}
    return finished(lambda: CompiledLoops(function, tuple(kinds.values()))), kinds


def run(function: Callable[..., Any], **arguments: Any) -> int:
    """Run `motions.single` or `motions.designs` with arrays by name; what is not given is empty."""
    code, kinds = loops(function)
    return code(*(arguments[name] if name in arguments else _NONE[kind] for name, kind in kinds.items()))
