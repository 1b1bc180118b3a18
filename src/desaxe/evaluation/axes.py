"""The arguments of a grid, checked."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from types import MappingProxyType
from typing import Any, NamedTuple

from numpy.typing import NDArray

from ..loads.load import Load
from ..mechanism.catalogue import of_design
from ..mechanism.inputs import INPUTS
from ..mechanism.keywords import check_inputs
from ..mechanism.names import LENGTHS, STATUS
from ..mechanism.own import Register, register, used_by
from ..mechanism.program import Variant, program_of
from ..runtime.request import check_common, several
from ..support.forks import IMPORTS
from .arrays import as_array

Array = NDArray[Any]
ALWAYS = ("status", "margin")
OPTIONS = ("branch", "accuracy", "threads", "out", "reduce", "chunks", "sliders")
ARGUMENTS = (*INPUTS, *OPTIONS)  # of a grid, by name


class Outer(NamedTuple):
    """The arguments of a grid, checked.

    `given` are the inputs as they came; `axes` their arrays; `loads` those that vary with the motion, which
    are no axes.
    """

    names: tuple[str, ...]
    given: dict[str, Any]
    axes: dict[str, Array]
    loads: Mapping[str, Load] = MappingProxyType({})

    @property
    def dimensions(self) -> list[str]:
        """The inputs with one axis, in their order."""
        return [name for name, array in self.axes.items() if array.ndim]

    @property
    def shown(self) -> tuple[str, ...]:
        """The names of the variables of a labelled grid."""
        return tuple(dict.fromkeys((*self.names, *ALWAYS)))

    def groups(self) -> list[tuple[list[str], list[str]]]:
        """The names that have all dimensions, and those that have the lengths' alone, with them.

        Strokes hang on the sign of the speed: where that changes, they have the speed's dimension too.
        """
        whole, signed = _of_designs(self.shown, register())
        both = [*signed] if self._reverses else []
        rest = [name for name in whole if name not in both]
        others = [name for name in self.shown if name not in whole]
        if others == [STATUS] and "theta" not in self.axes:  # that of the design
            others, rest = [], [STATUS, *rest]
        groups = [(others, self.dimensions), (rest, self.lengths), (both, [*self.lengths, *self._reverses])]
        return [(names, along) for names, along in groups if names]

    @property
    def _reverses(self) -> list[str]:
        """The axis of speeds of which some are negative, but not all."""
        axes = {name: self.axes[name] for name in ("omega0", "omega") if name in self.dimensions}
        return [
            name
            for name, speeds in axes.items()
            if not (all(speeds >= 0.0) or all(speeds < 0.0)) or not speeds.size
        ]

    @property
    def lengths(self) -> list[str]:
        """The dimensions that are lengths."""
        return [name for name in self.dimensions if name in LENGTHS]


@lru_cache(maxsize=256)
def _of_designs(names: tuple[str, ...], known: Register) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The names that follow from the lengths alone; of these, those that need the sign of the speed."""
    whole = tuple(name for name in names if of_design(name, known))
    programs = {name: program_of((name,), Variant(own=used_by((name,), known))) for name in whole}
    return whole, tuple(name for name, program in programs.items() if "omega0" in program.inputs)


def outer_of(
    names: str | Sequence[str], inputs: Mapping[str, Any], branch: int, threads: int | None, always: bool
) -> Outer:
    """Check the arguments of a grid; `always`: it has `status` and `margin` too."""
    requested = (names,) if isinstance(names, str) else several(names)
    check_inputs("grid", inputs, ARGUMENTS)
    loads: Mapping[str, Load] = {}
    if any(callable(value) or hasattr(value, "dims") for value in inputs.values()):
        with IMPORTS:
            from .under_loads.loaded import split_axes

        inputs, loads = split_axes(inputs)
    check_common(inputs, branch, threads)
    shown = tuple(dict.fromkeys((*requested, *ALWAYS))) if always else requested
    axes = {n: axis_of(n, value, (), shown) for n, value in inputs.items() if value is not None}
    return Outer(requested, dict(inputs), axes, loads)


def axis_of(name: str, value: Any, inputs: Sequence[str], names: Sequence[str]) -> Array:
    """An input of a grid as an array; ValueError for one of several dimensions."""
    array = as_array(name, value, inputs, names)
    if array.ndim > 1:
        raise ValueError(f"{name}: a grid takes numbers and 1-d arrays, got the shape {array.shape}")
    return array
