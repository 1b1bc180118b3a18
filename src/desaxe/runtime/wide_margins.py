"""Which designs are roomy: so far from every change point that plain forms of the equations will do.

The test is the derivation's own; here it is answered ahead of a kernel that then need not ask.
"""

from collections.abc import Callable, Mapping
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiler.languages.python import compile_python
from ..compiler.program import Program
from ..compiler.text import INDENT, write_lines
from ..mechanism.names import LENGTHS
from ..mechanism.program import Form
from .specialise import cut


def are_roomy(lengths: Mapping[str, Any], form: Form) -> NDArray[np.bool_]:
    """Whether designs are roomy, from their `ec`, `AB` and `BC`, arrays that broadcast."""
    with np.errstate(all="ignore"):
        return np.asarray(_of_arrays(form)(*(lengths[name] for name in LENGTHS)))


def all_roomy(form: Form, ec: Any, AB: Any, BC: Any) -> bool:
    """Whether every combination of these lengths is roomy, of numbers or arrays of any shape.

    The test says no more of all of them than of their extremes.
    """
    test = _of_numbers(form)
    return all(test(*corner)[0] for corner in product(_extremes(ec), _extremes(AB), _extremes(BC)))


def _extremes(values: Any) -> tuple[float, ...]:
    """The least and the largest; NaN where one is NaN."""
    return (values,) if isinstance(values, float) else (float(values.min()), float(values.max()))


def _test(form: Form) -> Program:
    return cut(("roomy",), form._replace(roomy=False), ())._replace(inputs=LENGTHS)


@lru_cache(maxsize=1024)
def _of_numbers(form: Form) -> Callable[..., Any]:
    return compile_python(_test(form))


@lru_cache(maxsize=1024)
def _of_arrays(form: Form) -> Callable[..., Any]:
    """The test as a function of arrays: numba's spelling is NumPy's, too."""
    lines = [INDENT + line for line in write_lines(_test(form), "numba")]
    source = "\n".join([f"def test({', '.join(LENGTHS)}):", *lines, f"{INDENT}return roomy"])
    scope: dict[str, Any] = {"fabs": np.fabs, "inf": np.inf}
    exec(compile(source, "<desaxe roomy>", "exec"), scope)
    test: Callable[..., Any] = scope["test"]
    return test
