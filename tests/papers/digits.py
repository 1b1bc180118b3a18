"""The digits of the proofs, and values that are computed in them once, whoever asks first."""

import functools
from collections.abc import Callable

from mpmath import mp

DIGITS = 50


def remembered(function: Callable) -> Callable:
    """The function, run once for each set of arguments and in more than the proofs' digits."""

    @functools.cache
    @functools.wraps(function)
    def run(*arguments, **options):
        with mp.workdps(2 * DIGITS):
            return function(*arguments, **options)

    return run
