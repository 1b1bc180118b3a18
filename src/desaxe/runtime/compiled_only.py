"""Chunked work runs compiled code from the first point on, so that results do not depend on the chunks."""

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
