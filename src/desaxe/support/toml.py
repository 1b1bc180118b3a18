"""Read untrusted TOML files, with limits on size and depth."""

import re
import tomllib
from pathlib import Path
from typing import Any

from .files import read_bytes

MOST_BYTES = 10_000_000
DEEPEST = 40  # tables or arrays in one another
_DOTTED = re.compile(rf"^[ \t\[]*(?:[^\s=.#]+[ \t]*\.[ \t]*){{{DEEPEST}}}", re.MULTILINE)


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
        raise ValueError(f"not a TOML file: {error}") from None
    except RecursionError:
        raise ValueError(deep) from None
    if _depth(tables) > DEEPEST:
        raise ValueError(deep)
    return tables


def _depth(value: Any) -> int:
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return 1 + max((_depth(part) for part in parts if isinstance(part, (dict, list))), default=0)
