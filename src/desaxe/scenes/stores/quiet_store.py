"""A folder of zarr in which the first error ends the writing.

zarr writes many files at the same time, in threads of its own. When one fails it raises the error, and goes
on with the others while the caller cleans up. Here nothing is written after an error, nor after the block.
"""

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Lock
from typing import Any

from ...support.extras import explained
from ...support.signals import put_off

with put_off(), explained("a Zarr store"):
    from zarr.core.buffer import Buffer
    from zarr.storage import LocalStore


class QuietStore(LocalStore):
    """A folder that keeps its errors, and takes nothing after the first one or when it is closed."""

    def __init__(self, root: Path | str, *, read_only: bool = False) -> None:
        super().__init__(root, read_only=read_only)
        self.errors: list[OSError] = []
        self.closed: list[bool] = []
        self.lock = Lock()

    def with_read_only(self, read_only: bool = False) -> Any:
        """A store in this folder, to read alone or to write as well."""
        other = super().with_read_only(read_only)
        other.errors, other.closed, other.lock = self.errors, self.closed, self.lock
        return other

    async def set(self, key: str, value: Buffer) -> None:
        """Write a file."""
        await asyncio.to_thread(self.set_sync, key, value)

    async def set_if_not_exists(self, key: str, value: Buffer) -> None:
        """Write a file that is not there."""
        if not (Path(self.root) / key).exists():
            await self.set(key, value)

    def set_sync(self, key: str, value: Buffer) -> None:
        """Write a file, in the calling thread."""
        with self.lock:
            if not (self.errors or self.closed):
                try:
                    write(Path(self.root) / key, value.to_bytes())
                except OSError as error:
                    self.errors.append(error)


def write(path: Path, data: bytes) -> None:
    """Write a file in a folder that is not in its place yet."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


@contextmanager
def quiet_store(path: Path) -> Iterator[QuietStore]:
    """Yield a folder to write into; the first error is raised when the block ends."""
    store = QuietStore(path)
    try:
        yield store
    except Exception:
        if not store.errors:  # else it comes of what was not written
            raise
    finally:
        with store.lock:
            store.closed.append(True)
    if store.errors:
        raise store.errors[0]
