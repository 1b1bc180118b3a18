"""Properties that are computed once."""

from collections.abc import Callable
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class computed_once(Generic[T]):
    """A property that is computed at first use and kept in the instance.

    `functools.cached_property` has a lock before Python 3.12, one for all instances, which stays locked in a
    child that is forked while another thread computes. Two threads may compute this one at the same time.
    """

    def __init__(self, function: Callable[[Any], T]) -> None:
        self.function, self.__doc__ = function, function.__doc__

    def __get__(self, instance: Any, owner: type) -> T:
        if instance is None:
            return self  # type: ignore[return-value]  # for whoever reads its docstring
        result: T = instance.__dict__.setdefault(self.function.__name__, self.function(instance))
        return result
