"""The contenders: one file each, used as its own experienced users would use it.

A contender's `prepare(work, inputs, out, threads)` compiles, and gives a function that computes the work and
returns an array for each name: those of `out`, where there are such and it can write into them, or its own.
A peak is the largest magnitude at any of 720 angles, which is what everyone but desaxe computes.

with_c        SymPy's C, by gcc
with_casadi   CasADi
with_desaxe   desaxe, at each accuracy
with_heyoka   heyoka
with_jax      JAX
with_nothing  storing a result, single operations
with_numba    numba
with_numexpr  numexpr
with_numpy    SymPy's lambdify in NumPy
"""

from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from shutil import which
from typing import Any, NamedTuple

from ..work import Array, Inputs, Work

Run = Callable[[], Sequence[Array]]
Prepare = Callable[[Work, Inputs, Sequence[Array] | None, int], Run]
STANDARD = "desaxe standard"
LIMITS = "storing the result"


class Contender(NamedTuple):
    """A name, the file with its `prepare` and options for it, and what must be installed."""

    name: str
    module: str
    needs: str
    kind: str = "textbook"  # or "desaxe"
    options: tuple[tuple[str, Any], ...] = ()

    @property
    def is_here(self) -> bool:
        """True if the contender can run on this machine."""
        return which(self.needs) is not None if self.needs == "gcc" else find_spec(self.needs) is not None

    def load(self) -> Prepare:
        """Import it."""
        module = import_module(f"{__name__}.{self.module}")
        return partial(module.prepare, **dict(self.options))


CONTENDERS = (
    Contender("NumPy lambdify", "with_numpy", "numpy"),
    Contender("numba", "with_numba", "numba"),
    Contender("numexpr", "with_numexpr", "numexpr"),
    Contender("JAX", "with_jax", "jax"),
    Contender("CasADi map", "with_casadi", "casadi"),
    Contender("heyoka", "with_heyoka", "heyoka", options=(("fast_math", False),)),
    Contender("heyoka fast math", "with_heyoka", "heyoka", options=(("fast_math", True),)),
    Contender("C", "with_c", "gcc", options=(("fast_math", False),)),
    Contender("C fast math", "with_c", "gcc", options=(("fast_math", True),)),
    *(
        Contender(f"desaxe {tier}", "with_desaxe", "desaxe", "desaxe", (("accuracy", tier),))
        for tier in ("standard", "extended")
    ),
)
MACHINE = Contender(LIMITS, "with_nothing", "numba", "limit")
BY_NAME = {one.name: one for one in (*CONTENDERS, MACHINE)}
