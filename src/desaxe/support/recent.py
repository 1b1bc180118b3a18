"""A cache of the most recently used values."""

from collections import OrderedDict
from contextlib import suppress
from typing import Generic, TypeVar

Key = TypeVar("Key")
Value = TypeVar("Value")


class Recent(Generic[Key, Value]):
    """A mapping of at most `most` values; a new one replaces the least recently used."""

    def __init__(self, most: int) -> None:
        self.most = most
        self._values: OrderedDict[Key, Value] = OrderedDict()

    def __len__(self) -> int:
        return len(self._values)

    def __contains__(self, key: Key) -> bool:
        return key in self._values

    def get(self, key: Key) -> Value | None:
        """The value of a key, now the most recently used; None if absent."""
        result = self._values.get(key)
        if result is not None:
            with suppress(KeyError):  # another thread has just put it out
                self._values.move_to_end(key)
        return result

    def __setitem__(self, key: Key, value: Value) -> None:
        self._values[key] = value
        while len(self._values) > self.most:
            with suppress(KeyError):
                self._values.popitem(last=False)

    def clear(self) -> None:
        """Forget all values."""
        self._values.clear()
