"""`name_step` and `name_alpha`: the motion under a torque, for a controller or hardware in the loop.

A step is one of the classical method of Runge and Kutta, of order 4. With friction, the way in which the
crank turns is held during a step: where it comes to rest, the step is cut, and what is left starts from rest.
"""

from collections.abc import Sequence

from ....support.template import file_text, filled
from ..lifted import lifted
from ..protocol import Solver
from .functions import static_function

HEADER = file_text(__package__, "motion", "header.h")
RUNGE_KUTTA = file_text(__package__, "motion", "runge_kutta.c")  # of a `motion_at`


def step_texts(name: str, motion: Solver, names: Sequence[str]) -> list[str]:
    """The functions of `HEADER`; `names` are the arguments of a point, in the order of in[]."""
    form = lifted(motion.solve)
    own = [symbol.name for symbol in motion.arguments]  # those of `motion_at`
    turns = {part: f"turn[{k}]" for pair in form.turns.values() for k, part in enumerate(pair)}
    words = {**turns, **{name: name for name in own}}
    given = [words.get(n) or f"in[{names.index(n)}]" for n in form.program.inputs]
    lines = [f"double turn[2];\n  sin_cos({angle}, turn);" for angle in form.turns]
    used = {*given, *form.turns} | ({"in"} if any(each.startswith("in[") for each in given) else set())
    lines += [f"(void){n};" for n in (*own, "in") if n not in used]
    lines.append(f"return motion({', '.join([*given, 'out'])});")
    rubs = own[-1] in motion.solve.inputs
    way = "rubbing" if rubs else "smooth"
    told = {
        "NAME": name,
        "LINES": "\n".join(f"  {line}" for line in lines),
    }
    texts = [
        *(file_text(__package__, "motion", f"{part}.c") for part in ("at", way)),
        RUNGE_KUTTA,
        file_text(__package__, "motion", f"{way}_step.c"),
    ]
    made = [filled(text, **told) for text in texts]
    return [static_function("motion", form.program, form.program.inputs, 1, 1), *made]
