"""A chunk of a sweep as a task for a thread or for a worker on another machine."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from numpy.typing import NDArray

from ..evaluation.plan import Part, computed
from ..mechanism.program import digest
from ..support.version import version as desaxe_version
from .store import chunk_path, is_whole, write_chunk

Array = NDArray[Any]


class Task(NamedTuple):
    """A chunk to write: its parts, and the values along the dimensions that they need."""

    root: str
    parts: tuple[Part, ...]
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
    root, anew = Path(task.root), False
    for step, place, region in task.parts:
        left = [name for name in step.outputs if not is_whole(root, name, place, region)]
        if left:
            arrays = computed(step, task.values, task.threads)
            for name in left:
                write_chunk(root, name, region, arrays.pop(name))
            anew = True
    return Done(task.points, anew)


class Computed(NamedTuple):
    """A chunk that is not stored: its points, and its variables with their regions."""

    points: int
    variables: dict[str, tuple[tuple[slice, ...], Array]]


def compute(task: Task) -> Computed:
    """Compute a chunk and hand it back."""
    check_version(task.version, task.digest)
    found: dict[str, tuple[tuple[slice, ...], Array]] = {}
    for step, _, region in task.parts:
        found |= {n: (region, a) for n, a in computed(step, task.values, task.threads).items()}
    return Computed(task.points, found)


def is_absent(root: Path, parts: Sequence[Part]) -> bool:
    """True if a chunk of these parts is missing in the store; an existing one may still be damaged."""
    return any(not chunk_path(root, name, p.place).is_file() for p in parts for name in p.step.outputs)
