"""The state of a search for the best designs, kept on disk so that a killed search can be resumed.

Merging the best designs of chunks is associative, so the best so far and the chunks that they come from are
all that is needed. The file is replaced whole, about once a second, and begins with the digest of the rest.
"""

import hashlib
import io
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..support.forks import IMPORTS
from .ranking import BestDesigns

Array = NDArray[Any]
NAME = "search.state"  # gone when the store is finished
PACE = 1.0  # seconds between two states


class Kept:
    """The best designs so far and the chunks that they come from; in a folder, or in memory alone."""

    def __init__(self, chunks: int, folder: Path | None = None) -> None:
        self.path = None if folder is None else folder / NAME
        self.done: Array = np.zeros(chunks, np.bool_)
        self.best: BestDesigns | None = None
        self.changed, self.written = False, time.monotonic()
        self._read()

    @property
    def points(self) -> int:
        """Points of the chunks that are done."""
        return 0 if self.best is None else self.best.points

    def add(self, number: int, best: BestDesigns) -> None:
        """Take note that a chunk is done, with the best designs so far."""
        self.done[number], self.best, self.changed = True, best, True
        if time.monotonic() - self.written >= PACE:
            self.close()

    def close(self) -> None:
        """Write the state, if there is a new one and a folder."""
        if self.path is not None and self.best is not None and self.changed:
            with IMPORTS:
                from .store import write_durably

            file = io.BytesIO()
            arrays: dict[str, Any] = {"done": self.done, **self.best._asdict()}
            np.savez(file, **arrays)
            data = file.getvalue()
            write_durably(self.path, hashlib.sha256(data).digest() + data)
            self.changed, self.written = False, time.monotonic()

    def _read(self) -> None:
        """Take up a state that is whole and of this search; else begin anew."""
        if self.path is None or not self.path.is_file():
            return
        data = self.path.read_bytes()
        if hashlib.sha256(data[32:]).digest() != data[:32]:
            return
        with np.load(io.BytesIO(data[32:]), allow_pickle=False) as state:
            if state["done"].shape == self.done.shape:
                self.done = state["done"]
                best = BestDesigns(**{name: state[name] for name in BestDesigns._fields})
                self.best = best._replace(feasible=int(best.feasible), points=int(best.points))
