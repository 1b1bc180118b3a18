"""The wide-margin test: designs so far from every change point that the plain forms do not cancel.

The test is the derivation's own; here it is answered ahead of a kernel that then need not ask.
"""

from collections.abc import Callable, Mapping
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiler.builder import function_text
from ..compiler.languages.python import compile_python
from ..compiler.program import Program
from ..compiler.text import write_lines
from ..mechanism.names import LENGTHS
from ..mechanism.program import Variant
from .specialise import specialise


def have_wide_margins(lengths: Mapping[str, Any], form: Variant) -> NDArray[np.bool_]:
    """Mask of the designs with wide margins, from broadcastable arrays `ec`, `AB`, `BC`."""
    with np.errstate(all="ignore"):
        return np.asarray(_of_arrays(form)(*(lengths[name] for name in LENGTHS)))


def all_have_wide_margins(form: Variant, ec: Any, AB: Any, BC: Any) -> bool:
    """True if every combination of these lengths (numbers or arrays) has wide margins.

    The test says no more of all of them than of their extremes.
    """
    test = of_numbers(form)
    return all(test(*corner)[0] for corner in product(_extremes(ec), _extremes(AB), _extremes(BC)))


def _extremes(values: Any) -> tuple[float, ...]:
    """The smallest and the largest element; NaN if one is NaN."""
    return (values,) if isinstance(values, float) else (float(values.min()), float(values.max()))


def _test(form: Variant) -> Program:
    return specialise(("wide_margins",), form._replace(wide_margins=False, under=None), ())._replace(
        inputs=LENGTHS
    )


@lru_cache(maxsize=1024)
def of_numbers(form: Variant) -> Callable[..., Any]:
    """The test as a function of three numbers."""
    return compile_python(_test(form))


@lru_cache(maxsize=1024)
def _of_arrays(form: Variant) -> Callable[..., Any]:
    """The test as a function of arrays: numba's spelling is NumPy's, too."""
    lines = [*write_lines(_test(form), "numba"), "return wide_margins"]
    source = function_text("test", LENGTHS, lines)
    scope: dict[str, Any] = {"fabs": np.fabs, "inf": np.inf}
    exec(compile(source, "<desaxe wide margins>", "exec"), scope)
    test: Callable[..., Any] = scope["test"]
    return test
