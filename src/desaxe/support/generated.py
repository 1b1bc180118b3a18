"""Generated texts: files to write where nothing else is lost, or to compare with those that are there."""

from collections.abc import Iterator, Mapping
from difflib import unified_diff
from pathlib import Path

from .written import require_path, write_whole


class Generated:
    """The files of a place by name, each with its text; without one it should not be there."""

    def __init__(self, folder: Path, texts: Mapping[str, str | None]) -> None:
        self.folder, self.texts = folder, texts

    def there(self, name: str) -> bytes | None:
        """The content of a file; None where there is none."""
        file = self.folder / name
        return file.read_bytes() if file.is_file() else None

    def stale(self) -> list[str]:
        """The names of those that are missing, have another text or should not be there."""
        requested = {name: None if text is None else text.encode() for name, text in self.texts.items()}
        return [name for name, content in requested.items() if self.there(name) != content]

    def diff(self) -> Iterator[str]:
        """The lines in which those that are there differ."""
        for name in self.stale():
            there, text = self.there(name), self.texts[name]
            old, new = ((there or b"").decode(errors="replace"), text or "")
            heads = f"{name} (there)", f"{name} (new)"
            yield from unified_diff(old.splitlines(), new.splitlines(), *heads, lineterm="")
            if not old or not new:
                yield f"{name} is {'not wanted' if text is None else 'missing' if there is None else 'stale'}"

    def write(self, overwrite: bool) -> None:
        """Write all of them, once it is known that each may be."""
        for name in self.texts:
            require_path(self.folder / name, overwrite)
        for name, text in self.texts.items():
            if text is None:
                (self.folder / name).unlink(missing_ok=True)
                continue
            with write_whole(self.folder / name, overwrite) as staged:
                staged.write_bytes(text.encode())

    def summary(self) -> list[str]:
        """A line for each file that was written."""
        return [
            f"{self.folder / name}: {len(text.splitlines())} lines"
            for name, text in self.texts.items()
            if text
        ]
