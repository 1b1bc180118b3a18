"""Read untrusted TOML files, with limits on size and depth."""

import re
import tomllib
from pathlib import Path
from typing import Any

from .files import read_bytes

MOST_BYTES = 10_000_000
DEEPEST = 40  # tables or arrays in one another
_DOTTED = re.compile(rf"^[ \t\[]*(?:[^\s=.#]+[ \t]*\.[ \t]*){{{DEEPEST}}}", re.MULTILINE)

_BARE = re.compile(r"\s*([A-Za-z_]\w{0,30})\s*=\s*([-+]?[\d.]{1,30}\s*[A-Za-z][\w/^*]{0,30})\s*(?:#.*)?$")


def read_toml(path: Path) -> dict[str, Any]:
    """The tables of a file; ValueError for one that is not a TOML file, too large or too deep."""
    data = read_bytes(path, MOST_BYTES)
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(f"not a text in UTF-8: {error}") from None
    deep = f"tables or arrays in one another, deeper than {DEEPEST}"
    if _DOTTED.search(text):  # which tomllib takes the square of its length for
        raise ValueError(deep)
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"not a TOML file: {error}{_hint(text, str(error))}") from None
    except RecursionError:
        raise ValueError(deep) from None
    if _depth(tables) > DEEPEST:
        raise ValueError(deep)
    return tables


def _hint(text: str, error: str) -> str:
    """The advice to quote a number with a unit, if the line of an error has one without quotes."""
    place = re.search(r"at line (\d+)", error)
    lines = text.splitlines()
    number = int(place[1]) - 1 if place else len(lines)
    bare = _BARE.match(lines[number]) if number < len(lines) else None
    return f'; a number with a unit is a text in quotes: {bare[1]} = "{bare[2].strip()}"' if bare else ""


def _depth(value: Any) -> int:
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return 1 + max((_depth(part) for part in parts if isinstance(part, (dict, list))), default=0)
