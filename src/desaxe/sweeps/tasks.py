"""A chunk of a sweep as a task for a thread or for a worker on another machine, and where its arrays go."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from numpy.typing import NDArray

from ..evaluation.plan import Block, Part, computed
from ..mechanism.program import digest
from ..support.version import version as desaxe_version
from .store import chunk_path, is_whole, write_chunk

Array = NDArray[Any]


class Sink(Protocol):
    """A place for the arrays of a sweep: a store, or the memory of the caller. It travels."""

    def left(self, part: Part) -> list[str]:
        """The outputs of a part that are to be computed."""

    def take(self, part: Part, arrays: dict[str, Array]) -> Any:
        """Take the outputs; what this returns goes back to the caller."""


class Stored(NamedTuple):
    """A store: it takes what it does not have, whole."""

    root: str

    def left(self, part: Part) -> list[str]:
        """The outputs of a part that are not in the store."""
        root = Path(self.root)
        return [n for n in part.step.outputs if not is_whole(root, n, part.place, part.region)]

    def take(self, part: Part, arrays: dict[str, Array]) -> None:
        """Write the chunks."""
        for name in list(arrays):
            write_chunk(Path(self.root), name, part.region, arrays.pop(name))


class InMemory(NamedTuple):
    """The memory of the caller: arrays go back to it, with their regions."""

    def left(self, part: Part) -> list[str]:
        """The outputs of a part, all of them."""
        return list(part.step.outputs)

    def take(self, part: Part, arrays: dict[str, Array]) -> Any:
        """Hand the arrays back."""
        return part.region, arrays


class Task(NamedTuple):
    """A chunk: its parts and the values that they need, and where its arrays go."""

    sink: Sink
    block: Block
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
    """A chunk that is done: its points, whether anything had to be computed, what its sink gave back."""

    points: int
    computed: bool
    found: list[Any]


def run(task: Task) -> Done:
    """Compute what of a chunk is left to do, and hand it to its sink."""
    check_version(task.version, task.digest)
    found = []
    for part in task.block.parts:
        left = task.sink.left(part)
        if left:
            arrays = computed(part.step, task.block.values, task.threads)
            arrays = {name: arrays.pop(name) for name in left}
            found.append(task.sink.take(part, arrays))
    return Done(task.points, bool(found), found)


def is_absent(root: Path, parts: Sequence[Part]) -> bool:
    """True if a chunk of these parts is missing in the store; an existing one may still be damaged."""
    return any(not chunk_path(root, name, p.place).is_file() for p in parts for name in p.step.outputs)
