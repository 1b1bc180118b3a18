"""Blocks of a sweep on threads of this process or on a Dask cluster, a bounded number of them at a time."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, wait
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from numpy.typing import NDArray

from ..evaluation.plan import Block
from ..mechanism.program import digest
from ..support.extras import needed
from ..support.version import version as desaxe_version
from .store import is_whole, write_chunk

T = TypeVar("T")
R = TypeVar("R")
Arrays = list[tuple[tuple[slice, ...], dict[str, NDArray[Any]]]]  # the region of each, and those in it


class VersionError(RuntimeError):
    """A worker has another desaxe than the one that sent it work."""


class BlockWork(NamedTuple):
    """The work on a block, written to the store `root`, or returned to the caller where that is None."""

    root: Path | None
    threads: int
    version: str
    digest: str

    def run(self, block: Block) -> Arrays | None:
        """Compute the chunks of a block that the store lacks; None if it lacks none."""
        check_version(self.version, self.digest)
        back: Arrays | None = None
        for part in block.parts:
            missing = [n for n in part.step.outputs if self.root is None or not is_whole(self.root, n, part)]
            if missing:
                back = back or []
                values = part.step.compute(block.values, self.threads)
                if self.root is None:
                    back.append((part.region, values))
                    continue
                for name in missing:
                    write_chunk(self.root, name, part, values.pop(name))
        return back


def check_version(version: str, program: str) -> None:
    """Refuse to compute with another version or derivation than the sender's."""
    if (desaxe_version(), digest()) != (version, program):
        raise VersionError(
            f"this worker has desaxe {desaxe_version()}, derivation {digest()[:16]}; "
            f"the sweep is of desaxe {version}, derivation {program[:16]}"
        )


def require_workers(client: Any) -> None:
    """Refuse what is no client, a cluster without workers, and by address workers with another desaxe."""
    with needed("client="):
        import distributed

    if not isinstance(client, distributed.Client):
        raise TypeError(f"client = {client!r}: expected a distributed.Client")
    if not client.nthreads():
        client.wait_for_workers(1, timeout=30)
    answers = client.run(check_version, desaxe_version(), digest(), on_error="return")
    refused = [f"{address}: {error or type(error).__name__}" for address, error in answers.items() if error]
    if refused:
        raise VersionError("; ".join(refused))


def run_all(
    executor: Executor, function: Callable[[T], R], tasks: Iterable[T], limit: int
) -> Iterator[tuple[T, R]]:
    """Each task with its result, as they come; at most `limit` of them are under way.

    After an error no further task begins, and those that run are waited for.
    """
    left = iter(tasks)
    running = {executor.submit(function, task): task for task in islice(left, limit)}
    try:
        while running:
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                result = future.result()
                task = running.pop(future)
                running |= {executor.submit(function, task): task for task in islice(left, 1)}
                yield task, result
    finally:
        for future in running:
            future.cancel()
        wait(running)
