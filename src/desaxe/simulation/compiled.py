"""The compiled module of a family of designs: its functions from the Program, and DOP853 behind them."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from ..compiler.languages.numba.module import helper_sources
from ..compiler.program import Program
from ..compiler.text import INDENT, with_short_temporaries, write_lines
from ..mechanism.program import Variant
from ..runtime.modules import Native, native, native_here
from ..runtime.specialise import specialise
from .model import MOVING, STILL, UNLOADED

LINE = "# ---- compiled"
_HEADER = '''"""{what}"""

from math import asin, atan2, copysign, cos, fabs, inf, nan, pi, sin, sqrt

from numba import njit, types
from numba.extending import intrinsic
from numpy import empty, floor, int64, nextafter
'''
_NUMBER = "def torque(t, theta, omega, number):\n    return number\n"
_FUNCTION = "def torque(t, theta, omega, number):\n    return given_torque(t, theta, omega)\n"
_NJIT = '@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)\n'
_SIGNATURE = """rows, row = types.float64[:, ::1], types.float64[::1]
signature = types.void(
    rows, rows, row, row, rows, row, row, row, row, rows, rows, row, rows, rows, rows, types.int8[::1], rows
)
function = designs
"""


class Family(NamedTuple):
    """A family of designs: the variant of the program, and the inputs that are 0 in all of them."""

    form: Variant
    fixed: tuple[tuple[str, float], ...]

    def program(self, names: Sequence[str], *zeros: str) -> Program:
        """The program of some names."""
        return specialise(
            tuple(names), self.form, tuple((dict(self.fixed) | dict.fromkeys(zeros, 0.0)).items())
        )

    @property
    def programs(self) -> Mapping[str, Program]:
        """The functions of a module, by name."""
        return {
            "still": self.program(STILL, *UNLOADED),
            "moving": self.program(MOVING, *UNLOADED),
            "potential": self.program(("potential_energy",), *UNLOADED),
        }

    @property
    def inputs(self) -> tuple[str, ...]:
        """The inputs that differ from design to design, in the order of a row."""
        used = {name for program in self.programs.values() for name in program.inputs}
        return tuple(sorted(used - {"theta", "branch"}))


@lru_cache(maxsize=1024)
def source_of(family: Family, given_torque: bool) -> str:
    """The text of the module."""
    inputs = {name: f"p[{at}]" for at, name in enumerate(family.inputs)}
    parts = [
        _HEADER.format(what=f"desaxe: the motion of many designs; p has {', '.join(inputs)}."),
        *helper_sources({line.op for program in family.programs.values() for line in program.lines}),
        *(_function(name, program, inputs) for name, program in family.programs.items()),
        _NJIT + (_FUNCTION if given_torque else _NUMBER),
        _integrator(),
        _SIGNATURE,
    ]
    return "\n\n".join(parts)


def _function(name: str, program: Program, places: Mapping[str, str]) -> str:
    """A program as a jitted function of angle, branch and the row of a design."""
    rows = [f"{i} = {places[i]}" for i in program.inputs if i in places]
    rows += write_lines(with_short_temporaries(program), "numba")
    rows.append(f"return {', '.join(program.outputs)}")
    return "\n".join([f"{_NJIT}def {name}(theta, branch, p):", *(INDENT + row for row in rows)]) + "\n"


def _integrator() -> str:
    """The text of `dop853` for numba: every function jitted, the last one with its signature."""
    text = Path(__file__).with_name("dop853.py").read_text(encoding="utf-8")
    functions = text.partition(LINE)[2].partition("\n")[2].strip().split("\ndef ")
    *helpers, last = [function.removeprefix("def ") for function in functions]
    bare = [f"{_NJIT}def {function.strip()}\n" for function in helpers]
    return "\n\n".join([*bare, f"def {last.strip()}\n"]).replace(": Any", "").replace(") -> Any:", "):")


@lru_cache(maxsize=32)
def kernel_of(family: Family, given_torque: Any) -> Native:
    """The compiled loop over designs, from memory, from disk, or compiled now."""
    source = source_of(family, given_torque is not None)
    if given_torque is not None:
        return native_here(source, {"given_torque": given_torque})
    return native("designs", source)
