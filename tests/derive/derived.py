"""The derivation, built once a process."""

from functools import cache

from desaxe.derive.build import Derivation, build


@cache
def derivation() -> Derivation:
    """What `python -m derive` would write."""
    return build()
