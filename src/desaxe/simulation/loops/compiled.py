"""The compiled module of a family of designs: functions from the Program, panels and DOP853 behind them."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from ...compiler.builder import function_text, functions_of, module_text
from ...compiler.languages.numba.module import NJIT, numba_parts
from ...compiler.lowering import for_loops
from ...compiler.program import Program
from ...compiler.text import with_short_temporaries, write_lines
from ...mechanism.constants import constants
from ...mechanism.program import Variant
from ...runtime.native.modules import Native, native
from ...runtime.specialise import specialise

STILL = ("M_eff", "T_in", "Y_wrt_theta")
MOVING = ("M_eff", "M_eff_wrt_theta", "T_in", "Y_wrt_theta")
UNLOADED = ("omega", "alpha", "mu", "F_X", "F_Y")
_NAMES = "motions", "state", "dop853", "dense", "panel", "inside_panel", "picard"
FILES = tuple(Path(__file__).with_name(f"{name}.py") for name in _NAMES)
_SIGNATURE = """rows, row = types.float64[:, ::1], types.float64[::1]
signature = types.void(
    rows, rows, row, row, rows, row, row, row, row, rows, rows, row, rows, rows, rows, rows, types.int8[::1],
    rows
)
function = designs.py_func
short_loops = True
"""


class DesignFamily(NamedTuple):
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
def source_of(family: DesignFamily, given_torque: bool) -> str:
    """The text of the module."""
    inputs = _places(family)
    torque = "asked(number, t, theta, omega)" if given_torque else "number"
    parts = [
        *(of_row(name, program, inputs) for name, program in family.programs.items()),
        still_in_lanes(family),
        NJIT + function_text("torque", ("t", "theta", "omega", "number"), [f"return {torque}"]),
        *([] if given_torque else _without_panels()),
        _SIGNATURE,
    ]
    docstring = f"desaxe: the motion of many designs; p has {', '.join(inputs)}."
    return module_text(docstring, numba_parts(parts, *FILES))


def _places(family: DesignFamily) -> dict[str, str]:
    return {name: f"p[{at}]" for at, name in enumerate(family.inputs)}


def still_in_lanes(family: DesignFamily) -> str:
    """`still` for a loop of vectors."""
    program = for_loops(family.programs["still"], constants(), plain=True)
    return of_row("still_in_lanes", program, _places(family))


def _without_panels() -> list[str]:
    """No panels where the torque is a number: such motions have an energy form, and compiling takes time."""
    texts = {name: text for file in FILES for name, text in functions_of(file).items()}
    answers = {"by_panel": "-1.0", "over_panel": "end, row"}
    heads = {name: texts[name][: texts[name].index('"""')] for name in answers}
    return [f"{NJIT}{head}return {answers[name]}\n" for name, head in heads.items()]


def of_row(name: str, program: Program, places: Mapping[str, str]) -> str:
    """A program as a jitted function of angle, branch and the row of a design."""
    rows = [f"{i} = {places[i]}" for i in program.inputs if i in places]
    rows += write_lines(with_short_temporaries(program), "numba")
    return NJIT + function_text(
        name, ("theta", "branch", "p"), [*rows, f"return {', '.join(program.outputs)}"]
    )


@lru_cache(maxsize=32)
def kernel_of(family: DesignFamily, given_torque: bool) -> Native:
    """The compiled loop over designs, from memory, from disk, or compiled now."""
    return native("designs", source_of(family, given_torque))
