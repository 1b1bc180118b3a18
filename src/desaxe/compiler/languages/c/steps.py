"""`name_step` and `name_alpha`: the motion under a torque, for a controller or hardware in the loop.

A step is one of the classical method of Runge and Kutta, of order 4. With friction, the way in which the
crank turns is held during a step: where it comes to rest, the step is cut, and what is left starts from rest.
"""

from collections.abc import Sequence

from ....support.template import file_text, filled
from ..protocol import Solver
from .functions import called_through

HEADER = file_text(__package__, "motion", "header.h")
RUNGE_KUTTA = file_text(__package__, "motion", "runge_kutta.c")  # of a `motion_at`
AT = """\
/* The acceleration, out[0], while the crank turns one way; returns its status. */
static int motion_at(double torque, double theta, double omega, double way, const double in[],
                     double out[])"""


def step_texts(name: str, motion: Solver, names: Sequence[str]) -> list[str]:
    """The functions of `HEADER`; `names` are the arguments of a point, in the order of in[]."""
    own = [symbol.name for symbol in motion.arguments]  # those of `motion_at`
    cells = {n: f"in[{k}]" for k, n in enumerate(names)} | {n: n for n in own}
    way = "rubbing" if own[-1] in motion.solve.inputs else "smooth"
    parts = [file_text(__package__, "motion", f"{part}.c") for part in (way, f"{way}_step")]
    alpha, step = (filled(part, NAME=name) for part in parts)
    return [*called_through("motion", motion.solve, AT, cells, 1, 1), alpha, RUNGE_KUTTA, step]
