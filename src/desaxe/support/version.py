"""The version of this installation."""

from .forks import IMPORTS


def version() -> str:
    """The version as installed, such as "0.1.0"."""
    with IMPORTS:
        from importlib.metadata import version

    return version("desaxe")
