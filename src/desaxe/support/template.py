"""Text files of the package, with places for values: `@NAME@`."""

import re
import sys
from collections.abc import Sequence
from pathlib import Path

_PLACE = re.compile(r"^( *)@([A-Z_]+)@\n|@([A-Z_]+)@", re.MULTILINE)


def file_text(package: str, *path: str) -> str:
    """The text of a file in a package; importlib.resources takes as long as a start of desaxe."""
    return Path(str(sys.modules[package].__file__)).parent.joinpath(*path).read_text(encoding="utf-8")


def filled(text: str, **values: str | Sequence[str]) -> str:
    """A text with values at its places; a place with a line of its own takes a list of lines, too."""

    def value(result: re.Match[str]) -> str:
        indent, alone, inside = result.groups()
        inputs = values[alone or inside]
        if inside:
            return str(inputs)
        rows = [inputs] if isinstance(inputs, str) else inputs
        return "".join(f"{indent}{row}\n" if row else "\n" for row in rows)

    return _PLACE.sub(value, text)
