"""Functions in text that numba compiles, behind all that they call.

Rules that numba's issue tracker teaches: every option is a literal in the module and every helper stands in
it, or in the one file beside it (its cache does not see changes elsewhere); ``error_model="numpy"``, so that
a division by zero is an infinity; no fast-math flag, which would erase the NaN of an infeasible point;
``nogil=True``, so that threads can share the blocks of an array.
"""

from collections.abc import Sequence
from pathlib import Path

from ...builder import HELPERS, MATH, Parts, with_sources

NJIT = '@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)\n'
SOURCES = Path(__file__).with_name("sources")
SPELLINGS = SOURCES / "spellings.py"
# Where the names come from that stand in the text of Programs and loops.
IMPORTS = MATH | {
    "empty": "numpy", "float64": "numpy", "floor": "numpy",  # math.floor gives an integer: no vectors
    "int8": "numpy", "int64": "numpy", "njit": "numba", "types": "numba", "uint64": "numpy",
}  # fmt: skip


def numba_parts(parts: Sequence[str], *files: Path, jit: str = NJIT) -> Parts:
    """Parts of a module behind all that they call, of these files and of this language's own."""
    return with_sources(parts, (*files, SPELLINGS, HELPERS), jit, IMPORTS)
