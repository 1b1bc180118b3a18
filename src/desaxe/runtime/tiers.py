"""The tiers of a request over arrays: plain Python, NumPy, or a compiled kernel.

Compiling takes seconds, so it has to pay: few points are computed one by one, a new request in NumPy, and
when it comes again it is compiled. The tiers keep the same promise, but may differ in the last digits;
$DESAXE_TIER forces one.
"""

import os
from collections import Counter

from .compiled_only import is_required, is_uncompiled
from .executor import is_ready
from .kernels import KernelKey

VARIABLE = "DESAXE_TIER"
INTERPRETED, NUMPY, COMPILED = TIERS = ("interpreted", "numpy", "compiled")
# A request runs in plain Python until this number of its points has been requested in this process.
BREAK_EVEN = 2_000
# A new request of more points than BREAK_EVEN is answered by NumPy once, if it has no more than these.
NUMPY_PAYS = 250_000
LATE = 16_000_000  # points by NumPy, some seconds of them, where it is asked for first (`uncompiled`)
_ASKED: Counter[KernelKey] = Counter()


def forced_tier() -> str | None:
    """The tier that work in chunks requires, or that $DESAXE_TIER names, if any."""
    if is_required():
        return COMPILED
    named = os.environ.get(VARIABLE)
    if named and named not in TIERS:
        raise ValueError(f"{VARIABLE} = {named!r}: it is one of {', '.join(TIERS)}")
    return named or None


def tier_of(key: KernelKey, size: int, numpy_pays: bool = False) -> str:
    """The tier for `size` further points of a request; NumPy only with `numpy_pays` or if forced."""
    tier = tier_ahead(key, size, numpy_pays)
    if not is_ready(key):
        _ASKED[key] += size
    return tier


def tier_ahead(key: KernelKey, size: int, numpy_pays: bool = False) -> str:
    """The tier that `size` further points would get now; nothing is counted."""
    forced = forced_tier()
    if forced is not None:
        return forced
    if is_ready(key):
        return COMPILED
    points = _ASKED[key] + size
    if is_uncompiled() and points < LATE:
        return NUMPY
    if points < BREAK_EVEN:
        return INTERPRETED
    once = numpy_pays and points == size <= NUMPY_PAYS
    return NUMPY if once else COMPILED
