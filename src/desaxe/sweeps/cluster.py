"""Tasks on threads of this process or on a Dask cluster, a bounded number of them at a time."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, ThreadPoolExecutor, wait
from contextlib import contextmanager
from itertools import islice
from typing import Any, NamedTuple, TypeVar

from ..mechanism.program import digest
from ..support.extras import needed
from ..support.version import version as desaxe_version
from .tasks import VersionError, check_version

T = TypeVar("T")
R = TypeVar("R")


class Crew(NamedTuple):
    """An executor, and how many tasks it works on at the same time."""

    executor: Executor
    size: int


@contextmanager
def threads(count: int) -> Iterator[Crew]:
    """Threads of this process."""
    with ThreadPoolExecutor(count, thread_name_prefix="desaxe-sweep") as executor:
        yield Crew(executor, count)


@contextmanager
def cluster(client: Any) -> Iterator[Crew]:
    """The workers of a Dask client."""
    with client.get_executor(pure=False) as executor:
        yield Crew(executor, max(1, sum(client.nthreads().values())))


def require_workers(client: Any) -> None:
    """Refuse what is no client, a cluster without workers, and by name workers with another desaxe."""
    with needed("client="):
        import distributed

    if not isinstance(client, distributed.Client):
        raise TypeError(f"client = {client!r}: expected a distributed.Client")
    if not client.nthreads():
        client.wait_for_workers(1, timeout=30)
    answers = client.run(check_version, desaxe_version(), digest(), on_error="return")
    refused = {address: error for address, error in answers.items() if isinstance(error, BaseException)}
    if refused:
        lines = [
            f"{address}: " + (str(error) if isinstance(error, VersionError) else
            f"desaxe is older than {desaxe_version()} there, or missing ({type(error).__name__}: {error})")
            for address, error in refused.items()
        ]  # fmt: skip
        raise VersionError("; ".join(lines))


def run_all(crew: Crew, function: Callable[[T], R], tasks: Iterable[T], ahead: int = 0) -> Iterator[R]:
    """The results of a function, as they come; at most the crew's size and `ahead` tasks are under way.

    After an error no further task begins, and those that run are waited for.
    """
    left = iter(tasks)
    running = {crew.executor.submit(function, task) for task in islice(left, crew.size + ahead)}
    try:
        while running:
            done, running = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                result = future.result()
                running |= {crew.executor.submit(function, task) for task in islice(left, 1)}
                yield result
    finally:
        for future in running:
            future.cancel()
        wait(running)
