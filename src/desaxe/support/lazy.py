"""NumPy for modules that a single point loads as well: it is imported when it is first used."""

from types import ModuleType
from typing import TYPE_CHECKING, Any

from .forks import imported

__all__ = ["np"]

if TYPE_CHECKING:
    import numpy as np
else:

    class LazyModule(ModuleType):
        """A module that imports itself for its first attribute, under the lock that forks wait for."""

        def __getattr__(self, name: str) -> Any:
            value = self.__dict__[name] = getattr(imported(self.__name__), name)
            return value

    np = LazyModule("numpy")
