"""A motion of one design evaluates by `evaluate`: nothing is compiled for its family of designs."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_ONE: ContextVar[bool] = ContextVar("one_design", default=False)


@contextmanager
def one_design() -> Iterator[None]:
    """Compile nothing for a family of designs in a block."""
    token = _ONE.set(True)
    try:
        yield
    finally:
        _ONE.reset(token)


def is_one_design() -> bool:
    """True inside such a block."""
    return _ONE.get()
