"""Keys and values of a scene file as TOML."""

import json
from collections.abc import Iterable, Mapping
from typing import Any

from .schema import SceneError


def key_text(name: str) -> str:
    """A key as TOML."""
    return name if name.replace("_", "").isalnum() else json.dumps(name)


def value_text(value: Any) -> str:
    """A value as TOML in a line; SceneError for what is no data."""
    if isinstance(value, Mapping):
        return (
            "{ " + ", ".join(f"{key_text(name)} = {value_text(part)}" for name, part in value.items()) + " }"
        )
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (bool, str)):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, Iterable):
        return "[" + ", ".join(value_text(part) for part in value) + "]"
    if isinstance(value, (int, float)):
        return repr(value)
    raise SceneError(f"{value!r} cannot stand in a scene file")
