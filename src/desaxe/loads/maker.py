"""Public calls that make loads and motors: in SI units, and as methods of a machine in its units."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import TYPE_CHECKING, Any, ClassVar

from ..mechanism.keywords import with_known_keywords
from ..mechanism.messages import errors_in, message_of
from ..mechanism.quantity_units import SI, UnitSystem
from ..support.shown import printable
from ..units.system import Conversion

if TYPE_CHECKING:
    pass


class Maker:
    """A call that makes a load or a motor, and perhaps its `read`, which takes it from a file.

    units  of plain numbers: those of a machine, else SI; a load shows itself in them
    """

    name: ClassVar[str]
    takes: ClassVar[str]  # its arguments, as they are shown

    def __init__(self, units: UnitSystem | None = None) -> None:
        self.units = units

    def __init_subclass__(cls) -> None:
        for method, end in (("__call__", ""), ("read", ".read")):
            if method in cls.__dict__:
                function, name = cls.__dict__[method], cls.name + end
                function.__qualname__ = name  # as errors of Python call it
                setattr(cls, method, with_known_keywords(_in_its_units(function), name))

    def unit(self, name: str) -> Conversion | None:
        """The unit of plain numbers of a name; None where none is given."""
        return None if self.units is None else self.units.of(name)

    def __repr__(self) -> str:
        units = f" in {self.units!r}" if self.units else ""
        return f"desaxe.{self.name}({self.takes}){units}"


@contextmanager
def naming(source: Any) -> Iterator[None]:
    """ValueErrors within the block begin with the name of the file."""
    try:
        yield
    except ValueError as error:
        name = "data" if hasattr(source, "columns") else printable(source)
        raise ValueError(f"{name}: " + message_of(error)) from None


def _in_its_units(method: Callable[..., Any]) -> Callable[..., Any]:
    """The method, whose messages are in the units of its maker."""
    most = method.__code__.co_argcount - 1  # Python would count the maker, too
    least = most - len(method.__defaults__ or ())

    @wraps(method)
    def made(self: Maker, *args: Any, **named: Any) -> Any:
        if len(args) > most:
            message = f"takes from {least} to {most} positional arguments but {len(args)} were given"
            raise TypeError(f"{method.__qualname__}() {message}")
        with errors_in(self.units or SI):
            result = method(self, *args, **named)
        if self.units:
            object.__setattr__(result, "shown_in", self.units)
        return result

    return made
