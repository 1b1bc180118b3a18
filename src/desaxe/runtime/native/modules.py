"""The one loader: text -> digest -> lock -> file -> machine code, for kernels, peaks and simulation.

A text is Python that numba compiles: it defines `function` and its `signature`. Its machine code is kept in
the cache folder, in a file named by the digest of the text and of the machine that it was made for. Here is
the only place where such a file is read, and the only place where one is written. The text itself is not
kept, and nothing from the folder is ever run as Python.
"""

import hashlib
import json
import struct
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from ctypes import CFUNCTYPE, c_char_p, c_int64
from pathlib import Path
from typing import Any, Generic, TypeVar

from ...support import private
from ...support.forks import IMPORTS, ForkSafeLock
from ...support.interrupts import finished
from ...support.recent import Recent
from .. import cache as _cache
from .machine_code import DOUBLE, NO_MEMORY, Loaded, StoredCode, load, machine

SUFFIX = ".code"
_HEAD = "desaxe machine code 3"
_prototype = CFUNCTYPE(c_int64, c_char_p)  # lets go of the GIL while it runs
_LOCK = ForkSafeLock()


class Native:
    """Machine code as a function of arrays and numbers (see `machine_code` for what it takes natively)."""

    def __init__(self, loaded: Loaded) -> None:
        self.address, self.ranks, self.item_sizes, self._keeper = loaded
        self.entry: Callable[[bytes], int] = _prototype(self.address)
        words = ("d" if rank == DOUBLE else "q" * (1 + 2 * max(rank, 0)) for rank in self.ranks)
        self.pack = struct.Struct("".join(words)).pack

    def __call__(self, *arguments: Any) -> int:
        """Run the code; MemoryError if it cannot allocate its tables."""
        return self.run(self.table(arguments))

    def table(self, arguments: Sequence[Any]) -> bytes:
        """The packed table of arguments."""
        words: list[Any] = []
        for given, rank in zip(arguments, self.ranks, strict=True):
            if rank < 0:
                words.append(given)
            else:
                # `ctypes.data` takes three times as long
                words.append(given.__array_interface__["data"][0])
                words += given.shape
                words += given.strides
        return self.pack(*words)

    def run(self, table: bytes) -> int:
        """Run the code on a packed table; the caller keeps its arrays alive."""
        answer = self.entry(table)
        if answer == NO_MEMORY:
            raise MemoryError("no memory for the tables of a kernel")
        return answer


def native(kind: str, text: str) -> Native:
    """The function of a text: from disk, or compiled now and kept for the next process."""
    return finished(lambda: _native(kind, text))


def _native(kind: str, text: str) -> Native:
    path = path_of(kind, text)
    with _LOCK, _cache.locked(path):
        loaded = _from_disk(path)
        if loaded is None:
            made = _compiled(text, kind, {})
            if isinstance(made, StoredCode):
                _to_disk(path, made)
            loaded = _ready(made)
        return Native(loaded)


def native_here(text: str, scope: Mapping[str, Any]) -> Native:
    """The function of a text that calls a function of the user's: for this process alone."""

    def made() -> Native:
        with _LOCK:
            return Native(_ready(_compiled(text, "with a function of the user's", scope)))

    return finished(made)


def _compiled(text: str, title: str, scope: Mapping[str, Any]) -> StoredCode | Loaded:
    with IMPORTS:
        from .compiled_text import compile_text

    return compile_text(text, title, scope)


def _ready(made: StoredCode | Loaded) -> Loaded:
    loaded = load(made) if isinstance(made, StoredCode) else made
    if loaded is None:
        raise ImportError("machine code that was just compiled cannot be loaded")
    return loaded


def path_of(kind: str, text: str) -> Path:
    """The cache file of the machine code of a text."""
    digest = hashlib.sha256(f"{_HEAD}\n{machine()}\n{text}".encode()).hexdigest()
    return _cache.folder().path / f"{kind}_{digest[:40]}{SUFFIX}"


Key = TypeVar("Key")
Made = TypeVar("Made")


class Store(Generic[Key, Made]):
    """Machine code by key: from memory, from disk, or compiled now.

    text   of the code of a key
    made   from a key and its code
    most   how many to keep in memory
    """

    def __init__(
        self, kind: str, text: Callable[[Key], str], made: Callable[[Key, Native], Made], most: int
    ) -> None:
        self._kind, self._text, self._made, self._most = kind, text, made, most
        self._lock = ForkSafeLock()
        self.clear()

    def __len__(self) -> int:
        return len(self._loaded)

    def clear(self) -> None:
        """Forget what is in memory."""
        self._loaded: Recent[Key, Made] = Recent(self._most)

    def is_ready(self, key: Key) -> bool:
        """True if it is in memory."""
        return key in self._loaded

    def is_on_disk(self, key: Key) -> bool:
        """True if an earlier process has stored its code; the text is written if there is any of its kind."""
        stored = _cache.folder().path.glob(f"{self._kind}_*{SUFFIX}")
        return any(stored) and path_of(self._kind, self._text(key)).exists()

    def load(self, key: Key) -> Made:
        """From disk or compiled now, and not kept in memory."""
        return self._made(key, native(self._kind, self._text(key)))

    def of(self, key: Key) -> Made:
        """From memory, from disk, or compiled now."""
        found = self._loaded.get(key)
        if found is None:
            with self._lock:
                found = self._loaded.get(key) or self.load(key)
                self._loaded[key] = found
        return found


def _from_disk(path: Path) -> Loaded | None:
    """The stored machine code if it is intact, for this machine, and writable by no other user; else None."""
    with suppress(OSError):
        code = read_code(path.name, _cache.read_bytes(path))
        return load(code) if code is not None else None
    return None


def faults(folder: Path) -> dict[Path, str]:
    """The files of the cache folder that would not be loaded here, each with the reason."""
    found = {}
    for entry in _cache.entries(folder):
        if entry.path.suffix == SUFFIX:
            try:
                whole = read_code(entry.path.name, private.read_bytes(entry.path)) is not None
                why = "" if whole else "damaged, or made by another version or for another machine"
            except OSError as error:
                why = str(error).partition(": ")[2] or str(error)
            if why:
                found[entry.path] = why
    return found


def read_code(name: str, data: bytes) -> StoredCode | None:
    """The machine code in a file of this name; None where it is damaged or for another machine."""
    with suppress(ValueError, KeyError, TypeError, AttributeError, RecursionError):
        head, _, code = data.partition(b"\n")
        told = json.loads(head)
        ranks, sizes = (tuple(map(int, told[key])) for key in ("ranks", "item_sizes"))
        if told["machine"] == machine() and told["sha256"] == _digest(name, ranks, sizes, code):
            return StoredCode(ranks, sizes, code)
    return None


def _to_disk(path: Path, made: StoredCode) -> None:
    """Store machine code; if that fails, the next process compiles again."""
    head: dict[str, Any] = {"machine": machine(), "sha256": _digest(path.name, *made)}
    head |= {"ranks": made.ranks, "item_sizes": made.item_sizes}
    with suppress(OSError):
        _cache.write_bytes(path, json.dumps(head).encode() + b"\n" + made.machine)


def _digest(name: str, ranks: Sequence[int], sizes: Sequence[int], code: bytes) -> str:
    return hashlib.sha256(f"{name} {machine()} {list(ranks)} {list(sizes)}\n".encode() + code).hexdigest()
