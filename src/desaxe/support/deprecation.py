"""Deprecated spellings, kept for one version: a warning names the new one, at the line of the caller."""

import sys
import warnings

PACKAGE = __name__.partition(".")[0]


def deprecated(old: str, new: str) -> None:
    """Warn that `old` goes with the next version, and say what takes its place."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] == PACKAGE:
        level, frame = level + 1, frame.f_back
    message = f"{old} is deprecated and goes with the next version: {new}"
    warnings.warn(message, DeprecationWarning, stacklevel=level)
