"""The derivation, built once a process."""

from functools import cache

from desaxe.derive.build import Derivation, build


@cache
def derivation() -> Derivation:
    """The derivation that `python -m derive` writes."""
    return build()
