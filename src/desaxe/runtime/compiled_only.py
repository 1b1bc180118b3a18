"""Work in chunks runs compiled code from the first point on, so that results do not depend on the chunks.

Work that asks for a function a few times, and then for others, runs in NumPy: compiling would not pay.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_REQUIRED: ContextVar[bool] = ContextVar("compiled_only", default=False)


@contextmanager
def compiled_only() -> Iterator[None]:
    """Evaluate every point by compiled code for the duration of a block, however few there are."""
    token = _REQUIRED.set(True)
    try:
        yield
    finally:
        _REQUIRED.reset(token)


def is_required() -> bool:
    """True inside a `compiled_only` block."""
    return _REQUIRED.get()


_UNCOMPILED: ContextVar[bool] = ContextVar("uncompiled", default=False)


@contextmanager
def uncompiled() -> Iterator[None]:
    """Run a block of code with arrays by NumPy, up to as many points as take longer than compiling."""
    token = _UNCOMPILED.set(True)
    try:
        yield
    finally:
        _UNCOMPILED.reset(token)


def is_uncompiled() -> bool:
    """True inside an `uncompiled` block."""
    return _UNCOMPILED.get()
