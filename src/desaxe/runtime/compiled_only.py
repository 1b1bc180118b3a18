"""Work in parts takes compiled code from the first point on: its digits do not depend on the parts."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_REQUIRED: ContextVar[bool] = ContextVar("compiled_only", default=False)


@contextmanager
def compiled_only() -> Iterator[None]:
    """Answer no point in plain Python for the length of a block, however few there are."""
    token = _REQUIRED.set(True)
    try:
        yield
    finally:
        _REQUIRED.reset(token)


def is_required() -> bool:
    """Whether compiled code must be taken here."""
    return _REQUIRED.get()
