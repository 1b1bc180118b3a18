"""The compiled loop over motions in their energy form, the same for every family of designs."""

from functools import cache
from pathlib import Path

import numpy as np

from ...compiler.builder import module_text
from ...compiler.languages.numba.module import numba_parts
from ...runtime.modules import Native, native
from ...support.panels import NODE, NODES, RUNNING, TO_COEFFICIENTS, WEIGHT, Array

FILES = tuple(Path(__file__).with_name(name) for name in ("follow.py", "pieces.py", "varied.py"))
_MOTIONS = """row, rows = types.float64[::1], types.float64[:, ::1]
signature = types.void(
    rows, rows, rows, rows, rows, rows, row, row, row, row, row, rows, rows, rows, rows, rows, rows,
    types.int8[::1], types.int8[:, ::1], rows
)
function = motions.py_func
"""
_VARIATIONS = """row, rows, blocks = types.float64[::1], types.float64[:, ::1], types.float64[:, :, ::1]
signature = types.void(
    rows, rows, rows, rows, rows, rows, blocks, blocks, blocks, types.float64[:, :, :, ::1], blocks, blocks,
    rows, row, row, row, row, row, rows, rows, rows, rows, types.float64[:, :, :, ::1], blocks,
    types.int8[::1], types.int8[:, ::1], rows
)
function = variations.py_func
"""


@cache
def kernel() -> Native:
    """The machine code, from memory, from disk, or compiled now."""
    docstring = "desaxe: motions in their energy form."
    return native("energy", module_text(docstring, numba_parts([_MOTIONS], *FILES)))


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


# By columns: see `follow`.
TABLES = tuple(
    np.ascontiguousarray(table) for table in (NODE, WEIGHT, TO_COEFFICIENTS.T, RUNNING.T, _means().T)
)
