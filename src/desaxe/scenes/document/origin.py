"""The sections on how a document came about: warnings, versions, and the command that made it."""

import platform
from datetime import datetime
from importlib.metadata import version

from ...evaluation.labels import source
from .parts import Lines, Section, Text, TextTable

PACKAGES = ("numpy", "numba")


def warned(words: list[str]) -> Section:
    """The warnings, and the points without a value."""
    return Section("Warnings", [Text(one) for one in dict.fromkeys(words)] or [Text("none")])


def origin(command: str) -> Section:
    """Versions, date and command."""
    python = f"{platform.python_version()} ({platform.python_implementation()}, {platform.machine()})"
    rows = [("desaxe", source().removeprefix("desaxe ")), ("Python", python)]
    rows += [(name, version(name)) for name in PACKAGES]
    rows.append(("made", f"{datetime.now().astimezone():%Y-%m-%d %H:%M %z}"))
    return Section("Origin", [TextTable(("", "version"), rows), Text("Made by:"), Lines(command)])
