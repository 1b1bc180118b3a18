"""The compiled loops of the energy form: one of each family of designs, and those of all families."""

from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ....compiler.builder import function_text, module_text
from ....compiler.languages.numba.module import NJIT, numba_parts
from ....compiler.lowering import for_loops
from ....compiler.program import Program
from ....mechanism.constants import constants
from ....mechanism.names import LENGTHS
from ....runtime.native.modules import Native, native
from ....support.panels import NODE, NODES, RUNNING, TO_COEFFICIENTS, WEIGHT, Array
from ...loops.compiled import DesignFamily, of_row

FILES = tuple(
    Path(__file__).with_name(name)
    for name in ("follow.py", "instants.py", "pieces.py", "varied.py", "partly.py", "through.py", "turns.py")
)
OWN = tuple(Path(__file__).with_name(name) for name in ("at_angles.py", "course.py"))
FIELDS = ("M_eff", "T_in")
BLOCK = 8  # nodes among the turns of a block
MACLAURIN = (-1.0 / 24.0, 7.0 / 5760.0, -31.0 / 967680.0)  # by powers of the squared step
COURSE = (*FIELDS, "M_eff_wrt_theta", "Y", "potential_energy")
_MOTIONS = """row, rows = types.float64[::1], types.float64[:, ::1]
signature = types.void(
    rows, rows, types.float64[:, :, ::1], rows, row, row, row, row, row, rows, rows, rows, rows,
    types.float64[:, :, ::1], types.int64[:, ::1], types.float64[:, :, ::1], rows, rows, types.int8[::1],
    types.int8[:, ::1], rows
)
function = motions.py_func
"""
_VARIATIONS = """row, rows, blocks = types.float64[::1], types.float64[:, ::1], types.float64[:, :, ::1]
signature = types.void(
    rows, rows, blocks, types.int64[:, ::1], types.float64[:, :, :, ::1], blocks, row, row, row, rows, rows,
    rows, rows, blocks, types.int64[:, ::1], blocks, types.float64[:, :, :, ::1], blocks,
    types.int8[::1], types.int8[:, ::1], rows
)
function = variations.py_func
"""


_AT_ANGLES = """row, rows, blocks = types.float64[::1], types.float64[:, ::1], types.float64[:, :, ::1]
signature = types.void(rows, rows, types.float64, types.float64, row, rows, rows, rows, blocks)
function = at_angles.py_func
"""
_COURSES = """rows, blocks = types.float64[:, ::1], types.float64[:, :, ::1]
signature = types.void(rows, rows, blocks, rows, rows, rows, rows, rows)
function = courses.py_func
"""


class AtAngles(NamedTuple):
    """The quantities of a family at angles: a text, the inputs of its rows, and names.

    fields, course   at the nodes of panels, and along motions
    """

    text: str
    inputs: tuple[str, ...]
    fields: tuple[str, ...]
    course: tuple[str, ...]


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


@lru_cache(maxsize=256)
def quantities(family: DesignFamily, loaded: bool, wrt: tuple[str, ...] | None = None) -> AtAngles:
    """The loops over nodes and motions: see `names_of`."""
    fields, course = names_of(loaded, wrt)
    programs = {
        which: for_loops(family.program(names, "omega", "alpha", "mu"), constants())
        for which, names in (("fields", fields), ("course", course))
    }
    used = {name for program in programs.values() for name in program.inputs} - {"theta", "branch"}
    inputs = tuple(sorted(used))
    places = {name: f"p[{at}]" for at, name in enumerate(inputs)}
    parts = []
    for which, program in programs.items():
        parts += [of_row(f"{which}_at", program, places), _in_lanes(which, program)]
    docstring = f"desaxe: quantities at rest; p has {', '.join(inputs)}."
    return AtAngles(module_text(docstring, numba_parts([*parts, _AT_ANGLES], *OWN)), inputs, fields, course)


@lru_cache(maxsize=256)
def at_angles(text: str) -> Native:
    """The machine code of quantities at angles."""
    return native("at_angles", text)


def _in_lanes(which: str, program: Program) -> str:
    """The loop over angles, whose length LLVM does not know."""
    outs = ", ".join(f"out[{row}, k]" for row in range(len(program.outputs)))
    call = f"    {outs} = {which}_at(theta[k], branch, p)"
    loop = ["apart()", "for k in range(uint64(theta.shape[0])):", call]
    return NJIT + function_text(f"{which}_in_lanes", ("theta", "branch", "p", "out"), loop)


def rows_of(inputs: Sequence[str], values: Mapping[str, Any], count: int) -> Array:
    """The inputs of designs, a row for each."""
    rows = np.empty((count, len(inputs)))
    for column, name in enumerate(inputs):
        rows[:, column] = values[name]
    return rows


@cache
def courses() -> Native:
    """The machine code of histories."""
    return native("courses", module_text("desaxe: histories of motions.", numba_parts([_COURSES], *OWN)))


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
