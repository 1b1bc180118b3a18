"""The compiled loops of the energy form, and their constants."""

from functools import cache
from pathlib import Path

import numpy as np

from ....compiler.builder import module_text
from ....compiler.languages.numba.module import numba_parts
from ....compiler.llvm.loops import CompiledLoops
from ....mechanism.names import LENGTHS
from ....runtime.native.modules import Native, native
from ....support.interrupts import finished
from ....support.panels import NODE, NODES, RUNNING, TO_COEFFICIENTS, WEIGHT, Array
from . import follow

FILES = tuple(
    Path(__file__).with_name(name)
    for name in ("follow.py", "instants.py", "pieces.py", "varied.py", "partly.py", "through.py", "turns.py")
)
FIELDS = ("M_eff", "T_in")
BLOCK = 8  # nodes among the turns of a block
MACLAURIN = (-1.0 / 24.0, 7.0 / 5760.0, -31.0 / 967680.0)  # by powers of the squared step
COURSE = (*FIELDS, "M_eff_wrt_theta", "Y", "potential_energy")
_MOTIONS = (
    *("f64[2]", "f64[2]", "f64[3]", "f64[2]", "f64[1]", "f64[1]", "f64[1]"),  # up to `most`
    *("f64[1]", "f64[1]", "f64[2]", "f64[2]", "f64[2]", "f64[2]"),  # the tables
    *("f64[2]", "f64[3]", "f64[2]", "f64[3]", "i64[2]", "f64[3]"),  # buffers, pieces
    *("f64[2]", "f64[2]", "i8[1]", "i8[2]", "f64[2]"),
)
_VARIATIONS = """row, rows, blocks = types.float64[::1], types.float64[:, ::1], types.float64[:, :, ::1]
signature = types.void(
    rows, rows, blocks, types.int64[:, ::1], types.float64[:, :, :, ::1], blocks, row, row, row, rows, rows,
    rows, rows, blocks, types.int64[:, ::1], blocks, types.float64[:, :, :, ::1], blocks,
    types.int8[::1], types.int8[:, ::1], rows
)
function = variations.py_func
"""


def names_of(loaded: bool, wrt: tuple[str, ...] | None) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The quantities at nodes and along motions; loaded: by a table on the slider; wrt: inputs."""
    fields = (*FIELDS, "Y", "Y_wrt_theta") if loaded else FIELDS
    course = (*COURSE, "Y_wrt_theta") if loaded else COURSE
    if wrt is not None:
        more = tuple(f"{name}_wrt_{p}" for p in wrt for name in ("M_eff", "potential_energy"))
        more = (*more, "potential_energy_wrt_theta")
        slopes = *(f"T_in_wrt_{p}" for p in ("theta", *wrt)), "M_eff_wrt_theta"
        fields, course = (*fields, *more, *slopes), (*course, *more)
        if loaded:
            moved = (f"Y_wrt{by}{p}" for p in LENGTHS for by in ("_", "_theta_"))
            fields = (*fields, "Y_wrt_theta_theta", *moved)
    return fields, course


@cache
def motions() -> CompiledLoops:
    """The machine code of motions, compiled once a process."""
    return finished(lambda: CompiledLoops(follow.motions, _MOTIONS))


@cache
def variations() -> Native:
    """The machine code of derivatives by parameters."""
    docstring = "desaxe: motions in their energy form and their derivatives by parameters."
    return native("energy_by", module_text(docstring, numba_parts([_VARIATIONS], *FILES)))


def _means() -> Array:
    """From values at the nodes to the mean of 2 s f(s) from 0 to xi = (1 + node)/2."""
    share, xi = 0.5 + 0.5 * NODE, 0.5 + 0.5 * NODE
    places = 2.0 * xi[:, None] * share - 1.0
    basis = np.polynomial.legendre.legvander(places, NODES - 1) @ TO_COEFFICIENTS
    return np.asarray(np.einsum("m,kmj->kj", WEIGHT * share, basis))


def _blocks() -> Array:
    """Nodes among the turns of a block and their weights (see `turns`), by Euler and Maclaurin's formula.

    The sum over a block is that of its midpoints, which is the integral but for slopes at both ends.
    """
    nodes, weights = np.polynomial.legendre.leggauss(BLOCK)
    bases = np.linalg.inv(np.polynomial.legendre.legvander(nodes, BLOCK - 1))
    rows = [nodes, 0.5 * weights]
    for power, share in enumerate(MACLAURIN, 1):
        slopes = np.polynomial.legendre.legder(bases, 2 * power - 1)
        ends = np.polynomial.legendre.legvander(np.array([-1.0, 1.0]), len(slopes) - 1) @ slopes
        rows.append(0.5 * share * 4.0**power * (ends[1] - ends[0]))
    return np.asarray(rows)


# By columns: see `follow`.
TABLES = tuple(
    np.ascontiguousarray(table)
    for table in (NODE, WEIGHT, TO_COEFFICIENTS.T, RUNNING.T, _means().T, _blocks())
)
