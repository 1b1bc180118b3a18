"""A cache of the most recently used values."""

from collections import OrderedDict
from contextlib import suppress
from typing import Any, TypeVar

Key = TypeVar("Key")
Value = TypeVar("Value")


class Recent(OrderedDict[Key, Value]):
    """A mapping of at most `most` values; a new one replaces the least recently used."""

    def __init__(self, most: int) -> None:
        super().__init__()
        self.most = most

    def get(self, key: Key, default: Any = None) -> Value | Any:
        """The value of a key, now the most recently used."""
        with suppress(KeyError):  # another thread may have put it out
            self.move_to_end(key)
            return self[key]
        return default

    def __setitem__(self, key: Key, value: Value) -> None:
        super().__setitem__(key, value)
        while len(self) > self.most:
            with suppress(KeyError):
                self.popitem(last=False)
