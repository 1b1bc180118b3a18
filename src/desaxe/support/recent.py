"""A mapping that keeps what was used last."""

from collections import OrderedDict
from contextlib import suppress
from typing import Generic, TypeVar

Key = TypeVar("Key")
Value = TypeVar("Value")


class Recent(Generic[Key, Value]):
    """At most so many values by key; a new one takes the place of the one that was not used for longest."""

    def __init__(self, most: int) -> None:
        self.most = most
        self._values: OrderedDict[Key, Value] = OrderedDict()

    def __len__(self) -> int:
        return len(self._values)

    def __contains__(self, key: Key) -> bool:
        return key in self._values

    def get(self, key: Key) -> Value | None:
        """The value of a key, which is now the one used last; None where there is none."""
        found = self._values.get(key)
        if found is not None:
            with suppress(KeyError):  # another thread has just put it out
                self._values.move_to_end(key)
        return found

    def __setitem__(self, key: Key, value: Value) -> None:
        self._values[key] = value
        while len(self._values) > self.most:
            with suppress(KeyError):
                self._values.popitem(last=False)

    def clear(self) -> None:
        """Forget all values."""
        self._values.clear()
