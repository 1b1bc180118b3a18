"""Which designs are roomy: so far from every change point that plain forms of the equations will do.

The test is the derivation's own; here it is answered for whole arrays of designs at once, ahead of a kernel
that then need not ask.
"""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._point import cut
from ._program import Form
from .compiler.text import INDENT, write_lines
from .names import LENGTHS


def are_roomy(lengths: Mapping[str, Any], form: Form) -> NDArray[np.bool_]:
    """Whether designs are roomy, from their `ec`, `AB` and `BC`, arrays that broadcast."""
    with np.errstate(all="ignore"):
        return np.asarray(_test(form)(*(lengths[name] for name in LENGTHS)))


@cache
def _test(form: Form) -> Callable[..., Any]:
    """The test of a form as a function of arrays: numba's spelling is NumPy's, too."""
    program = cut(("roomy",), form._replace(roomy=False), ())
    lines = [INDENT + line for line in write_lines(program, "numba")]
    source = "\n".join([f"def test({', '.join(LENGTHS)}):", *lines, f"{INDENT}return roomy"])
    scope: dict[str, Any] = {"fabs": np.fabs, "inf": np.inf}
    exec(compile(source, "<desaxe roomy>", "exec"), scope)
    test: Callable[..., Any] = scope["test"]
    return test
