"""A chunk of a sweep as a task for a thread or for a worker on another machine."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from numpy.typing import NDArray

from ..evaluation.lazy import AnyPart
from ..mechanism.program import digest
from ..support.version import version as desaxe_version
from .peaks import PeakPart
from .store import chunk_path, is_whole, write_chunk

Array = NDArray[Any]


class Output(NamedTuple):
    """A part of a grid, which of its variables are to be written, and where."""

    part: AnyPart | PeakPart
    variables: tuple[str, ...]
    place: tuple[int, ...]
    region: tuple[slice, ...]


class Task(NamedTuple):
    """A chunk to write: the outputs, and the values along the dimensions that they need."""

    root: str
    outputs: tuple[Output, ...]
    values: dict[str, Array]
    points: int
    threads: int
    version: str
    digest: str


class VersionError(RuntimeError):
    """A worker has another desaxe than the one that sent it work."""


def check_version(version: str, program: str) -> None:
    """Refuse to compute with another version or derivation than the sender's."""
    if (desaxe_version(), digest()) != (version, program):
        raise VersionError(
            f"this worker has desaxe {desaxe_version()}, derivation {digest()[:16]}; "
            f"the sweep is of desaxe {version}, derivation {program[:16]}"
        )


class Done(NamedTuple):
    """A chunk that is in the store: its points, and whether it had to be computed."""

    points: int
    computed: bool


def run(task: Task) -> Done:
    """Compute and write what of a chunk is not in the store, whole."""
    check_version(task.version, task.digest)
    root, computed = Path(task.root), False
    for part, variables, place, region in task.outputs:
        left = [name for name in variables if not is_whole(root, name, place, region)]
        if left:
            arrays = part.compute(task.values, task.threads)
            for name in left:
                write_chunk(root, name, region, arrays.pop(name))
            computed = True
    return Done(task.points, computed)


class Computed(NamedTuple):
    """A chunk that is not stored: its points, and its variables with their regions."""

    points: int
    variables: dict[str, tuple[tuple[slice, ...], Array]]


def compute(task: Task) -> Computed:
    """Compute a chunk and hand it back."""
    check_version(task.version, task.digest)
    found: dict[str, tuple[tuple[slice, ...], Array]] = {}
    for part, variables, _, region in task.outputs:
        arrays = part.compute(task.values, task.threads)
        found |= {name: (region, arrays[name]) for name in variables}
    return Computed(task.points, found)


def is_absent(root: Path, outputs: Sequence[Output]) -> bool:
    """True if a chunk of these outputs is missing in the store; an existing one may still be damaged."""
    return any(not chunk_path(root, name, o.place).is_file() for o in outputs for name in o.variables)


def values_for(
    outputs: Sequence[Output], axes: Mapping[str, Array], regions: Mapping[str, slice]
) -> dict[str, Array]:
    """The values along the dimensions that outputs need, those of the reduced axis whole."""
    names = dict.fromkeys(name for output in outputs for name in output.part.axes)
    return {name: axes[name][regions[name]] if name in regions else axes[name] for name in names}
